"""A path where little or nothing was seen, drawn anew from where much was."""

import numpy as np
from jaxtyping import Bool, Float
from numpy.polynomial import chebyshev

from algorithm.faint import faint_stretches
from algorithm.representative import Curve

_FAINT, _CLEAR = 0.2, 0.4
"""Shares of the usual number of points: below the one a path is drawn anew, by moments above the other."""
_ENDS_SECONDS = 0.5
"""How much of the path on either side tells how it goes on."""
_DEGREE = 2
_FEWEST = 4
"""Clear moments that either side needs."""


def steadied(curve: Curve, *, fps: float) -> Curve:
    """The curve with a parabola through every stretch in which little was seen of the motion.

    The parabola fits the clear moments of half a second on either side; what it misses at the two nearest ones is
    added in proportion, so that the path has no jump. A stretch without enough of them on both sides stays as it is.
    """
    clear = np.ones(len(curve.position), bool)
    for first, last in faint_stretches(curve, share=_CLEAR, fps=fps):
        clear[first - curve.first : last - curve.first + 1] = False
    position = curve.position.copy()
    for first, last in faint_stretches(curve, share=_FAINT, fps=fps):
        _draw_anew(position, clear, (first - curve.first, last - curve.first), round(_ENDS_SECONDS * fps))
    return Curve(first=curve.first, position=position, points=curve.points)


def _draw_anew(
    position: Float[np.ndarray, "moment 3"], clear: Bool[np.ndarray, "moment"], stretch: tuple[int, int], most: int
) -> None:
    """Replace the places between the clear moments around the stretch, in place."""
    first, last = stretch
    before = np.flatnonzero(clear[:first])[-most:]
    after = last + 1 + np.flatnonzero(clear[last + 1 :])[:most]
    if min(len(before), len(after)) < _FEWEST:
        return
    known = np.concatenate([before, after])
    hidden = np.arange(before[-1], after[0] + 1)
    middle, half = 0.5 * (known[0] + known[-1]), 0.5 * (known[-1] - known[0])
    basis = chebyshev.chebvander((known - middle) / half, _DEGREE)
    coefficients = np.linalg.lstsq(basis, position[known], rcond=None)[0]
    drawn = chebyshev.chebvander((hidden - middle) / half, _DEGREE) @ coefficients
    share = ((hidden - hidden[0]) / (hidden[-1] - hidden[0]))[:, None]
    drawn += (1 - share) * (position[hidden[0]] - drawn[0]) + share * (position[hidden[-1]] - drawn[-1])
    position[hidden] = drawn
