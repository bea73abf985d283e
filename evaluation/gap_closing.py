"""Gap closing by linear assignment [Jaqaman et al., Nature Methods 2008] on detections by DBSCAN, with `laptrack`."""

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, Int

from evaluation.baseline import BaselineSettings, Seconds, baseline_motions
from evaluation.carried import DetectionTrack
from evaluation.detections import Count, Detections, Positive
from recording.errors import InputError
from recording.motions import Motions
from recording.recording import Recording

if TYPE_CHECKING:
    from laptrack import LapTrack

_LEAST_M = 1e-6
"""The least cost of a link: laptrack keeps costs in a sparse matrix, where 0 is no link."""
Chain = list[int]
"""Numbers of detections in order of time."""


class GapClosingSettings(BaselineSettings):
    """The settings of gap closing; the values are those that `benchmarks/tune_baselines.py` found."""

    radius_m: Positive = 0.2
    """Metres: occupied voxels this near are neighbours (DBSCAN's eps)."""
    smallest_voxels: Count = 80
    """Voxels: a smaller cluster is noise."""
    carry_seconds: Seconds = 0.8
    """Seconds before a gap, of which the largest detection's points are carried through it; 0 = the last's."""
    step_m: Positive = 0.4
    """Metres: detections of consecutive frames farther apart are not linked."""
    gap_m: Positive = 2.5
    """Metres: a gap is not closed where both ends, extrapolated to each other, miss by more in the mean."""
    gap_seconds: Positive = 4.0
    """Seconds: a longer gap is not closed."""
    velocity_seconds: Seconds = 0.8
    """Seconds next to the gap from which speed is taken for the extrapolation; 0 = what is lost stands still."""


def gap_closing_motions(recording: Recording, settings: GapClosingSettings | None = None) -> Motions:
    """The motions of gap closing. A motion's place is its detection's centre, and in a gap a straight line."""
    chosen = settings or GapClosingSettings()
    frames, fps = recording.metadata.frames, recording.fps
    return baseline_motions(
        recording,
        chosen,
        lambda detections: closed_tracks(detections, chosen, frames=frames, fps=fps),
        name="gap_closing",
    )


def closed_tracks(
    detections: Detections, settings: GapClosingSettings, *, frames: int, fps: float
) -> list[DetectionTrack]:
    """The tracks of the detections, in the order in which they begin.

    First detections of consecutive frames are linked; then the ends of what that gives are linked over gaps. The cost
    is the distance, over gaps the mean of the misses of both ends' extrapolations.
    """
    if not len(detections.moment):
        return []
    steps = _laptrack(metric=_distance, cutoff=settings.step_m, gap_closing_cutoff=False)
    rows = _by_frame(detections, frames)
    pieces = _chains(steps, rows, detections.centre)
    known = np.concatenate(
        [
            detections.centre,
            _velocities(detections, pieces, round(settings.velocity_seconds * fps), fps),
            detections.moment[:, None] / fps,
        ],
        axis=1,
    )
    gaps = _laptrack(
        metric=_distance,
        cutoff=settings.step_m,
        gap_closing_metric=extrapolation_miss,
        gap_closing_cutoff=settings.gap_m,
        gap_closing_max_frame_count=max(round(settings.gap_seconds * fps), 1),
    )
    shortest = max(settings.shortest_seconds * fps, 1)
    return [_track(detections, chain) for chain in _chains(gaps, rows, known) if len(chain) >= shortest]


def extrapolation_miss(end: Float[np.ndarray, "10"], begin: Float[np.ndarray, "10"]) -> float:
    """By how much the end of a piece, gone on to the time of the other's beginning, misses that, and the other way.

    The mean of both, metres. The ten numbers of a detection: place, the piece's speed where it ends, its speed where it
    begins, and the time.
    """
    seconds = begin[9] - end[9]
    forward = end[:3] + seconds * end[3:6] - begin[:3]
    backward = begin[:3] - seconds * begin[6:9] - end[:3]
    return max(float(np.linalg.norm(forward) + np.linalg.norm(backward)) / 2, _LEAST_M)


def _distance(a: Float[np.ndarray, "quantity"], b: Float[np.ndarray, "quantity"]) -> float:
    """The distance of two places, the first three quantities, metres."""
    return max(float(np.linalg.norm(a[:3] - b[:3])), _LEAST_M)


def require_laptrack() -> None:
    """InputError where the package is missing."""
    if find_spec("laptrack") is None:
        raise InputError(
            "gap_closing: expected the package laptrack, which is not installed: run pip install 'unocclude[compare]', "
            "or leave the method out of --methods"
        )


def _laptrack(**choices: Any) -> "LapTrack":
    require_laptrack()
    from laptrack import LapTrack  # noqa: PLC0415 - an extra that nothing else needs.

    return LapTrack(splitting_cutoff=False, merging_cutoff=False, **choices)


def _by_frame(detections: Detections, frames: int) -> list[Int[np.ndarray, "_candidate"]]:
    """The detections of each frame."""
    return [np.flatnonzero(detections.moment == frame) for frame in range(frames)]


def _chains(
    method: "LapTrack", rows: list[Int[np.ndarray, "_candidate"]], known: Float[np.ndarray, "detection quantity"]
) -> list[Chain]:
    """The chains of detections that the method makes, in the order in which they begin."""
    graph = method.predict([known[row] for row in rows])
    after = {rows[a[0]][a[1]]: rows[b[0]][b[1]] for a, b in graph.edges()}
    begins = sorted({int(rows[frame][index]) for frame, index in graph.nodes()} - {int(one) for one in after.values()})
    chains = []
    for begin in begins:
        chain = [begin]
        while chain[-1] in after:
            chain.append(int(after[chain[-1]]))
        chains.append(chain)
    return chains


def _velocities(
    detections: Detections, pieces: list[Chain], window_frames: int, fps: float
) -> Float[np.ndarray, "detection 6"]:
    """The speed of each detection's piece at its last end, then at its first, metres a second.

    It is the slope of the straight line through the places of the window; 0 without a window, or for one place.
    """
    velocity = np.zeros((len(detections.moment), 6))
    for piece in pieces:
        if window_frames > 0 and len(piece) > 1:
            last, first = np.array(piece[-window_frames - 1 :]), np.array(piece[: window_frames + 1])
            velocity[piece] = np.concatenate([_slope(detections, last, fps), _slope(detections, first, fps)])
    return velocity


def _slope(detections: Detections, chosen: Int[np.ndarray, "hit"], fps: float) -> Float[np.ndarray, "3"]:
    return np.polyfit(detections.moment[chosen] / fps, detections.centre[chosen], 1)[0]


def _track(detections: Detections, chain: Chain) -> DetectionTrack:
    """The detections with a straight line through each gap."""
    chosen = np.array(chain)
    moment, centre = detections.moment[chosen], detections.centre[chosen]
    frame = np.arange(moment[0], moment[-1] + 1)
    place = np.stack([np.interp(frame, moment, centre[:, axis]) for axis in range(3)], axis=1)
    return DetectionTrack(detections=chosen, first=int(moment[0]), position=place)
