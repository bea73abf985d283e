"""Step 8: short trajectories of one motion joined along its representative (paper, figure 7)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from algorithm.assignment import cheapest_assignment
from algorithm.compiled import compiled
from algorithm.representative import Curve
from algorithm.settings import AlignmentName
from algorithm.trajectories import Trajectories

_CANDIDATES = 8
"""Trajectories that each beginning is compared with: those whose extension comes nearest to it."""

Joins = tuple[Int[np.ndarray, "join"], Int[np.ndarray, "join"], Float[np.ndarray, "join"]]
"""Trajectories that end, trajectories that go on, and the cost of each join in metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Alignment:
    """How the representative is laid on each trajectory: place(t) = rotation r(t) + shift."""

    rotation: Float[np.ndarray, "trajectory 3 3"] | None
    """None where nothing is turned."""
    shift: Float[np.ndarray, "trajectory 3"]

    def extended(
        self, which: Int[np.ndarray, "place"], curve: Float[np.ndarray, "place 3"]
    ) -> Float[np.ndarray, "place 3"]:
        """Where the trajectories would be when the representative is at `curve`."""
        turned = curve if self.rotation is None else np.einsum("pij,pj->pi", self.rotation[which], curve)
        return turned + self.shift[which]


def aligned(trajectories: Trajectories, curve: Curve, *, method: AlignmentName) -> Alignment:
    """The representative laid on every trajectory.

    `rigid`: the best rigid transform over the trajectory's frames [Horn, JOSA A 1987]. A short straight
    trajectory leaves the rotation about its own direction open; of the equally good ones the solution by
    singular values is taken as it comes. `translation`: the shift at the trajectory's last frame.
    """
    followed = curve.position[trajectories.frame - curve.first]
    if method == "translation":
        last = trajectories.first_row + trajectories.length - 1
        shift = trajectories.position[last] - followed[last]
        return Alignment(rotation=None, shift=shift)
    start = trajectories.first_row
    length = trajectories.length[:, None]
    centre = np.add.reduceat(trajectories.position, start, axis=0) / length
    curve_centre = np.add.reduceat(followed, start, axis=0) / length
    own = trajectories.position - centre[trajectories.trajectory]
    base = followed - curve_centre[trajectories.trajectory]
    covariance = np.add.reduceat(own[:, :, None] * base[:, None, :], start, axis=0)
    left, _, right = np.linalg.svd(covariance)
    mirrored = np.linalg.det(left @ right) < 0
    left[mirrored, :, 2] *= -1
    rotation = left @ right
    return Alignment(rotation=rotation, shift=centre - np.einsum("tij,tj->ti", rotation, curve_centre))


def joined(
    trajectories: Trajectories, curve: Curve, alignment: Alignment, *, gate_m: float, longest_frames: float
) -> Joins:
    """Which trajectory goes on as which: the assignment of least total cost.

    Two trajectories are consecutive if the first ends before the second begins, at most `longest_frames`
    apart. The cost is the mean distance of the second from the first's extension. A trajectory that finds
    nothing below `gate_m` stays alone. (The paper's Hungarian method matches everything; see
    `docs/method.md`.)
    """
    before, after = _candidates(trajectories, curve, alignment, gate_m, longest_frames)
    cost = _extension_costs(trajectories, curve, alignment, (before, after))
    good = cost <= gate_m
    before, after, cost = before[good], after[good], cost[good]
    chosen = cheapest_assignment(before, after, cost, alone=gate_m)
    return before[chosen], after[chosen], cost[chosen]


def bridged(
    trajectories: Trajectories, curve: Curve, alignment: Alignment, joins: Joins
) -> tuple[Int[np.ndarray, "place"], Int[np.ndarray, "place"], Float[np.ndarray, "place 3"]]:
    """The missing places of the joined trajectories: number of the join, frame, place in metres.

    Each follows the extension of the trajectory that ends; what this misses at both ends is added in
    proportion, so that the path has no jump.
    """
    before, after, _ = joins
    begin, end = trajectories.last_frame[before], trajectories.first_frame[after]
    missing = np.maximum(end - begin - 1, 0)
    join = np.repeat(np.arange(len(before)), missing)
    frame = begin[join] + 1 + np.arange(missing.sum()) - np.repeat(np.cumsum(missing) - missing, missing)
    share = ((frame - begin[join]) / (end - begin)[join])[:, None]
    last_row = trajectories.first_row[before] + trajectories.length[before] - 1
    miss_begin = trajectories.position[last_row] - alignment.extended(before, _at(curve, begin))
    miss_end = trajectories.position[trajectories.first_row[after]] - alignment.extended(before, _at(curve, end))
    place = alignment.extended(before[join], _at(curve, frame))
    return join, frame, place + (1 - share) * miss_begin[join] + share * miss_end[join]


def _at(curve: Curve, frame: Int[np.ndarray, "place"]) -> Float[np.ndarray, "place 3"]:
    return curve.position[frame - curve.first]


def _candidates(
    trajectories: Trajectories, curve: Curve, alignment: Alignment, gate_m: float, longest_frames: float
) -> tuple[Int[np.ndarray, "pair"], Int[np.ndarray, "pair"]]:
    """For each trajectory the earlier ones whose extension passes near its beginning."""
    first, last = trajectories.first_frame, trajectories.last_frame
    start = trajectories.position[trajectories.first_row]
    by_first, by_last = np.argsort(first, kind="stable"), np.argsort(last, kind="stable")
    firsts, lasts = first[by_first], last[by_last]
    before, after = [np.zeros(0, int)], [np.zeros(0, int)]
    for begun in np.split(by_first, np.flatnonzero(np.diff(firsts)) + 1):
        frame = first[begun[0]] if len(begun) else 0
        since, until = np.searchsorted(lasts, [frame - longest_frames, frame])
        ended = by_last[since:until]
        if not len(ended):
            continue
        place = np.broadcast_to(curve.position[frame - curve.first], (len(ended), 3))
        tree = cKDTree(alignment.extended(ended, place))
        distance, near = tree.query(start[begun], k=min(_CANDIDATES, len(ended)), distance_upper_bound=2 * gate_m)
        distance, near = distance.reshape(len(begun), -1), near.reshape(len(begun), -1)
        row, column = np.nonzero(np.isfinite(distance))
        before.append(ended[near[row, column]])
        after.append(begun[row])
    return np.concatenate(before), np.concatenate(after)


def _extension_costs(
    trajectories: Trajectories, curve: Curve, alignment: Alignment, pairs: tuple[np.ndarray, np.ndarray]
) -> Float[np.ndarray, "pair"]:
    """The mean distance of each second trajectory from the extension of the first, metres."""
    moment = trajectories.frame - curve.first
    rows = trajectories.first_row, trajectories.length
    turned = np.tile(np.eye(3), (trajectories.count, 1, 1)) if alignment.rotation is None else alignment.rotation
    laid = turned, alignment.shift, curve.position
    return np.asarray(_mean_distances(pairs, rows, trajectories.position, moment, laid))


@compiled
def _mean_distances(
    pairs: tuple[np.ndarray, np.ndarray],
    rows: tuple[np.ndarray, np.ndarray],
    position: np.ndarray,
    moment: np.ndarray,
    laid: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> np.ndarray:  # pragma: no cover
    """The mean distance of each pair's second from rotation curve + shift of its first, metres."""
    rotation, shift, curve = laid
    mean = np.zeros(len(pairs[0]))
    for pair in range(len(mean)):
        before, after = pairs[0][pair], pairs[1][pair]
        begin, length = rows[0][after], rows[1][after]
        for row in range(begin, begin + length):
            square = 0.0
            for axis in range(3):
                apart = shift[before, axis] - position[row, axis]
                for other in range(3):
                    apart += rotation[before, axis, other] * curve[moment[row], other]
                square += apart**2
            mean[pair] += np.sqrt(square)
        mean[pair] /= length
    return mean
