"""Step 9: segments joined across holes by smooth curves (paper, figure 8)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy.polynomial import chebyshev
from scipy.optimize import linear_sum_assignment

from algorithm.representative import Curve
from algorithm.trajectories import Trajectories
from recording.camera import Camera

LOWEST_DEGREE, HIGHEST_DEGREE = 2, 7


@dataclass(frozen=True, kw_only=True, eq=False)
class Polynomial:
    """A smooth curve in time: x(t), y(t), z(t) as Chebyshev series on normalised time."""

    degree: int
    coefficients: Float[np.ndarray, "coefficient 3"]
    begin: float
    """The frame that normalised time takes to -1."""
    end: float
    """The frame that normalised time takes to 1."""
    error_m: float
    """Mean distance from the first representative plus mean distance from the second, metres."""

    @property
    def cost(self) -> float:
        """The error weighted by the degree: error * exp(degree), metres."""
        return self.error_m * float(np.exp(self.degree))

    def at(self, frame: Float[np.ndarray, "moment"]) -> Float[np.ndarray, "moment 3"]:
        """The places of the curve, metres."""
        return np.stack(chebyshev.chebval(self._normalised(frame), self.coefficients), axis=-1)

    def _normalised(self, frame: np.ndarray) -> np.ndarray:
        return 2.0 * (frame - self.begin) / max(self.end - self.begin, 1.0) - 1.0


def fitted_polynomial(before: Curve, after: Curve, *, degree: int) -> Polynomial:
    """The least-squares polynomial of the degree through both curves."""
    frame = np.concatenate([before.frames, after.frames]).astype(float)
    place = np.concatenate([before.position, after.position])
    begin, end = float(frame[0]), float(frame[-1])
    normalised = 2.0 * (frame - begin) / max(end - begin, 1.0) - 1.0
    basis = chebyshev.chebvander(normalised, degree)
    coefficients = np.linalg.lstsq(basis, place, rcond=None)[0]
    miss = np.linalg.norm(basis @ coefficients - place, axis=1)
    size = len(before.position)
    error = float(miss[:size].mean() + miss[size:].mean())
    return Polynomial(degree=degree, coefficients=coefficients, begin=begin, end=end, error_m=error)


def smoothest_polynomial(before: Curve, after: Curve, *, eps6_m: float) -> Polynomial | None:
    """The polynomial of the lowest degree, 2 to 7, whose error is below epsilon 6; None where none is.

    A degree needs more places than it has coefficients.
    """
    places = len(before.position) + len(after.position)
    for degree in range(LOWEST_DEGREE, min(HIGHEST_DEGREE, places - 2) + 1):
        found = fitted_polynomial(before, after, degree=degree)
        if found.error_m < eps6_m:
            return found
    return None


def linked(
    curves: Sequence[Curve],
    ends: Sequence[Curve],
    weight: Float[np.ndarray, "curve"],
    *,
    eps6_m: float,
    ends_frames: float,
    longest_frames: float,
) -> Mapping[tuple[int, int], Polynomial]:
    """Which curve goes on as which, and along which polynomial: the assignment of least total cost.

    Curve b may follow a if a ends before b begins, at most `longest_frames` apart, and a polynomial
    through the last and the first `ends_frames` of their trusted parts, `ends`, has an error below
    epsilon 6. A curve may also stay alone at either end, for people enter and leave; that costs the more
    the greater its `weight` (0 to 1) is, and a link costs the more the less equal the weights are, so that
    a body is neither left alone for the sake of a scrap nor linked to one.
    """
    candidates: dict[tuple[int, int], Polynomial] = {}
    for i, before in enumerate(curves):
        for j, after in enumerate(curves):
            if 0 < after.first - before.last <= longest_frames:
                found = smoothest_polynomial(*_ends(ends[i], ends[j], ends_frames), eps6_m=eps6_m)
                if found is not None:
                    candidates[i, j] = found
    return {pair: candidates[pair] for pair in _assigned(candidates, weight, eps6_m)}


def joined_by_polynomials(
    ends: Sequence[Curve], pairs: Sequence[tuple[int, int]], *, eps6_m: float, ends_frames: float
) -> Mapping[tuple[int, int], Polynomial]:
    """The polynomial through the ends of each pair of curves that are known to go on as one another.

    It is the smoothest one as in `linked`; where none has an error below epsilon 6, that of the lowest degree.
    """
    found = {}
    for i, j in pairs:
        before, after = _ends(ends[i], ends[j], ends_frames)
        smoothest = smoothest_polynomial(before, after, eps6_m=eps6_m)
        found[i, j] = smoothest or fitted_polynomial(before, after, degree=LOWEST_DEGREE)
    return found


def seen_areas(
    trajectories: Trajectories, segment: Int[np.ndarray, "trajectory"], *, camera: Camera
) -> Float[np.ndarray, "segment"]:
    """How much was seen of each segment, from 0 to 1 for the most: its area over all its frames.

    The area behind a pixel grows with the square of the distance, so who is far away counts as much.
    """
    label = segment[trajectories.trajectory]
    seen = label >= 0
    distance = np.linalg.norm(trajectories.position[seen] - camera.position, axis=1)
    area = np.bincount(label[seen], distance**2)
    return area / area.max(initial=1e-12)


def _assigned(
    candidates: Mapping[tuple[int, int], Polynomial], weight: Float[np.ndarray, "curve"], eps6_m: float
) -> list[tuple[int, int]]:
    """The links of least total cost.

    A link costs its polynomial times the root of the ratio of the weights; at either end a curve of weight
    w stays alone for w^1.5 times the dearest polynomial. (The exponents are from development seeds.)
    """
    alone = eps6_m * np.exp(HIGHEST_DEGREE) * weight**1.5
    count = len(alone)
    never = 4.0 * (alone.sum() + sum(found.cost for found in candidates.values()) + 1.0)
    cost = np.full((2 * count, 2 * count), never)
    cost[:count, count:][np.diag_indices(count)] = alone
    cost[count:, :count][np.diag_indices(count)] = alone
    cost[count:, count:] = 0.0
    for (before, after), polynomial in candidates.items():
        low, high = sorted((weight[before], weight[after]))
        cost[before, after] = polynomial.cost * np.sqrt(high / max(low, 1e-12))
    rows, columns = linear_sum_assignment(cost)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if (i, j) in candidates]


def _ends(before: Curve, after: Curve, frames: float) -> tuple[Curve, Curve]:
    """The last frames of the first curve and the first frames of the second."""
    length = int(min(frames, 1e6))
    return (
        before.between(max(before.first, before.last - length + 1), before.last),
        after.between(after.first, min(after.last, after.first + length - 1)),
    )


def trusted(curve: Curve, *, share: float, window_frames: int) -> Curve:
    """The curve without faint ends: frames with fewer than `share` of the window's median number of points.

    Where someone goes behind a wall the last sliver of him, an arm perhaps, says little about his place.
    """
    reach = max(window_frames, 1)
    begin = np.flatnonzero(curve.points >= share * np.median(curve.points[:reach]))
    end = np.flatnonzero(curve.points >= share * np.median(curve.points[-reach:]))
    return curve.between(curve.first + int(begin[0]), curve.first + max(int(end[-1]), int(begin[0])))


def chains(links: Mapping[tuple[int, int], Polynomial], count: int) -> list[list[int]]:
    """The segments of every motion in order of time; a segment without links is a motion of its own."""
    after = dict(links.keys())
    found = []
    for segment in sorted(set(range(count)) - set(after.values())):
        chain = [segment]
        while chain[-1] in after:
            chain.append(after[chain[-1]])
        found.append(chain)
    return found


def chain_curve(curves: Sequence[Curve], ends: Sequence[Curve], polynomials: Sequence[Polynomial]) -> Curve:
    """The representative of a motion: its segments' curves in turn, and the polynomials between them.

    `ends` are the same curves without their faint ends: those are replaced where a polynomial joins them,
    and kept where the motion begins and ends. What a polynomial misses at the ends of a hole is added in
    proportion, so that the path has no jump.
    """
    first, last = curves[0].first, curves[-1].last
    position = [curves[0].between(first, ends[0].first - 1).position, ends[0].position]
    points = [curves[0].between(first, ends[0].first - 1).points, ends[0].points]
    for before, after, polynomial in zip(ends[:-1], ends[1:], polynomials, strict=True):
        frame = np.arange(before.last, after.first + 1)
        path = polynomial.at(frame.astype(float))
        share = ((frame - before.last) / (after.first - before.last))[:, None]
        path += (1 - share) * (before.position[-1] - path[0]) + share * (after.position[0] - path[-1])
        position += [path[1:-1], after.position]
        points += [np.zeros(len(frame) - 2), after.points]
    position.append(curves[-1].between(ends[-1].last + 1, last).position)
    points.append(curves[-1].between(ends[-1].last + 1, last).points)
    return Curve(first=first, position=np.concatenate(position), points=np.concatenate(points))
