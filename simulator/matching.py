"""Windows of a picture that are matched as a whole, as sensors do that compare two pictures."""

import cv2
import numpy as np
from jaxtyping import Bool, Float, Int64

FAR_OFF = -1e6
"""The disparity of pixels that match nothing, pixels."""


def window_size(size_px: float, *, scale: float) -> int:
    """The odd number of the picture's pixels nearest to a window's size in the sensor's; at least 1."""
    return 2 * max(round((size_px * scale - 1) / 2), 0) + 1


def uneven(
    disparity: Float[np.ndarray, "row column"], size: int, *, tolerance_px: float
) -> Bool[np.ndarray, "row column"]:
    """Where the disparities within the window round a pixel differ by more than the tolerance."""
    image, kernel = disparity.astype(np.float32), np.ones((size, size), np.uint8)
    return cv2.dilate(image, kernel) - cv2.erode(image, kernel) > tolerance_px


def windows(
    image: Float[np.ndarray, "row column"], size: int, pixels: Int64[np.ndarray, "pixel 2"]
) -> Float[np.ndarray, "place pixel"]:
    """What stands in the windows round some pixels (row, column); beyond the border stands what is on it."""
    reach = size // 2
    padded = np.pad(image, reach, mode="edge")
    row, column = pixels.T
    return np.stack([padded[row + down, column + right] for down in range(size) for right in range(size)])


def own_share(
    disparity: Float[np.ndarray, "row column"], size: int, *, tolerance_px: float
) -> Float[np.ndarray, "row column"]:
    """The share of the window round each pixel whose disparity is its own, give or take the tolerance."""
    share = np.ones(disparity.shape)
    pixels = np.argwhere(uneven(disparity, size, tolerance_px=tolerance_px))
    if len(pixels):
        own = disparity[tuple(pixels.T)]
        share[tuple(pixels.T)] = np.mean(np.abs(windows(disparity, size, pixels) - own) <= tolerance_px, axis=0)
    return share
