"""The pinhole camera, and the one place that states the pixel convention.

Axes are OpenCV's: x right, y down, z forward. Depth is the distance along z in metres, NaN where nothing
returned. A picture position is continuous: pixel (0, 0) has its centre at column 0.5, row 0.5.
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

PIXEL_CENTRE = 0.5


def pixel_grid(height: int, width: int) -> Float[np.ndarray, "row column 2"]:
    """The picture position (column, row) of every pixel's centre."""
    column = np.arange(width) + PIXEL_CENTRE
    row = np.arange(height) + PIXEL_CENTRE
    return np.stack(np.meshgrid(column, row), axis=-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A fixed pinhole camera."""

    width: int
    """Picture width, pixels."""
    height: int
    """Picture height, pixels."""
    fx: float
    """Focal length along the columns, pixels."""
    fy: float
    """Focal length along the rows, pixels."""
    cx: float
    """Column of the principal point, pixels, in the convention of `PIXEL_CENTRE`."""
    cy: float
    """Row of the principal point, pixels, in the convention of `PIXEL_CENTRE`."""
    world_from_camera: Float[np.ndarray, "4 4"] = field(default_factory=lambda: np.eye(4))
    """Rigid transform that takes camera points to world points, metres; by default both have the same axes."""

    @property
    def position(self) -> Float[np.ndarray, "3"]:
        """The centre of projection, world axes, metres."""
        return self.world_from_camera[:3, 3]

    def camera_from_pixel(
        self, column_row: Float[np.ndarray, "*shape 2"], depth: Float[np.ndarray, "*shape"]
    ) -> Float[np.ndarray, "*shape 3"]:
        """The points, in camera axes and metres, seen at the picture positions at the depths."""
        focal = np.array([self.fx, self.fy])
        principal = np.array([self.cx, self.cy])
        sideways = (column_row - principal) / focal * depth[..., None]
        return np.concatenate([sideways, depth[..., None]], axis=-1)

    def world_from_pixel(
        self, column_row: Float[np.ndarray, "*shape 2"], depth: Float[np.ndarray, "*shape"]
    ) -> Float[np.ndarray, "*shape 3"]:
        """The points, in world axes and metres, seen at the picture positions at the depths."""
        return transformed(self.world_from_camera, self.camera_from_pixel(column_row, depth))

    def world_points(self, depth: Float[np.ndarray, "row column"]) -> Float[np.ndarray, "row column 3"]:
        """The point behind every pixel, world axes, metres; NaN where nothing returned."""
        return self.world_from_pixel(pixel_grid(self.height, self.width), depth.astype(np.float64))

    def pixel_from_world(
        self, points: Float[np.ndarray, "*shape 3"]
    ) -> tuple[Float[np.ndarray, "*shape 2"], Float[np.ndarray, "*shape"]]:
        """The picture position (column, row) and the depth of world points.

        A point in or behind the camera's plane has no picture position: NaN. Positions outside the
        picture are returned as they are.
        """
        camera_points = transformed(np.linalg.inv(self.world_from_camera), points)
        depth = camera_points[..., 2]
        safe_depth = np.where(depth > 0, depth, np.nan)
        focal = np.array([self.fx, self.fy])
        principal = np.array([self.cx, self.cy])
        return camera_points[..., :2] / safe_depth[..., None] * focal + principal, depth

    def contains(self, column_row: Float[np.ndarray, "*shape 2"]) -> np.ndarray:
        """Whether picture positions lie inside the picture; NaN does not."""
        column, row = column_row[..., 0], column_row[..., 1]
        return (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)

    def resized(self, width: int, height: int) -> "Camera":
        """The same view in another number of pixels."""
        across, down = width / self.width, height / self.height
        return Camera(
            width=width,
            height=height,
            fx=self.fx * across,
            fy=self.fy * down,
            cx=self.cx * across,
            cy=self.cy * down,
            world_from_camera=self.world_from_camera,
        )


def transformed(
    target_from_source: Float[np.ndarray, "4 4"], points: Float[np.ndarray, "*shape 3"]
) -> Float[np.ndarray, "*shape 3"]:
    """The points of the source axes in the target axes."""
    return points @ target_from_source[:3, :3].T + target_from_source[:3, 3]


def looking_at(position: tuple[float, float, float], target: tuple[float, float, float]) -> Float[np.ndarray, "4 4"]:
    """`world_from_camera` of a camera at `position` that looks at `target`, upright in a z-up world.

    A camera that looks straight up or down has no upright; its picture's top then points along +y.
    """
    forward = np.subtract(target, position, dtype=np.float64)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    if np.linalg.norm(right) < 1e-9:
        right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    world_from_camera = np.eye(4)
    world_from_camera[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    world_from_camera[:3, 3] = position
    return world_from_camera
