"""What lies between the camera and a point, by the truth meshes alone.

A small ray caster that shares nothing with the one that drew the pictures, so that each can be held against the other.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float64, Int64, Integer, UInt32

from recording.camera import Camera, pixel_grid, transformed
from recording.truth import MeshSequence

COVER_M = 1e-4
"""What lies less than this before a point is the point's own surface: a tenth of a millimetre."""
EDGE_PX = 1e-3
"""Distance in the picture from a face's edge below which it is the rounding of single precision, in which
pictures are drawn, that decides whether a ray meets the face."""
HAIR_PX = 1e-9
"""The same for double precision; so that nothing falls through between two faces."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DepthRange:
    """Between which depths the first face on each pixel's ray lies; the same but where a ray meets an edge."""

    least: Float64[np.ndarray, "row column"]
    """Depth of the first face when its edges belong to it, metres; infinite where there is none."""
    most: Float64[np.ndarray, "row column"]
    """Depth of the first face that the ray meets away from its edges, metres; infinite where there is none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Crossings:
    """Where rays meet faces: an entry a pair of ray and face."""

    ray: Int64[np.ndarray, "crossing"]
    depth: Float64[np.ndarray, "crossing"]
    inside: Bool[np.ndarray, "crossing"]
    """Whether the face is met away from its edges."""


def first_depths(mesh: MeshSequence, camera: Camera, *, frame: int) -> DepthRange:
    """The depth at which the ray through each pixel's centre first meets the mesh in the frame."""
    shape = (camera.height, camera.width)
    rays = camera.camera_from_pixel(pixel_grid(*shape), np.ones(shape)).reshape(-1, 3)
    met = _crossings(_triangles(mesh, camera, frame), rays, camera, edge_px=EDGE_PX)
    return DepthRange(
        least=_first(met.ray, met.depth, len(rays)).reshape(shape),
        most=_first(met.ray[met.inside], met.depth[met.inside], len(rays)).reshape(shape),
    )


def covering(
    truth: Mapping[int, MeshSequence], camera: Camera, points: Float[np.ndarray, "point 3"], *, frame: int
) -> UInt32[np.ndarray, "point"]:
    """The id of the object that the view of each point first meets in the frame, where it ends before the point.

    0 where nothing covers the point, and for a point outside the picture, behind the camera or NaN. The
    points are in world axes, metres. A point of an object's far side is covered by the object itself.
    """
    column_row, _ = camera.pixel_from_world(points)
    asked = np.flatnonzero(camera.contains(column_row))
    targets = transformed(np.linalg.inv(camera.world_from_camera), points[asked])
    nearest = targets[:, 2] - COVER_M
    found = np.zeros(len(asked), np.uint32)
    for objectid, mesh in truth.items():
        met = _crossings(_triangles(mesh, camera, frame), targets, camera, edge_px=HAIR_PX)
        depth = _first(met.ray, met.depth, len(targets))
        found[depth < nearest] = objectid
        nearest = np.minimum(nearest, depth)
    covered_by = np.zeros(len(points), np.uint32)
    covered_by[asked] = found
    return covered_by


def _triangles(mesh: MeshSequence, camera: Camera, frame: int) -> Float64[np.ndarray, "face 3 3"]:
    """The corners of the faces, camera axes, without the faces that lie behind the camera."""
    vertices = mesh.vertices_at(frame).astype(np.float64)
    corners = transformed(np.linalg.inv(camera.world_from_camera), vertices)[mesh.faces]
    return corners[np.any(corners[..., 2] > 0, axis=1)]


def _crossings(
    triangles: Float64[np.ndarray, "face 3 3"], targets: Float64[np.ndarray, "ray 3"], camera: Camera, *, edge_px: float
) -> _Crossings:
    """Where the rays from the camera through the targets, which lie in the picture, meet the faces; camera axes.

    A ray p passes a face A, B, C on the same side of its three edges where p.(B x C), p.(C x A) and p.(A x B) have the
    sign of p.N, with the normal N, and meets it at depth p_z (A.N) / (p.N). Corners behind the camera do no harm
    (Olano and Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates, 1997). Over their gradient in the
    picture the three products are the distances from the edges, pixels. Faces reach `edge_px` beyond their edges.
    """
    face, ray = _pairs(triangles, targets, camera)
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    sides = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    gradient = np.hypot(sides[..., 0] / camera.fx, sides[..., 1] / camera.fy)
    gradient[gradient == 0] = 1.0  # An edge in the camera's own plane is infinitely far from every pixel.
    slope = np.einsum("px,px->p", targets[ray], normal[face])
    seen = slope != 0  # A face that is seen edge-on, or that has no area, has no picture.
    face, ray, slope = face[seen], ray[seen], slope[seen]
    target = targets[ray]
    products = np.einsum("pcx,px->pc", sides[face], target) * np.sign(slope)[:, None]
    margin_px = (products / (gradient[face] * target[:, 2:])).min(axis=1)
    depth = target[:, 2] * np.einsum("fx,fx->f", a, normal)[face] / slope
    kept = (margin_px >= -edge_px) & (depth > 0)
    return _Crossings(ray=ray[kept], depth=depth[kept], inside=margin_px[kept] > edge_px)


def _pairs(
    triangles: Float64[np.ndarray, "face 3 3"], targets: Float64[np.ndarray, "ray 3"], camera: Camera
) -> tuple[Int64[np.ndarray, "pair"], Int64[np.ndarray, "pair"]]:
    """Face and ray of each pair in which the ray runs through the rectangle round the face in the picture."""
    low, high = _rectangles(triangles, camera)
    place = _projected(targets, camera)
    column, row = np.floor(place).astype(np.int64).T
    order = np.argsort(row * camera.width + column, kind="stable")
    pixel = (row * camera.width + column)[order]
    size = np.array([camera.width, camera.height])
    first = np.clip(np.floor(low), 0, size).astype(np.int64)
    last = np.clip(np.floor(high), -1, size - 1).astype(np.int64)
    wide = last[:, 0] >= first[:, 0]
    face, line = _spread(first[:, 1], np.where(wide, last[:, 1] - first[:, 1] + 1, 0))
    begin = np.searchsorted(pixel, line * camera.width + first[face, 0])
    end = np.searchsorted(pixel, line * camera.width + last[face, 0], side="right")
    entry, index = _spread(begin, end - begin)
    face, ray = face[entry], order[index]
    kept = np.all((place[ray] >= low[face]) & (place[ray] <= high[face]), axis=1)
    return face[kept], ray[kept]


def _rectangles(
    triangles: Float64[np.ndarray, "face 3 3"], camera: Camera
) -> tuple[Float64[np.ndarray, "face 2"], Float64[np.ndarray, "face 2"]]:
    """The smallest and largest column and row of each face; everything for one that reaches behind the camera."""
    before = np.all(triangles[..., 2] > 0, axis=1)
    low = np.full((len(triangles), 2), -np.inf)
    corners = _projected(triangles[before], camera)
    low[before] = corners.min(axis=1) - EDGE_PX
    high = np.full((len(triangles), 2), np.inf)
    high[before] = corners.max(axis=1) + EDGE_PX
    return low, high


def _projected(points: Float64[np.ndarray, "*shape 3"], camera: Camera) -> Float64[np.ndarray, "*shape 2"]:
    """Column and row of points before the camera, camera axes."""
    focal, principal = np.array([camera.fx, camera.fy]), np.array([camera.cx, camera.cy])
    return points[..., :2] / points[..., 2:] * focal + principal


def _spread(
    begin: Integer[np.ndarray, "range"], count: Integer[np.ndarray, "range"]
) -> tuple[Int64[np.ndarray, "entry"], Int64[np.ndarray, "entry"]]:
    """The ranges begin, begin + 1, ... of the counts, one behind the other: number of the range, and value."""
    count = np.maximum(count, 0)
    number = np.repeat(np.arange(len(count)), count)
    start = np.cumsum(count) - count
    return number, np.arange(len(number)) - start[number] + begin[number]


def _first(
    ray: Int64[np.ndarray, "crossing"], depth: Float64[np.ndarray, "crossing"], rays: int
) -> Float64[np.ndarray, "ray"]:
    """The smallest depth on each ray; infinite where there is none."""
    first = np.full(rays, np.inf)
    np.minimum.at(first, ray, depth)
    return first
