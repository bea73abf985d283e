"""When a motion is hidden, wholly or for the most part."""

import numpy as np
from jaxtyping import Bool
from scipy.ndimage import maximum_filter1d, percentile_filter

from algorithm.representative import Curve

_USUAL_SECONDS = 1.5
"""What a motion usually shows is judged by so much time before and after."""
_USUAL = 85
"""Percentile of the numbers of points that counts as all that a motion shows."""

Stretch = tuple[int, int]
"""First and last frame."""


def faint_stretches(curve: Curve, *, share: float, fps: float) -> list[Stretch]:
    """The stretches of a motion in which fewer points than `share` of the usual number are seen, in order of time.

    Frames that no one saw are part of one; with `share` 0 there are no others.
    """
    reach = 2 * round(_USUAL_SECONDS * fps) + 1
    usual = percentile_filter(maximum_filter1d(curve.points, 3, mode="nearest"), _USUAL, size=reach, mode="nearest")
    return _stretches(curve.first, ~curve.observed | (curve.points < share * usual))


def _stretches(first: int, hidden: Bool[np.ndarray, "moment"]) -> list[Stretch]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], hidden, [False]])))
    return [(first + int(begin), first + int(end) - 1) for begin, end in edges.reshape(-1, 2)]
