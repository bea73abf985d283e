"""Trajectories against the truth: how long, how much of what moves is on one, how far they drift.

Each row is a way to make them, the mean over seeds: the default preset; the paper's rules (DeepFlow on grey, pixel to
pixel); and the true flow under both rules, which bounds what chaining can reach. Takes about a minute a scene and seed.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

import numpy as np
from cyclopts import App

import unocclude
from algorithm.given import NOTHING_GIVEN, Given
from algorithm.pipeline import followed_points
from algorithm.settings import Settings, changed_settings
from algorithm.stopwatch import Stopwatch
from benchmarks.tables import Row, mean_row, run, show
from evaluation.drift import AGES, Drift, drift_of
from evaluation.oracles import true_flow
from recording.recording import Recording
from simulator.scene import load_scene

app = App(help=__doc__)
DEFAULT = Settings()
PAPER_RULES = changed_settings(
    DEFAULT, {"flow": "deepflow", "image": "grey", "chaining": "pixels", "eps1": 0.5}, source="paper's rules"
)
PIXELS = changed_settings(DEFAULT, {"chaining": "pixels", "eps1": 0.5}, source="pixels")


@app.default
def trajectories(
    *,
    scenes: tuple[str, ...] = ("9men@30", "9men", "wall"),
    seeds: tuple[int, ...] = (1001, 1002, 1003),
    size: str = "240x180",
    sensor: str | None = None,
    json: bool = False,
) -> None:
    """Print the table.

    Args:
        scenes: Names of scenes; `9men@30` is 9men at 30 frames a second.
        seeds: 1 to 20 are for development, 1001 to 1010 for reporting.
        size: Picture size.
        sensor: Sensor preset in place of the scenes' own.
        json: One JSON object in place of the table.
    """
    rows: list[Row] = []
    for name in scenes:
        measured: dict[str, list[Row]] = {}
        for seed in seeds:
            recording = _recorded(name, seed, size, sensor)
            truth = true_flow(recording)
            arms = {
                "default": (DEFAULT, NOTHING_GIVEN),
                "paper's rules": (PAPER_RULES, NOTHING_GIVEN),
                "true flow": (DEFAULT, truth),
                "true flow, pixels": (PIXELS, truth),
            }
            for arm, (settings, given) in arms.items():
                measured.setdefault(arm, []).append(_row(recording, settings, given))
        rows += [{"scene": name, "trajectories": arm} | mean_row(each) for arm, each in measured.items()]
    show(f"Trajectories, seeds {', '.join(map(str, seeds))}, {size}", rows, as_json=json)


def _recorded(name: str, seed: int, size: str, sensor: str | None) -> Recording:
    scene, _, fps = name.partition("@")
    found = load_scene(scene)
    if fps:
        found = found.model_copy(update={"fps": float(fps)})
    return unocclude.simulate(found, seed=seed, size=size, sensor=sensor)


def _row(recording: Recording, settings: Settings, given: Given) -> Row:
    watch = Stopwatch()
    drift = drift_of(recording, followed_points(recording, settings, watch, given).trajectories)
    seconds = watch.by_stage()
    spent = sum(seconds.get(stage, 0.0) for stage in ("flow", "match", "trajectories"))
    return _quality(drift) | {"ms a frame": 1000 * spent / recording.metadata.frames}


def _quality(drift: Drift) -> Row:
    count = max(len(drift.length), 1)
    return {
        "frames": float(drift.length.mean()) if len(drift.length) else 0.0,
        "median": float(np.median(drift.length)) if len(drift.length) else 0.0,
        "coverage": drift.coverage,
        "within 5 cm": drift.covered_within(0.05),
        "within 10 cm": drift.covered_within(0.10),
        "two objects": float(drift.two_objects.sum()) / count,
        "ends astray": float(drift.ends_astray.sum()) / count,
    } | {f"cm at {age}": 100 * drift.median_at(age) for age in AGES}


if __name__ == "__main__":
    run(app)
