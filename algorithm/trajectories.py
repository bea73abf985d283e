"""Points followed over time, and which of them are no noise (paper, section 4, Trajectory computation)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectories:
    """Points followed over consecutive frames, one after the other; rows sorted by trajectory, then frame."""

    trajectory: Int[np.ndarray, "observation"]
    """The number of each row's trajectory, from 0."""
    frame: Int[np.ndarray, "observation"]
    position: Float[np.ndarray, "observation 3"]
    """World axes, metres."""
    column_row: Float[np.ndarray, "observation 2"]
    """Picture position, pixels."""

    @property
    def count(self) -> int:
        """The number of trajectories."""
        return int(self.trajectory[-1]) + 1 if len(self.trajectory) else 0

    @cached_property
    def length(self) -> Int[np.ndarray, "trajectory"]:
        """Frames that each trajectory lasts."""
        return np.bincount(self.trajectory, minlength=self.count)

    @cached_property
    def first_row(self) -> Int[np.ndarray, "trajectory"]:
        """The row at which each trajectory begins."""
        return np.concatenate([[0], np.cumsum(self.length)[:-1]]).astype(int)[: self.count]

    @property
    def first_frame(self) -> Int[np.ndarray, "trajectory"]:
        """The frame in which each trajectory begins."""
        return self.frame[self.first_row]

    @property
    def last_frame(self) -> Int[np.ndarray, "trajectory"]:
        """The last frame of each trajectory."""
        return self.frame[self.first_row + self.length - 1]

    def chosen(self, which: Bool[np.ndarray, "trajectory"]) -> "Trajectories":
        """The chosen trajectories, numbered anew in the same order."""
        length = self.length[which]
        number = np.repeat(np.arange(len(length)), length)
        rows = np.arange(len(number)) + np.repeat(self.first_row[which] - (np.cumsum(length) - length), length)
        return Trajectories(
            trajectory=number,
            frame=self.frame[rows],
            position=self.position[rows],
            column_row=self.column_row[rows],
        )


def lasting(trajectories: Trajectories, *, extent_m: float, frames: int) -> Trajectories:
    """The trajectories that are no noise: `frames` long at least, and of an extent above epsilon 2.

    The extent is the diameter of the trajectory's bounding box, metres. (The paper's "length" has no
    unit; what must go is what stands still.)
    """
    if not trajectories.count:
        return trajectories
    starts = trajectories.first_row
    low = np.minimum.reduceat(trajectories.position, starts, axis=0)
    high = np.maximum.reduceat(trajectories.position, starts, axis=0)
    extent = np.linalg.norm(high - low, axis=1)
    return trajectories.chosen((extent >= extent_m) & (trajectories.length >= frames))


def thinned(trajectories: Trajectories, *, apart_px: int) -> Trajectories:
    """The trajectories that begin in every so many columns and rows of the picture, as they are among all others."""
    pixel = np.floor(trajectories.column_row[trajectories.first_row])
    return trajectories.chosen((pixel % apart_px == 0).all(axis=1))
