"""Images read where a flow leads, with their slopes there."""

import cv2
import numpy as np
from jaxtyping import Float32

from algorithm.compiled import compiled

_FIVE_POINTS = np.array([[1, -8, 0, 8, -1]], np.float32) / 12
"""The derivative, exact for polynomials up to the fourth degree."""


def derivatives(image: Float32[np.ndarray, "row column"]) -> Float32[np.ndarray, "row column 2"]:
    """The image's slopes along columns and along rows, per pixel."""
    along, down = (
        cv2.filter2D(image, cv2.CV_32F, kernel, borderType=cv2.BORDER_REPLICATE)
        for kernel in (_FIVE_POINTS, np.ascontiguousarray(_FIVE_POINTS.T))
    )
    return np.stack([along, down], axis=-1)


def warped(
    image: Float32[np.ndarray, "row column"], flow: Float32[np.ndarray, "row column 2"]
) -> Float32[np.ndarray, "row column 3"]:
    """At every pixel the image's value where the flow leads, and its slopes there; NaN beyond the border.

    Bicubic: the cubic in each square has the values and the five-point derivatives of its corners [Press et
    al., Numerical Recipes, section 3.6], border pixels repeated; its own slopes are the slopes.
    """
    value_and_slopes = np.empty((*flow.shape[:2], 3), np.float32)
    _bicubic(image, flow, value_and_slopes)
    return value_and_slopes


@compiled
def _bicubic(image: np.ndarray, flow: np.ndarray, value_and_slopes: np.ndarray) -> None:
    height, width = image.shape
    across, across_slope, down, down_slope = np.empty((4, 6), np.float32)
    for i in range(height):
        for j in range(width):
            x, y = j + flow[i, j, 0], i + flow[i, j, 1]
            if not (0 <= x <= width - 1 and 0 <= y <= height - 1):
                value_and_slopes[i, j] = np.nan
                continue
            left, top = int(x), int(y)
            _set_taps(x - left, across, across_slope)
            _set_taps(y - top, down, down_slope)
            value, slope_x, slope_y = np.float32(0), np.float32(0), np.float32(0)
            for m in range(6):
                row = min(max(top + m - 2, 0), height - 1)
                row_value, row_slope = np.float32(0), np.float32(0)
                for n in range(6):
                    pixel = image[row, min(max(left + n - 2, 0), width - 1)]
                    row_value += across[n] * pixel
                    row_slope += across_slope[n] * pixel
                value += down[m] * row_value
                slope_x += down[m] * row_slope
                slope_y += down_slope[m] * row_value
            value_and_slopes[i, j, 0] = value
            value_and_slopes[i, j, 1] = slope_x
            value_and_slopes[i, j, 2] = slope_y


@compiled
def _set_taps(t: float, taps: np.ndarray, slope_taps: np.ndarray) -> None:
    """The weights of six pixels in a row for the value and for the slope at the share t between the middle two."""
    _set_hermite((1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2, t * t * (3 - 2 * t), t * t * (t - 1), taps)
    _set_hermite(6 * t * (t - 1), (1 - t) * (1 - 3 * t), 6 * t * (1 - t), t * (3 * t - 2), slope_taps)


@compiled
def _set_hermite(
    value_left: float, slope_left: float, value_right: float, slope_right: float, taps: np.ndarray
) -> None:
    """Weights of pixels, from those of the values and five-point derivatives of the middle two."""
    taps[0] = slope_left / 12
    taps[1] = (slope_right - 8 * slope_left) / 12
    taps[2] = value_left - 8 * slope_right / 12
    taps[3] = value_right + 8 * slope_left / 12
    taps[4] = (8 * slope_right - slope_left) / 12
    taps[5] = -slope_right / 12
