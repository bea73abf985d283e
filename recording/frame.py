"""One frame of a recording: what the sensor saw and, where it is known, what really stood there."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from jaxtyping import Bool, Float32, UInt32

NEAREST_M, FARTHEST_M = 1e-4, 1e5
"""Depths that a recording may have: with others single precision no longer tells points apart, or squares overflow."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Labels:
    """The material point behind every pixel."""

    objectid: UInt32[np.ndarray, "row column"]
    """The object's id; 0 where the pixel's ray meets nothing."""
    face: UInt32[np.ndarray, "row column"] | None = None
    """The number of the object's face; None where only the objects' masks are known."""
    u: Float32[np.ndarray, "row column"] | None = None
    """Barycentric weight of the face's corner B."""
    v: Float32[np.ndarray, "row column"] | None = None
    """Barycentric weight of the face's corner C."""

    @property
    def exact(self) -> bool:
        """Whether the material points are known, not only the objects."""
        return self.face is not None and self.u is not None and self.v is not None


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """A depth image with its labels, if it has any."""

    depth: Float32[np.ndarray, "row column"]
    """Sensed distance along the camera's z axis, metres; NaN = no return."""
    labels: Labels | None = None
    """Ground truth by pixel, of the centre ray, whatever the sensor made of its depth."""
    clean_depth: Float32[np.ndarray, "row column"] | None = None
    """The depth before the sensor, metres; NaN = nothing there."""
    reason: UInt32[np.ndarray, "row column"] | None = None
    """Why a return is missing or mixed (`Reason`); 0 = it is as it should be."""

    @property
    def seen(self) -> Bool[np.ndarray, "row column"]:
        """Where the sensor has a return."""
        return np.isfinite(self.depth)


class Reason(IntEnum):
    """The numbers of `Frame.reason`."""

    RETURN = 0
    """The return is as it should be."""
    NOTHING_THERE = 1
    """The pixel's ray meets nothing."""
    OUT_OF_RANGE = 2
    """Its surface is nearer or farther than the sensor measures."""
    SHADOW = 3
    """Something keeps the projector's light from the point, or the second camera's sight."""
    EDGE = 4
    """Too much of what the sensor looks at there is another surface."""
    GRAZING = 5
    """The surface is too steep."""
    NO_SIGNAL = 6
    """Too little light comes back, as in the corners, or a hole for no reason that is known."""
    MIXED = 7
    """There is a return, but another surface has a part in it."""


REASONS = {int(reason): reason.name.lower().replace("_", " ") for reason in Reason}
"""What the numbers of `Frame.reason` mean."""
