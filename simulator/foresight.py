"""Who will be hidden behind whom and behind what: foretold from paths, without a picture.

Every walker has the silhouette (`simulator.silhouette`) of the pose that the gait gives him, upright at his distance
from the camera. The cells of it that something covers are the bits of one number: what several covers hide together is
the bitwise or, what is seen the count of the bits that are left. Compared with rendered pictures of people who
walk behind people, the share that is seen is off by 0.05 (root mean square) (`docs/families.md`).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int, UInt64

from recording.camera import Camera
from simulator.silhouette import silhouettes
from simulator.things import Obstacle

NEAREST_M = 0.5
"""Who is nearer to the camera is not seen, and hides nobody."""
_REACH_M = 0.45
"""Half the width of a silhouette at the most: whose axes are farther apart do not meet."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sights:
    """Walkers as they stand before the camera, the last axis their frames; they broadcast against one another."""

    pose: Int[np.ndarray, "*walker"]
    """Which silhouette."""
    distance: Float[np.ndarray, "*walker"]
    """From the camera, on the ground, metres."""
    angle: Float[np.ndarray, "*walker"]
    """To the right of the view, radians."""

    def __getitem__(self, chosen: Any) -> "Sights":
        """Some of the walkers."""
        return Sights(pose=self.pose[chosen], distance=self.distance[chosen], angle=self.angle[chosen])


def sights(
    camera: Camera,
    walks: Float[np.ndarray, "*walker frame 2"],
    body: Int[np.ndarray, "*walker"],
    phase: Float[np.ndarray, "*walker"],
    fps: float,
) -> Sights:
    """The walkers whose centres are at these places on the ground, metres, the gait's phase that of the first frame."""
    velocity = np.gradient(walks, axis=-2) * fps
    cycles = silhouettes().cycles(body, np.linalg.norm(velocity, axis=-1), phase, 1 / fps)
    away = walks - camera.position[:2]
    angle = _angle(camera, away)
    turn = _angle(camera, velocity) - angle
    return Sights(
        pose=silhouettes().pose(body[..., None], cycles, turn), distance=np.linalg.norm(away, axis=-1), angle=angle
    )


def cells_in_picture(camera: Camera, far: Sights) -> UInt64[np.ndarray, "*walker"]:
    """The cells of each walker that lie inside the picture: 0 where he is out of view."""
    aside, height = silhouettes().aside_m[far.pose], silhouettes().height_m[far.pose]
    angle = far.angle[..., None] + aside / np.maximum(far.distance, NEAREST_M)[..., None]
    forward, right = _axes(camera)
    ground = np.cos(angle)[..., None] * forward + np.sin(angle)[..., None] * right
    places = np.concatenate([ground * far.distance[..., None, None] + camera.position[:2], height[..., None]], axis=-1)
    column_row, _ = camera.pixel_from_world(places)
    return _bits(camera.contains(column_row) & (far.distance > NEAREST_M)[..., None])


def cells_behind_people(camera: Camera, far: Sights, near: Sights) -> UInt64[np.ndarray, "*pair"]:
    """The cells of each far walker that the near one covers; none where the near one is no nearer."""
    shape = np.broadcast_shapes(far.angle.shape, near.angle.shape)
    apart = np.abs(near.angle - far.angle) * near.distance
    half_view = np.arctan(max(camera.cx, camera.width - camera.cx) / camera.fx)
    shown = np.abs(far.angle) < half_view + _REACH_M / np.maximum(far.distance, NEAREST_M)
    meet = (near.distance < far.distance) & (near.distance > NEAREST_M) & shown
    meet &= apart < _REACH_M * (1 + near.distance / np.maximum(far.distance, NEAREST_M))
    pairs = np.nonzero(meet)
    behind, before = _broadcast(far, shape)[pairs], _broadcast(near, shape)[pairs]
    aside, height = _passed(camera, behind, before.distance)
    beside = (np.tan(before.angle - behind.angle) * before.distance).astype(np.float32)
    cells = np.zeros(shape, np.uint64)
    cells[pairs] = _bits(silhouettes().covers(before.pose[:, None], aside - beside[:, None], height))
    return cells


def cells_behind_obstacle(camera: Camera, far: Sights, obstacle: Obstacle) -> UInt64[np.ndarray, "*walker"]:
    """The cells of each walker that the obstacle covers."""
    away = outline(obstacle) - camera.position[:2]
    angle, distance = _angle(camera, away), float(np.linalg.norm(np.array(obstacle.position[:2]) - camera.position[:2]))
    middle, half = float(angle.max() + angle.min()) / 2, float(np.ptp(angle)) / 2
    meet = np.nonzero((distance < far.distance) & (np.abs(far.angle - middle) < half + _REACH_M / far.distance))
    behind = far[meet]
    aside, height = _passed(camera, behind, np.full(len(behind.angle), distance))
    at = behind.angle[:, None] + aside / np.float32(distance)
    top = _height(obstacle)
    above = height - obstacle.position[2]
    narrowed = half * np.clip(1 - above / top, 0.0, 1.0) if obstacle.shape == "cone" else half
    cells = np.zeros(far.angle.shape, np.uint64)
    cells[meet] = _bits((np.abs(at - middle) <= narrowed) & (above >= 0) & (above <= top))
    return cells


def outline(obstacle: Obstacle) -> Float[np.ndarray, "corner 2"]:
    """Corners of the obstacle's outline on the ground, for a round one points of its circle; metres."""
    if obstacle.size is None:
        turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
        corners = (obstacle.radius or 0.0) * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    else:
        yaw = np.radians(obstacle.yaw_deg)
        half = np.array(obstacle.size[:2]) / 2 * np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]])
        corners = half @ np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return corners + np.array(obstacle.position[:2])


def seen_share(
    inside: UInt64[np.ndarray, "*walker"], covered: UInt64[np.ndarray, "*walker"]
) -> Float[np.ndarray, "*walker"]:
    """The share of a walker's cells in the picture that is not covered; 1 where he is out of view."""
    there = np.bitwise_count(inside)
    seen = np.bitwise_count(inside & ~covered)
    return np.where(there > 0, seen / np.maximum(there, 1), 1.0)


def _passed(
    camera: Camera, behind: Sights, distance: Float[np.ndarray, "walker"]
) -> tuple[Float[np.ndarray, "walker cell"], Float[np.ndarray, "walker cell"]]:
    """Where the views of the cells pass at that distance: aside of the walker's own line of sight, and how high."""
    shrink = (distance / behind.distance).astype(np.float32)[:, None]
    eye = np.float32(camera.position[2])
    aside = silhouettes().aside_m[behind.pose] * shrink
    return aside, eye + (silhouettes().height_m[behind.pose] - eye) * shrink


def _bits(cells: Bool[np.ndarray, "*walker cell"]) -> UInt64[np.ndarray, "*walker"]:
    """The truth of all cells as the bits of one number."""
    return np.ascontiguousarray(np.packbits(cells, axis=-1)).view(np.uint64).reshape(cells.shape[:-1])


def _broadcast(walkers: Sights, shape: tuple[int, ...]) -> Sights:
    return Sights(
        pose=np.broadcast_to(walkers.pose, shape),
        distance=np.broadcast_to(walkers.distance, shape),
        angle=np.broadcast_to(walkers.angle, shape),
    )


def _axes(camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Forward and right on the ground."""
    forward = camera.world_from_camera[:2, 2]
    return forward / np.linalg.norm(forward), camera.world_from_camera[:2, 0]


def _angle(camera: Camera, vectors: Float[np.ndarray, "*vector 2"]) -> Float[np.ndarray, "*vector"]:
    forward, right = _axes(camera)
    return np.arctan2(vectors @ right, vectors @ forward)


def _height(obstacle: Obstacle) -> float:
    return obstacle.size[2] if obstacle.size is not None else obstacle.height or 0.0
