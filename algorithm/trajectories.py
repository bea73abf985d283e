"""Step 4: matches chained into trajectories (paper, section 4, Trajectory computation)."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from algorithm.matching import Pairs
from recording.camera import Camera, pixel_grid


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


def chained(
    depths: Sequence[Float32[np.ndarray, "row column"]], matches: Iterable[Pairs], *, camera: Camera
) -> Trajectories:
    """Every point of every frame, on the trajectory that its matches make.

    `matches` are those of consecutive frames, one item less than frames. A point without a match before
    it begins a trajectory; one without a match after it ends it.
    """
    number = np.full(depths[0].size, -1)
    frames, pixels, numbers = [], [], []
    begun = 0
    for frame, (depth, pairs) in enumerate(zip(depths, _after_nothing(matches), strict=True)):
        source, goal = pairs
        carried = np.full(depth.size, -1)
        carried[goal] = number[source]
        fresh = np.isfinite(depth).ravel() & (carried < 0)
        carried[fresh] = begun + np.arange(fresh.sum())
        begun += int(fresh.sum())
        number = carried
        pixel = np.flatnonzero(number >= 0)
        frames.append(np.full(len(pixel), frame))
        pixels.append(pixel)
        numbers.append(number[pixel])
    return _sorted(depths, (np.concatenate(numbers), np.concatenate(frames), np.concatenate(pixels)), camera)


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


def _after_nothing(matches: Iterable[Pairs]) -> Iterable[Pairs]:
    """The matches into each frame; nothing leads into the first."""
    nothing = np.zeros(0, int)
    yield nothing, nothing
    yield from matches


def _sorted(
    depths: Sequence[np.ndarray], rows: tuple[np.ndarray, np.ndarray, np.ndarray], camera: Camera
) -> Trajectories:
    number, frame, pixel = rows
    order = np.lexsort((frame, number))
    number, frame, pixel = number[order], frame[order], pixel[order]
    column_row = pixel_grid(camera.height, camera.width).reshape(-1, 2)[pixel]
    depth = np.stack(depths).reshape(len(depths), -1)[frame, pixel].astype(np.float64)
    return Trajectories(
        trajectory=number,
        frame=frame,
        position=camera.world_from_pixel(column_row, depth),
        column_row=column_row,
    )
