"""Where the time goes: seconds by stage from a recording to its motions, beside DeepFlow alone on the same frames.

DeepFlow, forward and backward between all consecutive frames, is the yardstick for the machine: timings scatter, their
ratio to it less so. Compiling is not counted. Takes about three minutes.
"""

import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import Annotated

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

from cyclopts import App, Parameter

import unocclude
from algorithm.depth_image import depth_range, grey_image
from algorithm.flow import flow_b_from_a
from algorithm.settings import Preset
from benchmarks.tables import Row, run, show
from evaluation.methods import settings_of
from evaluation.scores import STAGES
from recording.recording import Recording, stripped

app = App(help=__doc__)
WARM_FRAMES = 12
"""Frames that are solved first, so that everything is compiled."""


@app.default
def stages(
    *,
    scene: str = "9men",
    seed: int = 1,
    size: str = "240x180",
    presets: Annotated[tuple[Preset, ...], Parameter(consume_multiple=True, negative="")] = ("default", "paper"),
    json: bool = False,
) -> None:
    """Print a row for each preset, and one for DeepFlow.

    Args:
        scene: Name of the scene.
        seed: 1 to 20 are for development, 1001 to 1010 for reporting.
        size: Picture size.
        presets: Settings to solve with.
        json: One JSON object in place of the table.
    """
    recording = unocclude.simulate(scene, seed=seed, size=size)
    yardstick_s = deepflow_seconds(recording)
    rows: list[Row] = [_row(recording, preset) for preset in presets]
    rows.append({"preset": "DeepFlow alone", "flow": yardstick_s, "total": yardstick_s})
    for row in rows:
        row["of DeepFlow"] = row["total"] / yardstick_s
        row["frames/s"] = recording.metadata.frames / row["total"]
    show(f"{scene}, seed {seed}, {size}, {recording.metadata.frames} frames: seconds", rows, as_json=json)


def deepflow_seconds(recording: Recording) -> float:
    """The time of DeepFlow there and back between all consecutive frames, on their depth as grey, by one thread."""
    depths = [frame.depth for frame in recording.frames]
    within = depth_range(depths)
    images = [grey_image(depth, within=within) for depth in depths]
    begun = time.perf_counter()
    for a, b in pairwise(images):
        flow_b_from_a(a, b, method="deepflow")
        flow_b_from_a(b, a, method="deepflow")
    return time.perf_counter() - begun


def _row(recording: Recording, preset: Preset) -> Row:
    """The seconds of each stage, what is in no stage, and all of them."""
    settings, seen = settings_of(recording, preset), stripped(recording)
    unocclude.solve(_first_frames(seen), settings)
    seconds = unocclude.solve(seen, settings).making.seconds
    named = {stage: spent for stage, spent in seconds.items() if stage != "total"}
    order = [stage for stage in STAGES if stage in named] + [stage for stage in named if stage not in STAGES]
    other = {"other": seconds["total"] - sum(named.values()), "total": seconds["total"]}
    return {"preset": preset} | {stage: named[stage] for stage in order} | other


def _first_frames(recording: Recording) -> Recording:
    metadata = recording.metadata.model_copy(update={"frames": WARM_FRAMES})
    return Recording(metadata=metadata, frames=tuple(recording.frames)[:WARM_FRAMES])


if __name__ == "__main__":
    run(app)
