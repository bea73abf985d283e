"""Step 9: segments joined across holes by smooth curves (paper, figure 8)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy.polynomial import chebyshev
from scipy.optimize import linear_sum_assignment

from algorithm.representative import Curve

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
    """The least-squares polynomial of the degree in time through all places of both curves.

    (The paper prints a_n p^n + ... + a_0 = 0, by which no curve in space is fitted.)
    """
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


def polynomial_links(curves: Sequence[Curve], *, eps6_m: float) -> Mapping[tuple[int, int], Polynomial]:
    """Which curve goes on as which, and along which polynomial, as in the paper.

    Curve b may follow a if a ends before b begins and a polynomial through all of both has an error below
    epsilon 6. The Hungarian method makes as many of these links as go together, of the least total cost,
    error * exp(degree). (Who enters or leaves stays alone only if nobody is left for him.)
    """
    candidates: dict[tuple[int, int], Polynomial] = {}
    for i, before in enumerate(curves):
        for j, after in enumerate(curves):
            if before.last < after.first:
                found = smoothest_polynomial(before, after, eps6_m=eps6_m)
                if found is not None:
                    candidates[i, j] = found
    never = 1.0 + sum(found.cost for found in candidates.values())
    cost = np.full((len(curves), len(curves)), never)
    for pair, found in candidates.items():
        cost[pair] = found.cost
    assigned = zip(*linear_sum_assignment(cost), strict=True)
    return {pair: candidates[pair] for i, j in assigned if (pair := (int(i), int(j))) in candidates}


def joined_by_polynomials(
    curves: Sequence[Curve], pairs: Sequence[tuple[int, int]], *, eps6_m: float
) -> Mapping[tuple[int, int], Polynomial]:
    """The polynomial between each pair of curves that are known to go on as one another.

    It is the smoothest one; where none has an error below epsilon 6, that of the lowest degree.
    """
    found = {}
    for i, j in pairs:
        smoothest = smoothest_polynomial(curves[i], curves[j], eps6_m=eps6_m)
        found[i, j] = smoothest or fitted_polynomial(curves[i], curves[j], degree=LOWEST_DEGREE)
    return found


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


def merged_curve(curves: Sequence[Curve], polynomials: Sequence[Polynomial]) -> Curve:
    """The representative of a motion as in the paper: its segments' curves, and the polynomials between them."""
    position, points = [curves[0].position], [curves[0].points]
    for before, after, polynomial in zip(curves[:-1], curves[1:], polynomials, strict=True):
        hidden = np.arange(before.last + 1, after.first)
        position += [polynomial.at(hidden.astype(float)), after.position]
        points += [np.zeros(len(hidden)), after.points]
    return Curve(first=curves[0].first, position=np.concatenate(position), points=np.concatenate(points))
