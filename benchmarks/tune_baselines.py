"""The baselines tuned as ours is: on development seeds, one set of values for all scenes, by random search.

A trial draws every setting from the values below and is scored on all recordings; its worth is the mean over the
recordings of (HOTA + recall of completion) / 2: HOTA counts every frame in which somebody is in view, hidden or not,
and recall asks for the points of the hidden. Prints the trials from the best to the worst; what the code has as its
defaults is among them. Takes about 20 minutes a method.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

import numpy as np
from cyclopts import App

import unocclude
from benchmarks.tables import Row, run, show
from evaluation.baseline import BaselineSettings
from evaluation.carried import DetectionTrack, motions_of_tracks
from evaluation.detections import Detections, DetectorSettings, MovingPoints, detections_of, moving_points
from evaluation.gap_closing import GapClosingSettings, closed_tracks
from evaluation.scores import scores
from evaluation.tracker import TrackerSettings, tracked_detections
from recording.motions import Making
from recording.visibility import Visibility, visibility_of

app = App(help=__doc__)

Tracks = Callable[..., list[DetectionTrack]]
COMMON: Mapping[str, Sequence[float]] = {
    "radius_m": (0.15, 0.2, 0.3, 0.4),
    "smallest_voxels": (10, 20, 40, 80, 160),
    "shortest_seconds": (0.05, 0.1, 0.2, 0.4),
    "carry_seconds": (0.0, 0.2, 0.4, 0.8),
}
SPACES: Mapping[str, Mapping[str, Sequence[float]]] = {
    "tracker": {
        **COMMON,
        "measurement_m": (0.06, 0.1, 0.15, 0.25, 0.4),
        "acceleration_m_per_s2": (0.5, 1.0, 2.0, 4.0),
        "gate": (2.0, 3.0, 4.0, 6.0),
        "coast_seconds": (0.6, 1.0, 1.5, 2.5, 4.0),
    },
    "gap_closing": {
        **COMMON,
        "step_m": (0.15, 0.25, 0.4, 0.6, 0.9),
        "gap_m": (0.5, 0.75, 1.0, 1.5, 2.5),
        "gap_seconds": (0.6, 1.0, 1.5, 2.5, 4.0),
        "velocity_seconds": (0.0, 0.2, 0.4, 0.8, 1.2),
    },
}
METHODS: Mapping[str, tuple[type[BaselineSettings], Tracks]] = {
    "tracker": (TrackerSettings, tracked_detections),
    "gap_closing": (GapClosingSettings, closed_tracks),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """A recording, with what all trials need of it."""

    recording: unocclude.Recording
    visibility: Visibility
    points: list[MovingPoints]

    @cache  # noqa: B019 - the cases live as long as the program
    def detections(self, settings: DetectorSettings) -> Detections:
        """The detections, which trials with the same detector share."""
        return detections_of(self.points, settings)


@app.default
def tune(
    *,
    method: Literal["tracker", "gap_closing"] = "tracker",
    trials: int = 64,
    crowds: tuple[str, ...] = ("wall", "house", "forest", "9men", "4men"),
    others: tuple[str, ...] = ("juggler3", "juggler5", "scan1", "scan2", "scan3"),
    seeds: tuple[int, ...] = (1, 2),
    json: bool = False,
) -> None:
    """Print the trials of one baseline.

    Args:
        method: The baseline.
        trials: Number of settings drawn, the present defaults apart.
        crowds: Scenes that are taken with every seed.
        others: Scenes that are taken with the first seed.
        seeds: Development seeds.
        json: One JSON object in place of the table.
    """
    names = [(scene, seed) for scene in crowds for seed in seeds] + [(scene, seeds[0]) for scene in others]
    cases = [_case(scene, seed) for scene, seed in names]
    generator = np.random.default_rng(0)
    model, tracks_of = METHODS[method]
    drawn: list[dict[str, Any]] = [{}]  # The defaults.
    drawn += [{name: generator.choice(values).item() for name, values in SPACES[method].items()} for _ in range(trials)]
    rows = []
    for number, values in enumerate(drawn):
        settings = model.model_validate(values)
        rows.append({"trial": str(number or "defaults"), **_trial(cases, settings, tracks_of, SPACES[method])})
        print(f"{number} of {trials}: {rows[-1]['worth']:.3f}", file=sys.stderr, flush=True)
    show(f"{method}, {len(cases)} recordings", sorted(rows, key=lambda row: -row["worth"]), as_json=json)


def _case(scene: str, seed: int) -> Case:
    recording = unocclude.simulate(scene, seed=seed)
    return Case(recording=recording, visibility=visibility_of(recording), points=moving_points(recording))


def _trial(cases: list[Case], settings: BaselineSettings, tracks_of: Tracks, names: Mapping[str, object]) -> Row:
    """The settings, and the means of their scores over the recordings."""
    found = [_scores(case, settings, tracks_of) for case in cases]
    hota = float(np.mean([one["identity"]["hota"] for one in found]))
    recall = float(np.mean([one["completion"]["recall"] for one in found]))
    share = float(np.mean([one["motions"]["found"] / one["objects"] for one in found]))
    chosen = {name: getattr(settings, name) for name in names}
    return {"worth": (hota + recall) / 2, "HOTA": hota, "recall": recall, "found": share, **chosen}


def _scores(case: Case, settings: BaselineSettings, tracks_of: Tracks) -> dict[str, Any]:
    recording = case.recording
    detector = DetectorSettings.model_validate(
        {name: getattr(settings, name) for name in DetectorSettings.model_fields}
    )
    detections = case.detections(detector)
    tracks = tracks_of(detections, settings, frames=recording.metadata.frames, fps=recording.fps)
    carry_frames = round(settings.carry_seconds * recording.fps)
    motions = motions_of_tracks(detections, tracks, carry_frames=carry_frames, making=Making())
    return scores(recording, motions, case.visibility)


if __name__ == "__main__":
    run(app)
