"""The planes that touch the surfaces behind the pixels, from the exact depth alone.

The inverse depth of a plane is linear in the picture, so differences between neighbours are exact on flat surfaces.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Float64

from recording.camera import PIXEL_CENTRE, Camera


@dataclass(frozen=True, kw_only=True, eq=False)
class Tangents:
    """The touching plane of each pixel; NaN where nothing is."""

    inverse: Float64[np.ndarray, "row column"]
    """Inverse depth, 1/m."""
    right: Float64[np.ndarray, "row column"]
    """How much it grows to the next column."""
    down: Float64[np.ndarray, "row column"]
    """How much it grows to the next row."""
    angle: Float64[np.ndarray, "row column"]
    """Between the pixel's ray and the surface's normal, radians, 0 to pi/2."""


def tangents(depth: Float32[np.ndarray, "row column"], camera: Camera) -> Tangents:
    """The planes through each pixel's point and its neighbours'.

    Of the neighbours on either side the one counts that makes the plane flatter: at an edge, the one on the same
    surface.
    A pixel without neighbours has a plane of constant depth.
    """
    inverse = 1.0 / depth.astype(np.float64)
    right, down = _flatter_slope(inverse, axis=1), _flatter_slope(inverse, axis=0)
    rows, columns = depth.shape
    x = (np.arange(columns) + PIXEL_CENTRE - camera.cx) / camera.fx
    y = ((np.arange(rows) + PIXEL_CENTRE - camera.cy) / camera.fy)[:, None]
    # The plane n.X = 1 has the inverse depth n.(x, y, 1) along the ray (x, y, 1): its slopes are n's first two parts.
    across, along = right * camera.fx, down * camera.fy
    length = np.sqrt(across**2 + along**2 + (inverse - across * x - along * y) ** 2)
    cosine = inverse / (length * np.sqrt(x**2 + y**2 + 1.0))
    return Tangents(inverse=inverse, right=right, down=down, angle=np.arccos(np.minimum(cosine, 1.0)))


def _flatter_slope(image: Float[np.ndarray, "row column"], *, axis: int) -> Float[np.ndarray, "row column"]:
    """The smaller in size of the steps from the pixel before and to the one after; 0 where there is neither."""
    step = np.diff(image, axis=axis)
    none = np.full_like(np.take(image, [0], axis=axis), np.nan)
    before, after = np.concatenate([none, step], axis=axis), np.concatenate([step, none], axis=axis)
    flatter = np.where(~(np.abs(before) > np.abs(after)) & ~np.isnan(before) | np.isnan(after), before, after)
    return np.where(np.isnan(flatter), 0.0, flatter)
