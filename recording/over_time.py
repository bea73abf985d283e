"""What single pixels see over the whole of a recording, and how far a frame is off as a whole."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float, Float32

_ROWS_AT_ONCE = 32
"""Sorting copies: of so many rows at a time."""
WOBBLE_M = 0.15
"""Sensors shift a whole frame by some centimetres; returns within this of what stands still say by how much."""


def spread_numbers(count: int, most: int) -> list[int]:
    """So many frame numbers at most, the first and the last among them, evenly spread."""
    return np.unique(np.linspace(0, count - 1, most).round().astype(int)).tolist()


def quantile_over_time(
    values: Float32[np.ndarray, "frame row column"], share: float
) -> Float32[np.ndarray, "row column"]:
    """The largest of the lower share of each pixel's values, NaN left out; NaN where there is none."""
    found = np.empty(values.shape[1:], values.dtype)
    for first in range(0, len(found), _ROWS_AT_ONCE):
        rows = slice(first, first + _ROWS_AT_ONCE)
        ordered = np.sort(values[:, rows], axis=0)  # NaN goes last.
        place = (share * np.maximum(np.isfinite(ordered).sum(axis=0) - 1, 0)).astype(int)
        found[rows] = np.take_along_axis(ordered, place[None], axis=0)[0]
    return found


def stacked(
    images: Iterable[Float32[np.ndarray, "row column"]], *, count: int, shape: tuple[int, ...]
) -> Float32[np.ndarray, "frame row column"]:
    """Images that are made one by one, in one array, without a second copy of them."""
    every = np.empty((count, *shape), np.float32)
    for own, image in zip(every, images, strict=True):
        own[:] = image
    return every


def wobble_m(behind: Float[np.ndarray, "..."], *, least: int = 1) -> float:
    """By how much a whole frame is shifted, metres, as time-of-flight cameras do from frame to frame.

    `behind` says how far each return lies behind what stands still there. It is the median of those within 15 cm; 0
    where there are fewer than `least`.
    """
    near = behind[np.abs(behind) < WOBBLE_M]  # NaN: no.
    return float(np.median(near)) if near.size >= least else 0.0
