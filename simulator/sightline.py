"""What lies before some points of a picture, by the meshes: few rays, and from anywhere.

Nearly every face is out of the question: no ray runs through the rectangle round it, or it lies behind all that is
there. What is left is tested as it is, in float64. A tree of the faces would take several times as long to build.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64, Integer

from recording.camera import Camera

_MARGIN_PX = 0.01
"""By so much the rectangle round a face is wider than it must be."""
_HAIR = 1e-9
"""So far beyond its edges a face is met, as a share of it (at 1 m): nothing falls through between two."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Targets:
    """Where rays through a picture end."""

    places: Float64[np.ndarray, "2 ray"]
    """Column and row, in the picture or beside it."""
    inverse_depth: Float64[np.ndarray, "ray"]
    """1/m; 0 = infinitely far."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Planes:
    """The faces as linear functions of the place in the picture: (column, row, 1) times these."""

    weights: Float64[np.ndarray, "3 3 face"]
    """A corner's weight in the point that is met, over its depth: factor, corner, face. None is negative inside."""
    inverse: Float64[np.ndarray, "3 face"]
    """Inverse depth of the plane."""
    low: Float64[np.ndarray, "2 face"]
    """The least column and row of the face; -infinite where it reaches behind the camera."""
    high: Float64[np.ndarray, "2 face"]
    """The greatest ones."""


def first_inverse_depths(
    camera: Camera,
    points: Float64[np.ndarray, "3 vertex"],
    faces: Integer[np.ndarray, "face 3"],
    targets: Targets,
) -> Float64[np.ndarray, "ray"]:
    """The inverse depth of what lies first before each target; 0 where nothing does.

    `points` are the faces' corners in the camera's axes, metres.
    """
    first = np.zeros(targets.places.shape[1])
    if not len(first):
        return first
    planes = _planes(camera, points, faces[(points[2] > 0)[faces].any(axis=1)])
    wide = _widely_spread(planes, targets)
    for large in np.flatnonzero(wide):
        inverse = _at(planes.inverse[:, large], targets.places)
        before = np.flatnonzero(inverse > np.maximum(targets.inverse_depth, first))
        met = before[_inside(planes.weights[..., large, None], targets.places[:, before])]
        first[met] = inverse[met]
    face, ray = _pairs(planes, ~wide, targets)
    inverse = _at(planes.inverse[:, face], targets.places[:, ray])
    before = np.flatnonzero(inverse > np.maximum(targets.inverse_depth, first)[ray])
    face, ray, inverse = face[before], ray[before], inverse[before]
    met = _inside(planes.weights[..., face], targets.places[:, ray])
    np.maximum.at(first, ray[met], inverse[met])
    return first


def _widely_spread(planes: _Planes, targets: Targets) -> Bool[np.ndarray, "face"]:
    """Which faces have a rectangle so large that pairs save no work: an eighth of all targets' rectangle."""
    least, most = targets.places.min(axis=1, keepdims=True), targets.places.max(axis=1, keepdims=True)
    sides = np.clip(planes.high, least, most) - np.clip(planes.low, least, most)
    return sides[0] * sides[1] * 8 > np.prod(most - least)


def _inside(weights: Float64[np.ndarray, "3 3 pair"], places: Float64[np.ndarray, "2 ray"]) -> Bool[np.ndarray, "ray"]:
    """Whether rays meet the faces between their edges."""
    a, b, c = _at(weights, places)
    return np.minimum(np.minimum(a, b), c) >= -_HAIR


def _planes(camera: Camera, points: Float64[np.ndarray, "3 vertex"], faces: Integer[np.ndarray, "face 3"]) -> _Planes:
    """The faces' planes; NaN for one that is seen edge-on.

    The ray p meets the corners A, B, C with weights p.(B x C), p.(C x A) and p.(A x B) over A.(B x C), each divided by
    the depth; their sum is the inverse depth (Olano and Greer, Triangle Scan Conversion using 2D Homogeneous
    Coordinates, 1997). So corners behind the camera do no harm.
    """
    a, b, c = (points[:, corner] for corner in faces.T)
    sides = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=1)
    volume = a[0] * sides[0, 0] + a[1] * sides[1, 0] + a[2] * sides[2, 0]
    sides /= np.where(volume == 0, np.nan, volume)
    across, down = sides[0] / camera.fx, sides[1] / camera.fy
    weights = np.stack([across, down, sides[2] - camera.cx * across - camera.cy * down])
    low, high = _rectangles(camera, points, faces)
    return _Planes(weights=weights, inverse=weights[:, 0] + weights[:, 1] + weights[:, 2], low=low, high=high)


def _cross(one: Float64[np.ndarray, "3 face"], other: Float64[np.ndarray, "3 face"]) -> Float64[np.ndarray, "3 face"]:
    return np.stack([one[i] * other[j] - one[j] * other[i] for i, j in ((1, 2), (2, 0), (0, 1))])


def _rectangles(
    camera: Camera, points: Float64[np.ndarray, "3 vertex"], faces: Integer[np.ndarray, "face 3"]
) -> tuple[Float64[np.ndarray, "2 face"], Float64[np.ndarray, "2 face"]]:
    """The least and the greatest column and row of each face; everything for one that reaches behind the camera."""
    depth = np.where(points[2] > 0, points[2], np.nan)
    column, row = camera.fx * points[0] / depth + camera.cx, camera.fy * points[1] / depth + camera.cy
    a, b, c = (np.stack([column[corner], row[corner]]) for corner in faces.T)
    low, high = np.minimum(np.minimum(a, b), c) - _MARGIN_PX, np.maximum(np.maximum(a, b), c) + _MARGIN_PX
    return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)


def _pairs(
    planes: _Planes, asked: Bool[np.ndarray, "face"], targets: Targets
) -> tuple[Int64[np.ndarray, "pair"], Int64[np.ndarray, "pair"]]:
    """Face and ray of each pair in which the ray runs through an asked face's rectangle and the face may be nearer.

    They are looked up by the pixel, counted from the first one that has a target.
    """
    origin = np.floor(targets.places.min(axis=1, keepdims=True))
    place, line = (targets.places - origin).astype(np.int64)
    shape = (int(line.max()) + 1, int(place.max()) + 1)
    pixel = line * shape[1] + place
    order = np.argsort(pixel, kind="stable")
    begins = np.append(0, np.cumsum(np.bincount(pixel, minlength=shape[0] * shape[1])))
    farthest = np.full(shape, np.inf)
    np.minimum.at(farthest.ravel(), pixel, targets.inverse_depth)

    size = np.array(shape[::-1])[:, None]
    first = np.clip(np.floor(planes.low - origin), 0, size).astype(np.int64)
    last = np.clip(np.floor(planes.high - origin), -1, size - 1).astype(np.int64)
    face, line = _spread(first[1], np.where(asked & (first[0] <= last[0]), last[1] - first[1] + 1, 0))
    left, right = first[0, face], last[0, face]
    across, down, rest = planes.inverse[:, face]
    nearest = rest + np.maximum(across * (left + origin[0]), across * (right + 1 + origin[0]))
    nearest += down * (line + origin[1] + (down > 0))
    kept = np.flatnonzero(nearest > _least(farthest, line, left, right))
    begin = line * shape[1]
    pair, entry = _spread(begins[(begin + left)[kept]], (begins[begin + right + 1] - begins[begin + left])[kept])
    face, ray = face[kept[pair]], order[entry]
    for axis in (0, 1):
        value = targets.places[axis, ray]
        touched = np.flatnonzero((value >= planes.low[axis, face]) & (value <= planes.high[axis, face]))
        face, ray = face[touched], ray[touched]
    return face, ray


def _least(
    image: Float64[np.ndarray, "line place"],
    line: Int64[np.ndarray, "range"],
    left: Int64[np.ndarray, "range"],
    right: Int64[np.ndarray, "range"],
) -> Float64[np.ndarray, "range"]:
    """The least value from left to right in each line, or, of more than three places, that of the whole line."""
    padded = np.pad(image, ((0, 0), (0, 2)), constant_values=np.inf)
    of_three = np.minimum(np.minimum(padded[:, :-2], padded[:, 1:-1]), padded[:, 2:])
    return np.where(right - left < 3, of_three[line, left], image.min(axis=1)[line])


def _spread(
    begin: Int64[np.ndarray, "range"], count: Int64[np.ndarray, "range"]
) -> tuple[Int64[np.ndarray, "entry"], Int64[np.ndarray, "entry"]]:
    """The ranges begin, begin + 1, ... of the counts, one behind the other: number of the range, and value."""
    count = np.maximum(count, 0)
    number = np.repeat(np.arange(len(count)), count)
    return number, np.arange(len(number)) + np.repeat(begin - (np.cumsum(count) - count), count)


def _at(linear: Float64[np.ndarray, "3 *other"], place: Float64[np.ndarray, "2 ray"]) -> Float64[np.ndarray, "*values"]:
    """The values of linear functions at places (column, row)."""
    return linear[0] * place[0] + linear[1] * place[1] + linear[2]
