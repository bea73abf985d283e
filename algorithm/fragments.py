"""Between steps 6 and 7: limbs that came out as segments of their own go back to their bodies.

The paper has no such step. A swinging arm keeps its distance from nothing, so clustering parts it from its
body; linked on its own it would draw the body's link away.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from algorithm.settings import Settings
from algorithm.trajectories import Trajectories

_POINTS = 300
"""Points of a segment and frame that distances are measured from, at the most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Meetings:
    """What segments have in common in each frame; NaN where they do not meet."""

    size: Float[np.ndarray, "segment frame"]
    """Points."""
    centre: Float[np.ndarray, "segment frame 3"]
    gap: dict[tuple[int, int], Float[np.ndarray, "frame"]]
    """Smallest distance between the points of two segments, metres."""


def absorbed(
    trajectories: Trajectories, segment: Int[np.ndarray, "trajectory"], settings: Settings, *, fps: float
) -> Int[np.ndarray, "trajectory"]:
    """The segments with fragments given to the body that they move with, numbered anew.

    Segment f is a fragment of body b if, over the frames that both have (at least half of f's, and three),
    f has at most `fragment_share` of b's points, their gap is below `fragment_gap_m` in the median, and
    f drifts from b by less than `fragment_drift_m_per_s`. Each goes to its nearest body.
    """
    count = int(segment.max(initial=-1)) + 1
    if count < 2 or settings.fragment_share == 0:
        return segment
    meetings = _meetings(trajectories, segment, count)
    body = np.arange(count)
    for fragment in range(count):
        gaps = {other: _gap(meetings, fragment, other, settings, fps) for other in range(count)}
        nearest = min(gaps, key=lambda other: gaps[other])
        if gaps[nearest] < settings.fragment_gap_m:
            body[fragment] = nearest
    for _ in range(count):
        body = body[body]  # A fragment of a fragment belongs to the last one's body.
    names = np.unique(body)
    number = np.searchsorted(names, body)
    return np.where(segment >= 0, number[segment], -1)


def _gap(meetings: _Meetings, fragment: int, body: int, settings: Settings, fps: float) -> float:
    """The median gap between a fragment and its body; infinite where it is no fragment of it."""
    pair = (min(fragment, body), max(fragment, body))
    if pair not in meetings.gap:
        return np.inf
    common = np.isfinite(meetings.gap[pair])
    frames = int(common.sum())
    size, body_size = meetings.size[fragment], meetings.size[body]
    if frames < max(3, np.isfinite(size).sum() / 2):
        return np.inf
    if fragment == body or size[common].sum() > settings.fragment_share * body_size[common].sum():
        return np.inf
    apart = (meetings.centre[fragment] - meetings.centre[body])[common]
    third = max(1, frames // 3)
    drift_m = float(np.linalg.norm(apart[-third:].mean(axis=0) - apart[:third].mean(axis=0)))
    moment = np.flatnonzero(common)
    if drift_m > settings.fragment_drift_m_per_s * (moment[-third:].mean() - moment[:third].mean()) / fps:
        return np.inf
    return float(np.median(meetings.gap[pair][common]))


def _meetings(trajectories: Trajectories, segment: Int[np.ndarray, "trajectory"], count: int) -> _Meetings:
    label = segment[trajectories.trajectory]
    frames = int(trajectories.frame.max()) + 1
    size = np.full((count, frames), np.nan)
    centre = np.full((count, frames, 3), np.nan)
    gap: dict[tuple[int, int], np.ndarray] = {}
    rows = np.flatnonzero(label >= 0)
    rows = rows[np.lexsort((label[rows], trajectories.frame[rows]))]
    for part in np.split(rows, np.flatnonzero(np.diff(trajectories.frame[rows])) + 1):
        frame = int(trajectories.frame[part[0]])
        groups = np.split(part, np.flatnonzero(np.diff(label[part])) + 1)
        points = {int(label[group[0]]): trajectories.position[group] for group in groups}
        for number, places in points.items():
            size[number, frame] = len(places)
            centre[number, frame] = places.mean(axis=0)
        trees = {number: cKDTree(places[:: len(places) // _POINTS + 1]) for number, places in points.items()}
        for pair in combinations(sorted(trees), 2):
            nearest = trees[pair[0]].query(trees[pair[1]].data)[0].min()
            gap.setdefault(pair, np.full(frames, np.nan))[frame] = nearest
    return _Meetings(size=size, centre=centre, gap=gap)
