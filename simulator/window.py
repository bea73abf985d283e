"""Rectangles of the picture: where a mesh can be seen, so that rays are cast nowhere else."""

import numpy as np
from jaxtyping import Float

from recording.camera import Camera

Window = tuple[slice, slice]
"""The rows and the columns of a rectangle of the picture: `image[window]` is an image's part in it."""

NOWHERE: Window = (slice(0, 0), slice(0, 0))
"""The window without a pixel."""


def window_around(camera: Camera, vertices: Float[np.ndarray, "vertex 3"]) -> Window:
    """The smallest window that holds the picture of a mesh with these vertices, world axes, metres.

    It is rounded outwards to whole pixels and cut off at the picture's border; empty where the mesh is beside
    the picture or behind the camera, the whole picture where it reaches through the camera's plane.
    """
    column_row, depth = camera.pixel_from_world(vertices.astype(np.float64))
    if not len(depth) or depth.max() <= 0:
        return NOWHERE
    if depth.min() <= 0:
        return slice(0, camera.height), slice(0, camera.width)
    size = [camera.width, camera.height]
    left, top = np.clip(np.floor(column_row.min(axis=0)), 0, size).astype(int).tolist()
    right, bottom = np.clip(np.ceil(column_row.max(axis=0)), 0, size).astype(int).tolist()
    return slice(top, bottom), slice(left, right)
