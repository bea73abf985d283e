"""What part of the picture each observed point stands for.

Trajectories are dense where flow is good and few on swinging limbs, so their mean is no centre of a body. Every
moving pixel is therefore given to the nearest observed point of its frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32
from scipy.spatial import cKDTree

from algorithm.trajectories import Trajectories
from recording.camera import Camera, pixel_grid


@dataclass(frozen=True, kw_only=True, eq=False)
class Patches:
    """The pixels that each row of some trajectories stands for."""

    pixels: Float[np.ndarray, "observation"]
    """Their number."""
    centre: Float[np.ndarray, "observation 3"]
    """Their mean place, metres; the point itself where there is none."""


def patches(
    trajectories: Trajectories,
    moving: Sequence[Float32[np.ndarray, "row column"]],
    *,
    camera: Camera,
    reach_m: float,
) -> Patches:
    """The patch of every observed point: the moving pixels that are nearer to it than to another one.

    `moving` are the frames' depths, NaN where nothing moves. Pixels without a point within `reach_m` count nowhere.
    """
    pixels = np.zeros(len(trajectories.frame), np.float32)
    centre = trajectories.position.astype(np.float32)
    order = np.argsort(trajectories.frame, kind="stable")
    bounds = np.searchsorted(trajectories.frame[order], np.arange(len(moving) + 1))
    grid = pixel_grid(camera.height, camera.width)
    for depth, begin, end in zip(moving, bounds[:-1], bounds[1:], strict=True):
        seen = np.isfinite(depth)
        if begin == end or not seen.any():
            continue
        rows = order[begin:end]
        place = camera.world_from_pixel(grid[seen], depth[seen].astype(np.float64))
        distance, nearest = cKDTree(trajectories.position[rows]).query(place, distance_upper_bound=reach_m)
        near = np.isfinite(distance)
        part = nearest[near]
        count = np.bincount(part, minlength=len(rows))
        total = np.stack([np.bincount(part, place[near, axis], len(rows)) for axis in range(3)], axis=1)
        shown = count > 0
        pixels[rows] = count
        centre[rows[shown]] = total[shown] / count[shown, None]
    return Patches(pixels=pixels, centre=centre)
