"""Step 2: from optical flow to the motion of points (paper, section 4, Pairwise optical flow)."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32

from recording.camera import pixel_grid

_NEIGHBOURHOOD = 5
"""Side of the square, in pixels, over which the change of depth is smoothed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneFlow:
    """The motion of every point of a frame into another frame."""

    column_row: Float32[np.ndarray, "row column 2"]
    """Motion in the picture, pixels."""
    depth: Float32[np.ndarray, "row column"]
    """Change of depth, metres; NaN where it is not known."""


def lifted(
    flow_b_from_a: Float32[np.ndarray, "row column 2"],
    depth_a: Float32[np.ndarray, "row column"],
    depth_b: Float32[np.ndarray, "row column"],
    *,
    similar_depth_m: float,
    largest_step_m: float,
) -> SceneFlow:
    """The optical flow with the change of depth from each pixel to its target.

    The change is averaged over the neighbours of similar depth: at outlines the flow often misses its
    target, and then reads the depth of another surface. (The paper's kernel is misprinted: it is 1 where
    the depths differ. Its text says the opposite, and so do we.) Changes above `largest_step_m` are such
    misses and do not count.
    """
    target = pixel_grid(*depth_a.shape) + flow_b_from_a
    change = sampled_depth(depth_b, target) - depth_a
    change = np.where(np.abs(change) <= largest_step_m, change, np.nan)
    return SceneFlow(
        column_row=flow_b_from_a,
        depth=_mean_of_similar(change, depth_a, similar_depth_m).astype(np.float32),
    )


def pixel_index(
    column_row: Float[np.ndarray, "*shape 2"], shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Row and column of the pixel that holds each picture position, and whether there is one.

    Positions outside the picture, and NaN, get pixel (0, 0) and False.
    """
    with np.errstate(invalid="ignore"):
        column, row = np.floor(column_row[..., 0]), np.floor(column_row[..., 1])
        inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
    return np.where(inside, row, 0).astype(int), np.where(inside, column, 0).astype(int), inside


def sampled_depth(
    depth: Float32[np.ndarray, "row column"], column_row: Float[np.ndarray, "*shape 2"]
) -> Float32[np.ndarray, "*shape"]:
    """The depth of the pixel that holds each picture position; NaN outside and where nothing returned.

    Depth is not interpolated: between two surfaces there is none.
    """
    row, column, inside = pixel_index(column_row, depth.shape)
    return np.where(inside, depth[row, column], np.float32(np.nan))


def _mean_of_similar(
    values: Float[np.ndarray, "row column"], depth: Float32[np.ndarray, "row column"], similar_depth_m: float
) -> Float[np.ndarray, "row column"]:
    """The mean of the values of the neighbours whose depth is similar; NaN where none has a value."""
    known: Bool[np.ndarray, "row column"] = np.isfinite(values) & np.isfinite(depth)
    reach = _NEIGHBOURHOOD // 2
    edges = (reach, reach, reach, reach, cv2.BORDER_CONSTANT)
    far = np.where(known, depth, np.inf).astype(np.float64)
    padded_depth = cv2.copyMakeBorder(far, *edges, value=np.inf)
    padded_value = cv2.copyMakeBorder(np.where(known, values, 0.0), *edges, value=0.0)
    total = np.zeros(depth.shape)
    count = np.zeros(depth.shape)
    height, width = depth.shape
    own = np.where(np.isfinite(depth), depth, 0.0)
    for row in range(_NEIGHBOURHOOD):
        for column in range(_NEIGHBOURHOOD):
            window = (slice(row, row + height), slice(column, column + width))
            similar = np.abs(padded_depth[window] - own) <= similar_depth_m
            total += similar * padded_value[window]
            count += similar
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(depth) & (count > 0), total / np.maximum(count, 1), np.nan)
