"""Step 5: which trajectories share a fate (paper, section 4, Motion segmentation)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.spatial import cKDTree

from algorithm.trajectories import Trajectories

_ROWS_AT_ONCE = 2_000_000
_KEYS_AT_ONCE = 1_000_000

IndexPairs = tuple[Int[np.ndarray, "pair"], Int[np.ndarray, "pair"]]


@dataclass(frozen=True, kw_only=True, eq=False)
class PairStatistics:
    """The distance of two trajectories over the frames that both have, in the unit of the positions."""

    overlap: Int[np.ndarray, "pair"]
    """Number of common frames."""
    largest: Float[np.ndarray, "pair"]
    mean: Float[np.ndarray, "pair"]
    variance: Float[np.ndarray, "pair"]


def neighbour_pairs(trajectories: Trajectories, *, neighbours: int, radius_m: float) -> IndexPairs:
    """The pairs of trajectories (i < j) that are near neighbours in some frame.

    Near means one of the `neighbours` nearest within `radius_m`. Pairs that never meet need no affinity:
    that keeps the cost linear in the number of trajectories.
    """
    known, fresh, waiting = np.zeros(0, np.int64), [], 0
    order = np.argsort(trajectories.frame, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(trajectories.frame[order])) + 1):
        if len(rows) < 2:
            continue
        points, number = trajectories.position[rows], trajectories.trajectory[rows]
        count = min(neighbours + 1, len(rows))
        distance, other = cKDTree(points).query(points, k=count, distance_upper_bound=radius_m)
        near = np.isfinite(distance) & (other != np.arange(len(rows))[:, None])
        first = np.broadcast_to(number[:, None], near.shape)[near]
        second = number[other[near]]
        fresh.append(_each_once(np.minimum(first, second) * trajectories.count + np.maximum(first, second)))
        waiting += len(fresh[-1])
        if waiting > max(len(known), _KEYS_AT_ONCE):  # So the same pairs of many frames are not kept all at once.
            known, fresh, waiting = _each_once(np.concatenate([known, *fresh])), [], 0
    key = _each_once(np.concatenate([known, *fresh]))
    return key // max(trajectories.count, 1), key % max(trajectories.count, 1)


def _each_once(key: Int[np.ndarray, "key"]) -> Int[np.ndarray, "once"]:
    """The keys in order, each once. NumPy's `unique` hashes them, which takes ten times as long."""
    key = np.sort(key)
    return key[np.diff(key, prepend=-1) != 0]


def pair_statistics(trajectories: Trajectories, pairs: IndexPairs) -> PairStatistics:
    """The distances of the pairs of trajectories over their common frames.

    A pair without a common frame has overlap 0 and NaN for the rest.
    """
    first, second = pairs
    begin = np.maximum(trajectories.first_frame[first], trajectories.first_frame[second])
    end = np.minimum(trajectories.last_frame[first], trajectories.last_frame[second])
    overlap = np.maximum(end - begin + 1, 0)
    row = [trajectories.first_row[side] + begin - trajectories.first_frame[side] for side in (first, second)]
    values = np.full((3, len(first)), np.nan)
    for part in _parts(overlap):
        values[:, part] = _distances(trajectories.position, row[0][part], row[1][part], overlap[part])
    largest, mean, variance = values
    return PairStatistics(overlap=overlap, largest=largest, mean=mean, variance=variance)


def product_distance(statistics: PairStatistics, *, unit_m: float) -> Float[np.ndarray, "pair"]:
    """The paper's traj_sim = max^2 avg^2 var^2 / overlap, with distances in mean point spacings.

    It is a distance: 0 for two trajectories that keep theirs exactly, however far apart they are, and so for
    two with a single common frame; NaN without one.
    """
    largest, mean = statistics.largest / unit_m, statistics.mean / unit_m
    variance = statistics.variance / unit_m**2
    return largest**2 * mean**2 * variance**2 / np.maximum(statistics.overlap, 1)


def similarity(distance: Float[np.ndarray, "pair"], *, eps3: float) -> Float[np.ndarray, "pair"]:
    """1 / (1 + traj_sim / epsilon 3): from 1 down to a half for the pairs that are not ignored."""
    return 1.0 / (1.0 + distance / eps3)


def affinity_matrix(pairs: IndexPairs, affinity: Float[np.ndarray, "pair"], *, count: int) -> sparse.csr_array:
    """The symmetric sparse matrix of the affinities."""
    half = sparse.coo_array((affinity, pairs), shape=(count, count))
    return sparse.csr_array(half + half.T)


def _parts(overlap: Int[np.ndarray, "pair"]) -> list[np.ndarray]:
    """The pairs with common frames, in parts of bounded size."""
    met = np.flatnonzero(overlap)
    if not len(met):
        return []
    part = np.cumsum(overlap[met]) // _ROWS_AT_ONCE
    return np.split(met, np.flatnonzero(np.diff(part)) + 1)


def _distances(
    position: np.ndarray, row_first: np.ndarray, row_second: np.ndarray, overlap: np.ndarray
) -> Float[np.ndarray, "3 pair"]:
    """Largest, mean and variance of the distances of rows that run in parallel for `overlap` rows."""
    start = np.concatenate([[0], np.cumsum(overlap)[:-1]])
    along = np.arange(overlap.sum()) - np.repeat(start, overlap)
    difference = position[np.repeat(row_first, overlap) + along] - position[np.repeat(row_second, overlap) + along]
    distance = np.linalg.norm(difference, axis=1)
    mean = np.add.reduceat(distance, start) / overlap
    variance = np.add.reduceat((distance - np.repeat(mean, overlap)) ** 2, start) / overlap
    return np.stack([np.maximum.reduceat(distance, start), mean, variance])
