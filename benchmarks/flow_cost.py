"""What flow and trajectories cost: nine people at three picture sizes, with DeepFlow beside them in the same run.

Each row is a picture size: milliseconds a frame of the default flow both ways and of matching and chaining, of DeepFlow
on grey both ways, microseconds a moving pixel, and the largest memory (MB) while 10 and while 20 frames are worked on,
less what the frames themselves take: it must not grow with the recording. Takes about two minutes.
"""

import sys
import tracemalloc
from itertools import pairwise
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

import numpy as np
from cyclopts import App

import unocclude
from algorithm.pipeline import moving_depths, timed_flows, trajectories_along
from algorithm.scene_flow import Footage, flows_between
from algorithm.settings import Settings, changed_settings
from algorithm.spacing import mean_point_spacing
from algorithm.stopwatch import Stopwatch
from benchmarks.tables import Row, run, show
from recording.recording import Recording

app = App(help=__doc__)
DEFAULT = Settings()
DEEPFLOW = changed_settings(DEFAULT, {"flow": "deepflow", "image": "grey"}, source="DeepFlow")
_FEW, _MANY = 10, 20
_STAGES = ("flow", "match", "trajectories")


@app.default
def flow_cost(*, sizes: tuple[str, ...] = ("240x180", "480x360", "640x480"), seed: int = 1, json: bool = False) -> None:
    """Print the table.

    Args:
        sizes: Picture sizes.
        seed: 1 to 20 are for development, 1001 to 1010 for reporting.
        json: One JSON object in place of the table.
    """
    rows = [_row(unocclude.simulate("9men", seed=seed, size=size, frames=_MANY), size) for size in sizes]
    show("Cost of flow and trajectories, nine people", rows, as_json=json)


def _row(recording: Recording, size: str) -> Row:
    footage = _footage(recording, _MANY)
    _milliseconds(_footage(recording, 2), DEFAULT)  # Compiled now, not on the clock.
    ours, theirs = _milliseconds(footage, DEFAULT), _milliseconds(footage, DEEPFLOW)
    total = sum(ours.values())
    pixels = float(np.mean([np.isfinite(depth).sum() for depth in footage.moving]))
    return {
        "size": size,
        "moving pixels": pixels,
        "flow ms": ours["flow"],
        "match ms": ours["match"],
        "chain ms": ours["trajectories"],
        "total ms": total,
        "DeepFlow ms": theirs["flow"],
        "share": total / theirs["flow"],
        "us a pixel": 1000 * total / pixels,
        f"MB, {_FEW} frames": _megabytes(_footage(recording, _FEW)),
        f"MB, {_MANY} frames": _megabytes(footage),
    }


def _footage(recording: Recording, frames: int) -> Footage:
    sensed = [frame.depth for frame in recording.frames][:frames]
    return Footage(moving=moving_depths(sensed, DEFAULT), sensed=sensed, camera=recording.camera, fps=recording.fps)


def _milliseconds(footage: Footage, settings: Settings) -> dict[str, float]:
    """The wall-clock time a frame of every stage."""
    watch = Stopwatch()
    flows = timed_flows(flows_between(footage, settings), len(footage.moving), watch)
    spacing_m = mean_point_spacing(footage.sensed, camera=footage.camera)
    trajectories_along(flows, footage, settings, spacing_m, watch)
    return {stage: 1000 * watch.by_stage().get(stage, 0.0) / len(footage.moving) for stage in _STAGES}


def _megabytes(footage: Footage) -> float:
    """The largest memory that the flows of all consecutive frames take, one after the other."""
    flows = flows_between(footage, DEFAULT)
    tracemalloc.start()
    for a, b in pairwise(range(len(footage.moving))):
        flows(a, b)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak / 1e6


if __name__ == "__main__":
    run(app)
