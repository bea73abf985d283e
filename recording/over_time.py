"""What single pixels see over the whole of a recording, and how far a frame is off as a whole."""

import numpy as np
from jaxtyping import Float, Float32

WOBBLE_M = 0.15
"""Sensors shift a whole frame by some centimetres; returns within this of what stands still say by how much."""


def spread_numbers(count: int, most: int) -> list[int]:
    """So many frame numbers at most, the first and the last among them, evenly spread."""
    return np.unique(np.linspace(0, count - 1, most).round().astype(int)).tolist()


def quantile_over_time(
    values: Float32[np.ndarray, "frame row column"], share: float
) -> Float32[np.ndarray, "row column"]:
    """The largest of the lower share of each pixel's values, NaN left out; NaN where there is none."""
    ordered = np.sort(values, axis=0)  # NaN goes last.
    place = (share * np.maximum(np.isfinite(ordered).sum(axis=0) - 1, 0)).astype(int)
    return np.take_along_axis(ordered, place[None], axis=0)[0]


def wobble_m(behind: Float[np.ndarray, "..."], *, least: int = 1) -> float:
    """By how much a whole frame is shifted, metres, as time-of-flight cameras do from frame to frame.

    `behind` says how far each return lies behind what stands still there. It is the median of those within 15 cm; 0
    where there are fewer than `least`.
    """
    near = behind[np.abs(behind) < WOBBLE_M]  # NaN: no.
    return float(np.median(near)) if near.size >= least else 0.0
