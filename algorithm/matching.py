"""Step 3: which point of the next frame is which (paper, section 4, Trajectory computation)."""

import numpy as np
from jaxtyping import Float, Float32, Int

from algorithm.lifting import SceneFlow, pixel_index
from recording.camera import Camera, pixel_grid

Pairs = tuple[Int[np.ndarray, "_match"], Int[np.ndarray, "_match"]]
"""Flat pixel numbers (row * width + column) in frame a and in frame b."""


def matched_pixels(
    flows: tuple[SceneFlow, SceneFlow],
    depths: tuple[Float32[np.ndarray, "row column"], Float32[np.ndarray, "row column"]],
    *,
    camera: Camera,
    tolerance_m: float,
    similar_depth_m: float,
) -> Pairs:
    """The pairs of pixels of two frames that show the same point, each pixel in one pair at the most.

    A point p follows the forward flow to q = p + f(p) and the backward flow home to q + b(q); it matches
    if it comes home within `tolerance_m` (epsilon 1) in 3D, and if a point of the expected depth lies at
    q. Where several points reach the same pixel, the one that comes home nearest is matched. (The paper
    prints "p + f = p + f' +- epsilon 1", which is no such test; see `docs/method.md`.)
    """
    (forward, backward), (depth_a, depth_b) = flows, depths
    target = pixel_grid(*depth_a.shape) + forward.column_row
    row, column, inside = pixel_index(target, depth_b.shape)
    arrived_depth = depth_a + forward.depth
    with np.errstate(invalid="ignore"):
        hit = inside & (np.abs(depth_b[row, column] - arrived_depth) <= similar_depth_m)
    source = np.flatnonzero(hit)
    goal = (row * depth_b.shape[1] + column).ravel()[source]
    home_picture = target.reshape(-1, 2)[source] + backward.column_row.reshape(-1, 2)[goal]
    home_depth = arrived_depth.ravel()[source] + backward.depth.ravel()[goal]
    home = camera.camera_from_pixel(home_picture, home_depth.astype(np.float64))
    begun = camera.camera_from_pixel(
        pixel_grid(*depth_a.shape).reshape(-1, 2)[source], depth_a.ravel()[source].astype(np.float64)
    )
    miss = np.linalg.norm(home - begun, axis=1)
    returned = miss <= tolerance_m  # NaN, a flow of unknown depth, does not return.
    return _one_to_one(source[returned], goal[returned], miss[returned])


def _one_to_one(
    source: Int[np.ndarray, "candidate"], goal: Int[np.ndarray, "candidate"], miss: Float[np.ndarray, "candidate"]
) -> Pairs:
    """For each goal the source of the smallest miss; of equal ones the first."""
    order = np.lexsort((source, miss, goal))
    goal = goal[order]
    best = np.ones(len(goal), bool)
    best[1:] = goal[1:] != goal[:-1]
    return source[order][best], goal[best]
