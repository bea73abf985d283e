"""Where the scene lies: its middle, its size, and which way is up."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float16, Float64

from recording.motions import Motions
from recording.recording import Recording
from recording.visibility import surface_points

_MOMENTS = 5
"""Frames that tell where the sensed points of a recording without motions lie."""
_UPRIGHT = 0.5
"""From this share on the camera's top points along the world's z axis, which then is up."""
_BEHIND, _BESIDE, _ABOVE, _ASIDE = 0.95, 0.6, 0.7, 0.2
"""Where the viewer looks from at first, as shares of its distance: behind the middle as the camera sees it, to its
right and above, so that it sees behind what hides; and how far beside the middle it looks, for the panels are at the
right."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Space:
    """A box in the world that holds nearly all that is shown; world axes, metres."""

    middle: Float64[np.ndarray, "3"]
    camera: Float64[np.ndarray, "3"]
    size_m: float
    """The box's diagonal."""
    up: Float64[np.ndarray, "3"]
    """The world's z axis; of a camera that nobody has placed in a world its own top."""
    forward: Float64[np.ndarray, "3"]
    """Away from the camera, at right angles to `up`."""

    @property
    def upright(self) -> bool:
        """Whether z is up, and so the ground at z = 0."""
        return bool(self.up[2] == 1.0)

    @property
    def eye(self) -> Float64[np.ndarray, "3"]:
        """A good place to look from."""
        away = _ABOVE * self.up - _BEHIND * self.forward + _BESIDE * np.cross(self.forward, self.up)
        return self.middle + self.distance_m * away

    @property
    def target(self) -> Float64[np.ndarray, "3"]:
        """What to look at from there."""
        sideways = _BEHIND * np.cross(self.forward, self.up) + _BESIDE * self.forward
        return self.middle + _ASIDE * self.distance_m * sideways

    @property
    def distance_m(self) -> float:
        """Far enough to see all of it, and the camera where that is near."""
        return float(np.clip(np.linalg.norm(self.camera - self.middle), 0.9 * self.size_m, 1.3 * self.size_m))

    def near(self, points: Float[np.ndarray, "point 3"]) -> Float16[np.ndarray, "point 3"]:
        """The points as seen from the middle, where half precision is good to millimetres."""
        return (points - self.middle).astype(np.float16)


def space_of(recording: Recording, motions: Motions | None) -> Space:
    """The space of the motions; of a recording without any that of what was sensed."""
    some = motions.position.astype(np.float64) if motions is not None and len(motions) else _sensed(recording)
    low, high = np.percentile(some, (2, 98), axis=0) if len(some) else (np.zeros(3), np.ones(3))
    world_from_camera = recording.camera.world_from_camera
    top, onward = -world_from_camera[:3, 1], world_from_camera[:3, 2]
    up = np.array([0.0, 0.0, 1.0]) if top[2] > _UPRIGHT else top
    forward = onward - (onward @ up) * up
    return Space(
        middle=(low + high) / 2,
        camera=recording.camera.position.astype(np.float64),
        size_m=max(float(np.linalg.norm(high - low)), 0.5),
        up=up,
        forward=forward / max(float(np.linalg.norm(forward)), 1e-9),
    )


def _sensed(recording: Recording) -> Float64[np.ndarray, "point 3"]:
    moments = np.unique(np.linspace(0, recording.metadata.frames - 1, _MOMENTS).astype(int)).tolist()
    return np.concatenate([surface_points(recording.camera, recording.frames[moment].depth) for moment in moments])
