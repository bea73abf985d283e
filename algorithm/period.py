"""How long a motion takes to come back to the same pose: one cycle of the gait of somebody who walks."""

import numpy as np
from jaxtyping import Float, Int

from algorithm.compiled import compiled
from algorithm.trajectories import Trajectories

_SHORTEST_SECONDS, _LONGEST_SECONDS = 0.7, 2.5
"""Cycles that are looked for: from a sprint to a stroll."""
_COUPLES = 25
"""Couples of frames that are compared for every lag, evenly spread."""
_POINTS = 120
"""Points of each that are."""
_FEWEST = 15
"""Points that two frames must have in common to tell anything."""
_REACH = 0.25
"""Neighbours in two frames are at most this share of the motion's extent apart."""
_CLEAR = 0.6
"""Velocities that differ by more than this share of what strangers' do are not those of the same pose."""
_MULTIPLES = (np.arange(1, 200, 2), np.arange(2, 200, 2), np.arange(1, 200, 2) / 2)
"""Of the period: the odd ones, the even ones, and those half-way between."""
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
    odd, even, opposite = (
        np.array([_ratio(total_miss, total_size, lags * period) for period in periods]) for lags in _MULTIPLES
    )
    ratio = np.where(np.isfinite(even), np.maximum(odd, even), odd)  # Half a period has only even ones in its favour.
    ratio[~(opposite > _OPPOSITE)] = np.inf  # Unknown is as good as not.
    if not ratio.min() < _CLEAR:
        return None
    first = int(np.argmax(ratio <= _AS_GOOD_RATIO * ratio.min() + _AS_GOOD))
    near = np.flatnonzero(periods <= 1.25 * periods[first])
    near = near[near >= first]
    return float(periods[near[np.argmin(ratio[near])]])


def _ratio(miss: np.ndarray, size: np.ndarray, lag: np.ndarray) -> float:
    """How unlike frames are that lie so far apart, all lags together; infinite where no frames do."""
    lag = lag[lag <= len(size) - 2]
    below = lag.astype(int)
    share = lag - below
    total = ((1 - share) * size[below] + share * size[below + 1]).sum()
    known = total > 0.2 * size.sum() / len(size)  # As much as a fifth of a lag's usual share.
    return float(((1 - share) * miss[below] + share * miss[below + 1]).sum() / total) if known else np.inf


def _unlikeness(
    trajectories: Trajectories, place: Float[np.ndarray, "observation 3"]
) -> tuple[Int[np.ndarray, "couple"], Float[np.ndarray, "couple"], Float[np.ndarray, "couple"]]:
    """Of couples of frames: the frames between them, their velocities' squared differences, and those of strangers.

    Velocities are compared at the same places; what all places have in common in a frame is left out.
    """
    number, frame = trajectories.trajectory, trajectories.frame
    inner = np.flatnonzero(number[2:] == number[:-2]) + 1 if len(number) > 2 else np.zeros(0, int)
    inner = inner[np.argsort(frame[inner], kind="stable")]
    moments, begin, count = np.unique(frame[inner], return_index=True, return_counts=True)
    shown = count >= _FEWEST
    if shown.sum() < 2:
        return np.zeros(0, int), np.zeros(0), np.zeros(0)
    groups = zip(begin[shown].tolist(), count[shown].tolist(), strict=True)
    rows = [inner[first + _spread(size, _POINTS)] for first, size in groups]
    start = np.cumsum([0, *(len(part) for part in rows)])
    row = np.concatenate(rows)
    spot, speed = place[row], place[row + 1] - place[row - 1]
    reach = _REACH * float(np.sqrt(np.mean([part.var(axis=0).sum() for part in np.split(spot, start[1:-1])])))
    one, other = _couples(moments[shown]).T
    miss, size = _compared(np.ascontiguousarray(one), np.ascontiguousarray(other), start, (spot, speed), reach)
    return moments[shown][other] - moments[shown][one], miss, size


def _couples(moments: Int[np.ndarray, "moment"]) -> Int[np.ndarray, "couple 2"]:
    """At most `_COUPLES` couples of moments, the earlier first, for every lag."""
    first, second = np.triu_indices(len(moments), 1)
    lag = moments[second] - moments[first]
    order = np.argsort(lag, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(lag[order])) + 1)
    chosen = np.concatenate([group[_spread(len(group), _COUPLES)] for group in groups])
    return np.stack([first[chosen], second[chosen]], axis=1)


@compiled
def _compared(
    one: np.ndarray, other: np.ndarray, start: np.ndarray, moving: tuple[np.ndarray, np.ndarray], reach: float
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """Squared difference of two moments' velocities at the same places, and of strangers'; 0 where too few agree.

    Moment i has the points `start[i]` to `start[i + 1]`; each is compared with the other moment's nearest one.
    """
    spot, speed = moving
    miss, size = np.zeros(len(one)), np.zeros(len(one))
    for couple in range(len(one)):
        points = start[one[couple]], start[one[couple] + 1]
        pairs = _nearest(spot, points, (start[other[couple]], start[other[couple] + 1]), reach)
        if len(pairs) < _FEWEST:
            continue
        here, there = speed[pairs[:, 0]], speed[pairs[:, 1]]
        for axis in range(3):
            difference = here[:, axis] - there[:, axis]
            miss[couple] += ((difference - np.median(difference)) ** 2).sum()
            size[couple] += len(pairs) * (here[:, axis].var() + there[:, axis].var())
    return miss, size


@compiled
def _nearest(
    spot: np.ndarray, points: tuple[int, int], others: tuple[int, int], reach: float
) -> np.ndarray:  # pragma: no cover
    """Each of some points with the nearest of the others, nearer than the reach."""
    found, pairs = 0, np.empty((points[1] - points[0], 2), np.int64)
    for point in range(points[0], points[1]):
        least, nearest = reach**2, -1
        for candidate in range(others[0], others[1]):
            square = 0.0
            for axis in range(3):
                square += (spot[point, axis] - spot[candidate, axis]) ** 2
            if square < least:
                least, nearest = square, candidate
        if nearest >= 0:
            pairs[found, 0], pairs[found, 1] = point, nearest
            found += 1
    return pairs[:found]


def _spread(count: int, most: int) -> Int[np.ndarray, "chosen"]:
    """At most `most` of so many, evenly spread."""
    return np.linspace(0, count - 1, min(count, most)).astype(int)
