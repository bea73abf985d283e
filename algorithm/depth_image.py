"""Step 0: depth as an image that optical flow can follow (paper, section 4, Pairwise optical flow)."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float32, UInt8
from scipy.ndimage import distance_transform_edt

from recording.camera import Camera

NEAREST_GREY, FARTHEST_GREY = 1.0, 255.0
_BRIGHTEST, _DIMMEST = 255.0, 76.0
_DARKEST, _CONTRAST = 60.0, 190.0
_CONTINUED_PX = 60
_BEFORE_M = 0.1

DepthRange = tuple[float, float]


def depth_range(depths: Sequence[Float32[np.ndarray, "row column"]]) -> DepthRange:
    """The smallest and the largest depth of all frames, metres; (0, 1) where nothing returned.

    The range is that of the whole recording: with a range for each frame grey would change with who
    enters the picture.
    """
    nearest, farthest = np.inf, -np.inf
    for depth in depths:
        present = depth[np.isfinite(depth)]
        nearest, farthest = min(nearest, present.min(initial=np.inf)), max(farthest, present.max(initial=-np.inf))
    return (float(nearest), float(farthest)) if nearest <= farthest else (0.0, 1.0)


def grey_image(depth: Float32[np.ndarray, "row column"], *, within: DepthRange) -> UInt8[np.ndarray, "row column"]:
    """Depth mapped linearly to grey: the nearest is 1, the farthest 255, and 0 is empty."""
    nearest, farthest = within
    scale = (FARTHEST_GREY - NEAREST_GREY) / max(farthest - nearest, 1e-6)
    grey = NEAREST_GREY + (depth - nearest) * scale
    return np.where(np.isfinite(depth), np.round(grey), 0).astype(np.uint8)


def nearness_image(depth: Float32[np.ndarray, "row column"], *, within: DepthRange) -> UInt8[np.ndarray, "row column"]:
    """Depth mapped linearly to brightness: the nearest is 255, the farthest 76, and 0 is empty.

    So an outline against emptiness shows at any distance; as grey, what is near is as dark as emptiness.
    """
    nearest, farthest = within
    scale = (_BRIGHTEST - _DIMMEST) / max(farthest - nearest, 1e-6)
    bright = _BRIGHTEST - (depth - nearest) * scale
    return np.where(np.isfinite(depth), np.round(bright), 0).astype(np.uint8)


def shading_image(
    depth: Float32[np.ndarray, "row column"], *, camera: Camera, similar_depth_m: float
) -> UInt8[np.ndarray, "row column"]:
    """The surface as a lamp at the camera would show it: 60 + 190 cos(angle to the ray), 0 is empty.

    Depth hardly changes over a body, so grey shows little but its outline; its normals do change.
    """
    points = camera.world_points(smoothed_depth(depth, similar_depth_m=similar_depth_m)) - camera.position
    down = _surface_step(points, similar_depth_m, axis=0)
    across = _surface_step(points, similar_depth_m, axis=1)
    normal = np.cross(across, down)
    length = np.linalg.norm(normal, axis=-1) * np.linalg.norm(points, axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = np.abs(np.sum(normal * points, axis=-1)) / length
    shading = _DARKEST + _CONTRAST * np.nan_to_num(cosine, nan=0.0)
    return np.where(np.isfinite(depth), np.round(shading), 0).astype(np.uint8)


def continued_behind(
    image: UInt8[np.ndarray, "row column"],
    depth: Float32[np.ndarray, "row column"],
    sensed: Float32[np.ndarray, "row column"],
) -> UInt8[np.ndarray, "row column"]:
    """The image of the moving `depth`, continued a little behind what stands before it.

    Where a wall cuts a body off, the cut stands still although the body moves, and flow would follow the
    cut. So pixels of `sensed` that are no moving ones take the value of the nearest moving pixel within
    60 pixels, if that lies behind them.
    """
    moving = np.isfinite(depth)
    if not moving.any() or moving.all():
        return image
    distance, (row, column) = distance_transform_edt(~moving, return_indices=True)
    with np.errstate(invalid="ignore"):
        hides = ~moving & (distance <= _CONTINUED_PX) & (sensed < depth[row, column] - _BEFORE_M)
    return np.where(hides, image[row, column], image)


def smoothed_depth(
    depth: Float32[np.ndarray, "row column"], *, similar_depth_m: float, sigma_px: float = 1.0
) -> Float32[np.ndarray, "row column"]:
    """Depth smoothed by a Gaussian over the neighbours on the same surface (bilateral, NaN kept out)."""
    present = np.isfinite(depth)
    if not present.any():
        return depth
    reach = int(np.ceil(2 * sigma_px))
    filled = np.where(present, depth, np.float32(1e3))  # Far from every surface, hence no neighbour of any.
    padded = cv2.copyMakeBorder(filled, reach, reach, reach, reach, cv2.BORDER_CONSTANT, value=1e3)
    total = np.zeros(depth.shape)
    weight = np.zeros(depth.shape)
    height, width = depth.shape
    for row in range(-reach, reach + 1):
        for column in range(-reach, reach + 1):
            shifted = padded[reach + row : reach + row + height, reach + column : reach + column + width]
            near = np.abs(shifted - filled) < similar_depth_m
            share = np.exp(-(row**2 + column**2) / (2 * sigma_px**2)) * near
            total += share * shifted
            weight += share
    return np.where(present, total / weight, np.nan).astype(np.float32)


def _surface_step(points: np.ndarray, similar_depth_m: float, *, axis: int) -> np.ndarray:
    """Central difference of the points along a picture axis; one-sided at a depth jump, NaN when alone."""
    step = np.diff(points, axis=axis)
    jump = ~(np.abs(step[..., 2:]) < similar_depth_m)
    step = np.where(jump, np.nan, step)
    missing = np.full_like(np.take(points, [0], axis=axis), np.nan)
    ahead = np.concatenate([step, missing], axis=axis)
    behind = np.concatenate([missing, step], axis=axis)
    return np.where(np.isfinite(ahead), np.where(np.isfinite(behind), (ahead + behind) / 2, ahead), behind)
