"""Images from coarse to fine, and what carries a flow from one size to the next."""

import math

import cv2
import numpy as np
from jaxtyping import Bool, Float32
from scipy.ndimage import distance_transform_edt

Shape = tuple[int, int]


def level_shapes(shape: Shape, *, levels: int, spacing: float) -> list[Shape]:
    """The heights and widths of a pyramid, finest first, each `spacing` times smaller than the one before."""
    return [(max(1, round(shape[0] / spacing**k)), max(1, round(shape[1] / spacing**k))) for k in range(levels)]


def pyramid(image: Float32[np.ndarray, "..."], shapes: list[Shape], *, spacing: float) -> list[np.ndarray]:
    """The image at every size, finest first, each blurred a little (sigma sqrt(spacing / 2)) before it shrinks.

    Of shape (row, column) or (row, column, channel).
    """
    levels = [image]
    for height, width in shapes[1:]:
        blurred = cv2.GaussianBlur(levels[-1], (0, 0), math.sqrt(spacing / 2), borderType=cv2.BORDER_REPLICATE)
        smaller = cv2.resize(blurred, (width, height), interpolation=cv2.INTER_LINEAR)
        levels.append(smaller.reshape(height, width, *image.shape[2:]))
    return levels


def resized_flow(flow: Float32[np.ndarray, "row column 2"], shape: Shape) -> Float32[np.ndarray, "_row _column 2"]:
    """The flow between images of another size, in pixels of that size."""
    scale = np.array([shape[1] / flow.shape[1], shape[0] / flow.shape[0]], np.float32)
    return cv2.resize(flow, shape[::-1], interpolation=cv2.INTER_LINEAR) * scale


def continued(
    image: Float32[np.ndarray, "row column"], valid: Bool[np.ndarray, "row column"]
) -> Float32[np.ndarray, "row column"]:
    """The image with every pixel that is not valid replaced by the nearest valid one; zero if there is none."""
    if not valid.any():
        return np.zeros_like(image)
    row, column = distance_transform_edt(~valid, return_distances=False, return_indices=True)
    return image[row, column]
