"""How long a motion takes to come back to the same pose: one cycle of the gait of somebody who walks."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from algorithm.trajectories import Trajectories

_SHORTEST_SECONDS, _LONGEST_SECONDS = 0.4, 2.5
"""Cycles that are looked for: from a sprint to a stroll."""
_COUPLES = 15
"""Couples of frames that are compared for every lag, evenly spread."""
_POINTS = 120
"""Points of each that are."""
_FEWEST = 15
"""Points that two frames must have in common to tell anything."""
_REACH = 0.25
"""Neighbours in two frames are at most this share of the motion's extent apart."""
_CLEAR = 0.5
"""Velocities that differ by more than this share of what strangers' do are not those of the same pose."""
_OPPOSITE = 0.7
"""Half a cycle away they must differ by more than this share, or nothing swings, but turns or stands."""
_AS_GOOD, _AS_GOOD_RATIO = 0.03, 1.5
"""Two cycles are as like as one: the shortest of the periods that are about as good as the best is the period."""


def period_frames(trajectories: Trajectories, place: Float[np.ndarray, "observation 3"], *, fps: float) -> float | None:
    """The period of a motion in frames; None for one that has none, as a ball or a box that slides.

    `place` are the trajectories' places in axes that go along. Frames in the same pose have the same velocities at
    the same places: `_unlikeness` compares every two frames, and the period is the lag at whose multiples they
    differ least, as self-similarity finds it in pictures [Cutler, Davis, IEEE PAMI 2000]. Only differences within
    a frame count, so it does not matter where and how fast the motion as a whole is thought to be.
    """
    lag, miss, size = _unlikeness(trajectories, place)
    if not len(lag):
        return None
    total_miss, total_size = (np.bincount(lag, value) for value in (miss, size))
    shortest, longest = _SHORTEST_SECONDS * fps, min(_LONGEST_SECONDS * fps, len(total_size) - 2.0)
    if longest <= shortest:
        return None
    periods = np.geomspace(shortest, longest, 200)
    ratio = np.array([_ratio(total_miss, total_size, period) for period in periods])
    opposite = np.array([_ratio(total_miss, total_size, 0.5 * period, odd=True) for period in periods])
    ratio[~(opposite > _OPPOSITE)] = np.inf  # Unknown is as good as not.
    if not ratio.min() < _CLEAR:
        return None
    first = int(np.argmax(ratio <= _AS_GOOD_RATIO * ratio.min() + _AS_GOOD))
    near = np.flatnonzero(periods <= 1.25 * periods[first])
    near = near[near >= first]
    return float(periods[near[np.argmin(ratio[near])]])


def _ratio(miss: np.ndarray, size: np.ndarray, period: float, *, odd: bool = False) -> float:
    """How unlike frames are that lie multiples of the period apart, odd ones or all; infinite where none do."""
    lag = period * np.arange(1, int((len(size) - 2) / period) + 1, 2 if odd else 1)
    below = lag.astype(int)
    share = lag - below
    total = ((1 - share) * size[below] + share * size[below + 1]).sum()
    known = total > 0.2 * size.sum() / len(size)  # As much as a fifth of a lag's usual share.
    return float(((1 - share) * miss[below] + share * miss[below + 1]).sum() / total) if known else np.inf


def _unlikeness(
    trajectories: Trajectories, place: Float[np.ndarray, "observation 3"]
) -> tuple[Int[np.ndarray, "couple"], Float[np.ndarray, "couple"], Float[np.ndarray, "couple"]]:
    """For every two frames: frames between them, squared differences of velocity at the same places, and what
    these would be were the velocities those of strangers. Each frame's mean velocity is left out."""
    number, frame = trajectories.trajectory, trajectories.frame
    inner = np.flatnonzero(number[2:] == number[:-2]) + 1 if len(number) > 2 else np.zeros(0, int)
    velocity = place[inner + 1] - place[inner - 1]
    spots, speeds, moments = [], [], []
    for moment in np.unique(frame[inner]).tolist():
        rows = np.flatnonzero(frame[inner] == moment)
        rows = rows[_spread(len(rows), _POINTS)]
        if len(rows) >= _FEWEST:
            spots.append(place[inner[rows]])
            speeds.append(velocity[rows])
            moments.append(moment)
    if len(moments) < 2:
        return np.zeros(0, int), np.zeros(0), np.zeros(0)
    reach = _REACH * float(np.sqrt(np.mean([spot.var(axis=0).sum() for spot in spots])))
    trees = [cKDTree(spot) for spot in spots]
    couples = [
        (moments[b] - moments[a], *_compared((spots[a], speeds[a]), (trees[b], speeds[b]), reach))
        for a, b in _couples(np.array(moments))
    ]
    lag, miss, size = np.array(couples).T
    return lag.astype(int), miss, size


def _couples(moments: Int[np.ndarray, "moment"]) -> list[tuple[int, int]]:
    """At most `_COUPLES` couples of moments, the earlier first, for every lag."""
    first, second = np.triu_indices(len(moments), 1)
    lag = moments[second] - moments[first]
    order = np.argsort(lag, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(lag[order])) + 1)
    chosen = np.concatenate([group[_spread(len(group), _COUPLES)] for group in groups])
    return list(zip(first[chosen].tolist(), second[chosen].tolist(), strict=True))


def _compared(
    one: tuple[np.ndarray, np.ndarray], other: tuple[cKDTree, np.ndarray], reach: float
) -> tuple[float, float]:
    """Squared difference of the velocities at the same places, and of strangers'; 0 where too few places agree."""
    spot, speed = one
    tree, speeds = other
    distance, near = tree.query(spot, distance_upper_bound=reach)
    met = np.isfinite(distance)
    if met.sum() < _FEWEST:
        return 0.0, 0.0
    here, there = speed[met], speeds[near[met]]
    difference = here - there
    difference = difference - np.median(difference, axis=0)
    strangers = ((here - here.mean(axis=0)) ** 2).sum() + ((there - there.mean(axis=0)) ** 2).sum()
    return float((difference**2).sum()), float(strangers)


def _spread(count: int, most: int) -> Int[np.ndarray, "chosen"]:
    """At most `most` of so many, evenly spread."""
    return np.linspace(0, count - 1, min(count, most)).astype(int)
