"""Rectangles of the picture: where a mesh can be seen, and which of its faces, so that no work is done elsewhere."""

import numpy as np
from jaxtyping import Bool, Float, Float64, Integer

from recording.camera import PIXEL_CENTRE, Camera, transformed

Window = tuple[slice, slice]
"""The rows and the columns of a rectangle of the picture: `image[window]` is an image's part in it."""

NOWHERE: Window = (slice(0, 0), slice(0, 0))
"""The window without a pixel."""

_MARGIN_PX = 0.01
"""A ray in float32 is this near to its pixel's centre, many times over."""


def camera_points(camera: Camera, vertices: Float[np.ndarray, "vertex 3"]) -> Float64[np.ndarray, "3 vertex"]:
    """The vertices, world axes, in the camera's axes: x, y and z apart, metres."""
    camera_from_world = np.linalg.inv(camera.world_from_camera)
    return np.ascontiguousarray(transformed(camera_from_world, vertices.astype(np.float64)).T)


def window_around(camera: Camera, points: Float64[np.ndarray, "3 vertex"]) -> Window:
    """The smallest window that holds the picture of a mesh with these vertices, camera axes, metres.

    It is rounded outwards to whole pixels and cut off at the picture's border; empty where the mesh is beside
    the picture or behind the camera, the whole picture where it reaches through the camera's plane.
    """
    depth = points[2]
    if not len(depth) or depth.max() <= 0:
        return NOWHERE
    if depth.min() <= 0:
        return slice(0, camera.height), slice(0, camera.width)
    column, row = _picture_places(camera, points)
    top, bottom = _outwards(row, camera.height)
    left, right = _outwards(column, camera.width)
    return (slice(top, bottom), slice(left, right)) if top < bottom and left < right else NOWHERE


def shared_window(one: Window, other: Window) -> Window:
    """The window of the pixels that both have."""
    rows, columns = (slice(max(a.start, b.start), min(a.stop, b.stop)) for a, b in zip(one, other, strict=True))
    return (rows, columns) if rows.start < rows.stop and columns.start < columns.stop else NOWHERE


def reachable_faces(
    camera: Camera, points: Float64[np.ndarray, "3 vertex"], faces: Integer[np.ndarray, "face 3"]
) -> Integer[np.ndarray, "reachable"]:
    """The numbers of the faces that the ray through some pixel's centre may meet, in ascending order.

    A face that is smaller than a pixel lies around one pixel's centre or, as most faces of a body far off,
    around none: then it is left out. What reaches through the camera's plane may be met.
    """
    corners = np.ascontiguousarray(faces.T)
    column, row = _picture_places(camera, points)
    first_column, last_column = _centres_between(column, corners, camera.width)
    first_row, last_row = _centres_between(row, corners, camera.height)
    reachable = (first_column <= last_column) & (first_row <= last_row)
    single = np.flatnonzero(reachable & (first_column == last_column) & (first_row == last_row))
    centre = np.stack([first_column[single], first_row[single]]) + PIXEL_CENTRE
    reachable[single] = _around(centre, np.stack([column, row])[:, corners[:, single]])
    ahead = points[2] > 0
    if not ahead.all():
        reachable |= ahead[corners].any(axis=0) & ~ahead[corners].all(axis=0)
    return np.flatnonzero(reachable)


def _picture_places(
    camera: Camera, points: Float64[np.ndarray, "3 vertex"]
) -> tuple[Float64[np.ndarray, "vertex"], Float64[np.ndarray, "vertex"]]:
    """Column and row of the points; NaN for those not before the camera."""
    depth = np.where(points[2] > 0, points[2], np.nan)
    return camera.fx * points[0] / depth + camera.cx, camera.fy * points[1] / depth + camera.cy


def _outwards(place: Float64[np.ndarray, "vertex"], size: int) -> tuple[int, int]:
    """The first row or column that the places touch, and the one after the last, within the picture."""
    return max(int(np.floor(place.min())), 0), min(int(np.ceil(place.max())), size)


def _centres_between(
    place: Float64[np.ndarray, "vertex"], corners: Integer[np.ndarray, "3 face"], size: int
) -> tuple[Float64[np.ndarray, "face"], Float64[np.ndarray, "face"]]:
    """The first and the last row, or column, of the picture whose centre lies between the corners of each face."""
    a, b, c = place[corners]
    first = np.ceil(np.minimum(np.minimum(a, b), c) - (PIXEL_CENTRE + _MARGIN_PX))
    last = np.floor(np.maximum(np.maximum(a, b), c) - (PIXEL_CENTRE - _MARGIN_PX))
    return np.maximum(first, 0), np.minimum(last, size - 1)


def _around(
    centre: Float64[np.ndarray, "2 face"], corners: Float64[np.ndarray, "2 3 face"]
) -> Bool[np.ndarray, "face"]:
    """Which faces have the place inside: on the same side of all three edges, or nearly on one."""
    x, y = corners - centre[:, None]
    edge_x, edge_y = np.roll(x, -1, axis=0) - x, np.roll(y, -1, axis=0) - y
    beside = x * edge_y - y * edge_x
    slack = _MARGIN_PX * (np.abs(edge_x) + np.abs(edge_y))
    return (beside >= -slack).all(axis=0) | (beside <= slack).all(axis=0)
