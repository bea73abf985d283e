"""What is left out of the frames on the way, and how much of them it was."""

from dataclasses import dataclass, field, replace

import numpy as np

from importing.background import Background
from importing.ground import Ground
from recording.frame import Frame
from recording.metadata import RemovedRecord


@dataclass(kw_only=True, eq=False)
class Removing:
    """Leaves returns out of one frame after the other, and counts them."""

    ground: Ground | None = None
    background: Background | None = None
    _returns: int = field(default=0, init=False)
    _of_ground: int = field(default=0, init=False)
    _of_background: int = field(default=0, init=False)

    def left_of(self, frame: Frame) -> Frame:
        """The frame without ground and background."""
        ground, background = (
            np.zeros(frame.depth.shape, bool) if each is None else each.covers(frame.depth)
            for each in (self.ground, self.background)
        )
        self._returns += int(frame.seen.sum())
        self._of_ground += int(ground.sum())
        self._of_background += int((background & ~ground).sum())
        gone = ground | background
        return replace(frame, depth=np.where(gone, np.float32(np.nan), frame.depth)) if gone.any() else frame

    def records(self) -> tuple[RemovedRecord, ...] | None:
        """What was left out of the frames up to now; None if nothing was to be."""
        records, returns = [], max(self._returns, 1)
        if self.ground is not None:
            share, distance_m = self._of_ground / returns, round(self.ground.distance_m, 4)
            records.append(RemovedRecord(what="ground", share=round(share, 6), distance_m=distance_m))
        if self.background is not None:
            records.append(RemovedRecord(what="background", share=round(self._of_background / returns, 6)))
        return tuple(records) or None
