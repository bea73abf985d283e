"""Where each motion is in each frame: a box about the bulk of its points."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from recording.motions import NOISE, Motions
from viewer.lines import Lines, shade

_BULK = (0.02, 0.98)
"""Shares of a motion's points between which its box lies: a stray point does not widen it."""
_CORNERS = np.arange(8)[:, None] >> np.array([2, 1, 0]) & 1
_EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1])
"""The twelve edges of a box, whose corner numbers' bits say low or high along x, y and z."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Boxes:
    """An entry a frame and motion that has points there, observed or not, by frame, then motion."""

    frame: Int64[np.ndarray, "box"]
    motion: Int64[np.ndarray, "box"]
    low: Float64[np.ndarray, "box 3"]
    """World axes, metres."""
    high: Float64[np.ndarray, "box 3"]

    def lines(self, picked: int | None, frames: int) -> list[Lines]:
        """By frame the edges of its boxes, in the colours of their motions."""
        parts: list[list[Lines]] = [[] for _ in range(frames)]
        for frame, motion, bounds in zip(
            self.frame.tolist(), self.motion.tolist(), np.stack([self.low, self.high], axis=1), strict=True
        ):
            ends = np.take_along_axis(bounds, _CORNERS, axis=0)[_EDGES].astype(np.float32)
            parts[frame].append(Lines(ends=ends, colours=np.tile(shade(motion, picked), (len(ends), 1))))
        return [Lines.of(each) for each in parts]

    def tops(self, up: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "box 3"]:
        """The middle of each box's upper side."""
        return (self.low + self.high) / 2 + up * ((self.high - self.low) / 2 @ np.abs(up))[:, None]


def boxes_of(motions: Motions) -> Boxes:
    """The boxes of all motions; noise has none."""
    row = np.flatnonzero(motions.motion != NOISE)
    row = row[np.lexsort((motions.motion[row], motions.frame[row]))]
    key = np.stack([motions.frame[row], motions.motion[row]], axis=1).astype(np.int64)
    first = np.flatnonzero(np.any(np.diff(key, axis=0, prepend=-2), axis=1))
    some = np.split(motions.position[row].astype(np.float64), first[1:]) if len(row) else []
    bounds = np.array([np.quantile(points, _BULK, axis=0) for points in some]).reshape(-1, 2, 3)
    return Boxes(frame=key[first, 0], motion=key[first, 1], low=bounds[:, 0], high=bounds[:, 1])
