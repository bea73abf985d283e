"""Values between the pixels of one surface: bilinear, but only over pixels whose depth belongs to it."""

import math

import numpy as np

from algorithm.compiled import compiled

_LEAST_WEIGHT = 0.2
"""Of the four pixels around a place; with less on the surface the place lies beside it."""


@compiled
def surface_weights(
    depth: np.ndarray, place: tuple[float, float], expected: float, reach_m: float
) -> tuple[int, int, tuple[float, float, float, float], float]:
    """The pixel up left of a place and how much each of the four around it weighs; with their sum.

    `depth` is an image in metres, NaN where nothing is. `place` is (row, column), counted between pixel
    centres: pixel (0, 0) is at (0, 0). A pixel weighs as in bilinear interpolation if its depth is within
    `reach_m` of the expected one, else nothing; the order is up left, up right, down left, down right.
    """
    row, column = math.floor(place[0]), math.floor(place[1])
    down, right = place[0] - row, place[1] - column
    weights = (
        _weight(depth, row, column, expected, reach_m) * (1 - down) * (1 - right),
        _weight(depth, row, column + 1, expected, reach_m) * (1 - down) * right,
        _weight(depth, row + 1, column, expected, reach_m) * down * (1 - right),
        _weight(depth, row + 1, column + 1, expected, reach_m) * down * right,
    )
    return row, column, weights, weights[0] + weights[1] + weights[2] + weights[3]


@compiled
def on_surface(
    image: np.ndarray, depth: np.ndarray, place: tuple[float, float], expected: float, reach_m: float
) -> float:
    """The image's value at a place of the surface of the expected depth; NaN where less than a fifth is there."""
    row, column, weights, total = surface_weights(depth, place, expected, reach_m)
    if not total >= _LEAST_WEIGHT:
        return math.nan
    value = 0.0
    if weights[0] > 0.0:
        value += weights[0] * image[row, column]
    if weights[1] > 0.0:
        value += weights[1] * image[row, column + 1]
    if weights[2] > 0.0:
        value += weights[2] * image[row + 1, column]
    if weights[3] > 0.0:
        value += weights[3] * image[row + 1, column + 1]
    return value / total


@compiled
def _weight(depth: np.ndarray, row: int, column: int, expected: float, reach_m: float) -> float:
    if row < 0 or column < 0 or row >= depth.shape[0] or column >= depth.shape[1]:
        return 0.0
    return 1.0 if abs(depth[row, column] - expected) <= reach_m else 0.0
