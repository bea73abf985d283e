"""The paper's own way from points to depth images (section 4): projection on the scanner's plane.

"The depth map resolution is determined by the minimal relative distance between projected points on the plane, so that
each pixel will contain no more than one point in every frame. Pixels without a point hold an empty value."
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32
from scipy.spatial import cKDTree

from recording.camera import PIXEL_CENTRE, Camera
from recording.errors import InputError

LARGEST_PIXELS = 4_000_000
"""A finer picture than this is no depth image any more: some two points lie as good as on one ray."""
_ROUNDING = 1e-5
"""The pixels are finer than the smallest distance by this share, as coordinates in single precision are rounded."""


@dataclass(frozen=True, kw_only=True)
class _Extent:
    """What all frames together ask of the picture, on the plane at distance 1."""

    smallest: float
    """Distance of the two nearest points of one frame, the larger of across and down."""
    low: tuple[float, float]
    high: tuple[float, float]
    first: Float[np.ndarray, "point 2"]
    """The points of the first frame that has any, to lay the pixels about."""


def scanner_camera(
    clouds: Iterable[Float[np.ndarray, "point 3"]], world_from_camera: Float[np.ndarray, "4 4"], *, source: str
) -> Camera:
    """The camera with the largest square pixels of which none holds two points of a frame.

    The points are in the camera's axes. Two points that are one pixel's side apart, across or down, are never in one
    pixel: so its side is the smallest such distance of all frames. Where the points come from a grid of rays, the
    pixels are that grid.
    """
    extent = _extent(clouds, source)
    side = extent.smallest * (1 - _ROUNDING)
    advice = "pass the scanner's own --fx, --fy, --cx, --cy and --size, and the nearest point of a pixel is taken"
    if not side > 0:
        raise InputError(f"{source}: expected points on rays of their own, but two of a frame lie on one ray: {advice}")
    with np.errstate(over="ignore"):  # Two points may lie on rays as near as numbers can.
        size = [np.floor((high - low) / side) + 2 for low, high in zip(extent.low, extent.high, strict=True)]
    if not size[0] * size[1] <= LARGEST_PIXELS:
        raise InputError(
            f"{source}: expected points on rays of their own, but two of a frame lie so nearly on one that the picture "
            f"would need {size[0]:.2g}x{size[1]:.2g} pixels: {advice}"
        )
    column, row = (
        low / side - PIXEL_CENTRE + _phase((values - low) / side)
        for low, values in zip(extent.low, extent.first.T, strict=True)
    )
    return Camera(
        width=int(size[0]),
        height=int(size[1]),
        fx=1 / side,
        fy=1 / side,
        cx=-column,
        cy=-row,
        world_from_camera=world_from_camera,
    )


def depth_of(points: Float[np.ndarray, "point 3"], camera: Camera) -> Float32[np.ndarray, "row column"]:
    """The depth image of points in the camera's axes: a pixel has the depth of its nearest point, or NaN.

    Points behind the camera or beside the picture are left out.
    """
    image = np.full(camera.height * camera.width, np.inf)
    before = points[points[:, 2] > 0]
    column = np.floor(before[:, 0] / before[:, 2] * camera.fx + camera.cx)
    row = np.floor(before[:, 1] / before[:, 2] * camera.fy + camera.cy)
    inside = (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    place = row[inside].astype(int) * camera.width + column[inside].astype(int)
    np.minimum.at(image, place, before[inside, 2])
    return np.where(np.isfinite(image), image, np.nan).astype(np.float32).reshape(camera.height, camera.width)


def _extent(clouds: Iterable[Float[np.ndarray, "point 3"]], source: str) -> _Extent:
    smallest, low, high = np.inf, np.full(2, np.inf), np.full(2, -np.inf)
    first = np.empty((0, 2))
    for number, points in enumerate(clouds):
        behind = int((points[:, 2] <= 0).sum())
        if behind:
            raise InputError(
                f"{source}: expected points before the scanner, at z > 0, but {behind} of {len(points)} in frame "
                f"{number} are not: say how the axes point by --axes, or where the scanner is by --pose or --extrinsics"
            )
        with np.errstate(over="ignore"):
            plane = points[:, :2] / points[:, 2:]
        if not np.isfinite(plane).all():
            raise InputError(f"{source}: expected points before the scanner, got one at 90 degrees in frame {number}")
        if len(plane):
            low, high = np.minimum(low, plane.min(axis=0)), np.maximum(high, plane.max(axis=0))
            first = first if len(first) else plane
        if len(plane) > 1:
            distance, _ = cKDTree(plane).query(plane, k=2, p=np.inf)
            smallest = min(smallest, float(distance[:, 1].min()))
    if not np.isfinite(smallest):
        raise InputError(f"{source}: expected clouds of at least two points, got none")
    return _Extent(smallest=smallest, low=(low[0], low[1]), high=(high[0], high[1]), first=first)


def _phase(position: Float[np.ndarray, "point"]) -> float:
    """Where within a pixel most points lie, from -0.5 to 0.5; pixels laid about it are safe from rounding.

    The mean direction on a circle whose turn is a pixel.
    """
    return float(np.angle(np.exp(2j * np.pi * position).mean()) / (2 * np.pi))
