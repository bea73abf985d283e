"""Noise with a grain: what a sensor works out from neighbouring pixels is wrong in all of them alike."""

import cv2
import numpy as np
from jaxtyping import Float32, Float64


def grain(
    generator: np.random.Generator, shape: tuple[int, int], kernel: Float64[np.ndarray, "tap"]
) -> Float32[np.ndarray, "row column"]:
    """Gaussian noise of mean 0 and variance 1 in every pixel, white noise filtered by the kernel along both axes.

    So two pixels of a row correlate as much as the kernel with its shifted self. A kernel of one tap gives white noise.
    """
    margin = len(kernel) - 1
    white = generator.standard_normal((shape[0] + margin, shape[1] + margin), dtype=np.float32)
    if not margin:
        return white
    unit = kernel / np.sqrt((kernel**2).sum())  # The variance of a sum of white noise is the sum of the squares.
    filtered = cv2.sepFilter2D(white, -1, unit, unit)
    begin = margin // 2
    return np.ascontiguousarray(filtered[begin : begin + shape[0], begin : begin + shape[1]])


def bell(spread_px: float) -> Float64[np.ndarray, "tap"]:
    """A Gaussian kernel of that standard deviation in pixels; of one tap for 0."""
    reach = int(np.ceil(4 * spread_px))
    return np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(spread_px, 1e-9)) ** 2)


def box(size_px: int) -> Float64[np.ndarray, "tap"]:
    """A kernel that weighs so many pixels alike; an odd number keeps it in the middle."""
    return np.ones(size_px)
