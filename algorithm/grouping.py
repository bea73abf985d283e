"""Steps 5 and 6 of the default: trajectories that keep together become segments, bottom up.

Neighbouring trajectories are united in the order of how well they keep together, as in graph merging [Felzenszwalb
and Huttenlocher, IJCV 2004]; not a threshold stops it, but size: a union is refused that is larger than a body. So
a swinging arm, which keeps its distance from nothing, still comes to its body in the end, and two people in step
stay two.
"""

import numpy as np
from jaxtyping import Float, Int

from algorithm.affinity import IndexPairs, neighbour_pairs
from algorithm.compiled import compiled
from algorithm.outlines import Intervals, reaches, size_limits, united
from algorithm.settings import Settings
from algorithm.trajectories import Trajectories

_MOMENT_SECONDS = 0.1
"""Extents are compared, and neighbours looked for, about so often."""
_LAG_SECONDS = 0.13
"""Relative speed is measured over this time."""
_SPEED_SECONDS = 0.17
"""A relative speed counts as the distance that it makes in this time."""
_TRUST_SECONDS = 0.17
"""Pairs that are together for this time count half as good as such that always are."""
_LEAST_FRAMES = 3
"""Common frames that say anything of a pair."""
_PAIRS_AT_ONCE = 500_000
"""Bounds the memory."""
_MOMENTS_TOO_LARGE = 1
"""Moments in which a union may be too large all the same: one bad match shall not part a body."""


def groups(trajectories: Trajectories, settings: Settings, *, fps: float) -> Int[np.ndarray, "trajectory"]:
    """The segment of every trajectory, from 0.

    Pairs of neighbours are united in the order of their `separations`, up to `loosest_m`, unless the union was wider
    than `widest_m` or taller than `tallest_m`.
    """
    if not trajectories.count:
        return np.zeros(0, int)
    stride = max(1, round(_MOMENT_SECONDS * fps))
    moments = _moments(trajectories, stride)
    pairs = _in_order(trajectories, moments, settings, fps)
    intervals, reach = _intervals(moments, trajectories.count, stride), reaches(moments.position)
    del moments  # Of many trajectories they are large, and what follows needs room.
    limit = size_limits(widest_m=settings.widest_m, tallest_m=settings.tallest_m)
    root = united(pairs, intervals, reach, limit, _MOMENTS_TOO_LARGE)
    return np.unique(root, return_inverse=True)[1]


def _in_order(trajectories: Trajectories, moments: Trajectories, settings: Settings, fps: float) -> IndexPairs:
    """The pairs of neighbours, those first that keep together best; without those that do not."""
    one, other = neighbour_pairs(moments, neighbours=settings.neighbours, radius_m=settings.neighbour_radius_m)
    separation = separations(trajectories, (one, other), fps=fps, loosest_m=settings.loosest_m)
    order = np.argsort(separation, kind="stable")[: int(np.isfinite(separation).sum())]
    return one[order], other[order]


def separations(
    trajectories: Trajectories, pairs: IndexPairs, *, fps: float, loosest_m: float
) -> Float[np.ndarray, "pair"]:
    """How little two trajectories keep together, metres; infinite where they are no neighbours.

    (largest distance + 0.17 s * largest relative speed) * (1 + 0.17 s / time together). Infinite where that is
    above `loosest_m` or fewer than three frames are common.
    """
    lasting = Intervals(trajectories.first_frame, trajectories.length, trajectories.first_row)
    lag, found = max(1, round(_LAG_SECONDS * fps)), np.empty(len(pairs[0]))
    for begin in range(0, len(found), _PAIRS_AT_ONCE):
        part = slice(begin, begin + _PAIRS_AT_ONCE)
        frames, distance, speed = _together((pairs[0][part], pairs[1][part]), lasting, trajectories.position, lag).T
        separation = (distance + _SPEED_SECONDS * fps * speed) * (1.0 + _TRUST_SECONDS * fps / np.maximum(frames, 1.0))
        found[part] = np.where((frames >= _LEAST_FRAMES) & (separation <= loosest_m), separation, np.inf)
    return found


def _moments(trajectories: Trajectories, stride: int) -> Trajectories:
    """The observations in every so many frames, under the same numbers."""
    rows = trajectories.frame % stride == 0
    return Trajectories(
        trajectory=trajectories.trajectory[rows],
        frame=trajectories.frame[rows],
        position=trajectories.position[rows],
        column_row=np.broadcast_to(np.nan, (int(rows.sum()), 2)),  # Nobody asks where in the picture they were.
    )


def _intervals(moments: Trajectories, count: int, stride: int) -> Intervals:
    """First moment, number of moments and first row of every trajectory."""
    number = np.bincount(moments.trajectory, minlength=count)
    row = np.cumsum(number) - number
    first = np.zeros(count, int)
    first[number > 0] = moments.frame[row[number > 0]] // stride
    return Intervals(first, number, row)


@compiled
def _together(pairs: tuple[np.ndarray, np.ndarray], lasting: Intervals, position: np.ndarray, lag: int) -> np.ndarray:
    """Common frames, largest distance (metres) and largest relative speed (metres a frame) of each pair."""
    found = np.zeros((len(pairs[0]), 3))
    for number in range(len(pairs[0])):
        one, other = pairs[0][number], pairs[1][number]
        first = max(lasting.first[one], lasting.first[other])
        frames = min(lasting.first[one] + lasting.lasts[one], lasting.first[other] + lasting.lasts[other]) - first
        if frames < 1:
            continue
        row_one = lasting.row[one] + first - lasting.first[one]
        row_other = lasting.row[other] + first - lasting.first[other]
        step = min(lag, frames - 1)
        farthest, fastest = 0.0, 0.0
        for along in range(frames):
            distance, drift = 0.0, 0.0
            for axis in range(3):
                apart = position[row_one + along, axis] - position[row_other + along, axis]
                distance += apart**2
                if along >= step:
                    before = position[row_one + along - step, axis] - position[row_other + along - step, axis]
                    drift += (apart - before) ** 2
            farthest, fastest = max(farthest, distance), max(fastest, drift)
        found[number, 0], found[number, 1] = frames, np.sqrt(farthest)
        found[number, 2] = np.sqrt(fastest) / max(step, 1)
    return found
