"""What was followed, frame by frame and in little room, until all of it is sorted into trajectories."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from algorithm.trajectories import Trajectories
from recording.camera import Camera

_ROWS_AT_ONCE = 1_000_000
"""A row takes 16 bytes here, 44 as part of a trajectory, and some hundred while it is sorted."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Observations:
    """The points that are followed in one frame."""

    number: Int32[np.ndarray, "point"]
    """Of their trajectories, counted from 0 over the recording."""
    column_row: Float32[np.ndarray, "point 2"]
    """Picture position, pixels."""
    depth: Float32[np.ndarray, "point"]
    """Metres."""

    def chosen(self, which: Bool[np.ndarray, "point"]) -> "Observations":
        """Some of the points."""
        return Observations(number=self.number[which], column_row=self.column_row[which], depth=self.depth[which])


def sorted_trajectories(
    history: Sequence[Observations],
    *,
    camera: Camera,
    keep: Callable[[Trajectories], Trajectories] = lambda every: every,
) -> Trajectories:
    """The trajectories of what was observed in every frame, those of them that `keep` keeps of some.

    They are sorted some at a time, and what is not kept goes before the next are: so noise never takes much room.
    """
    most = sum(len(points.number) for points in history)  # Room that is never written to takes no memory.
    columns: dict[str, np.ndarray] = {
        "trajectory": np.empty(most, np.int64),
        "frame": np.empty(most, np.int32),
        "position": np.empty((most, 3)),
        "column_row": np.empty((most, 2), np.float32),
    }
    rows = count = 0
    for part in _parts(history):
        kept = keep(_sorted(part, camera))
        own = slice(rows, rows + len(kept.frame))
        for name, column in columns.items():
            column[own] = getattr(kept, name)
        columns["trajectory"][own] += count
        rows, count = own.stop, count + kept.count
    return Trajectories(**{name: column[:rows] for name, column in columns.items()})


def _parts(history: Sequence[Observations]) -> Iterator[list[Observations]]:
    """The history of some trajectories after the other; one part at least."""
    length = np.zeros(1 + max((int(points.number.max(initial=-1)) for points in history), default=-1), np.int64)
    for points in history:
        length[points.number] += 1  # None stands twice in a frame.
    ends = np.flatnonzero(np.diff(np.cumsum(length) // _ROWS_AT_ONCE, append=-1)) + 1 if len(length) else [0]
    for first, end in pairwise([0, *ends]):
        yield [points.chosen((points.number >= first) & (points.number < end)) for points in history]


def _sorted(history: Sequence[Observations], camera: Camera) -> Trajectories:
    """The points by trajectory, then frame; trajectories numbered anew from 0, in the same order."""
    number = np.concatenate([points.number for points in history])
    frame = np.repeat(np.arange(len(history), dtype=np.int32), [len(points.number) for points in history])
    order = np.argsort(number, kind="stable")  # They are in order of time.
    column_row = np.concatenate([points.column_row for points in history])[order]
    depth = np.concatenate([points.depth for points in history])[order].astype(np.float64)
    return Trajectories(
        trajectory=_counted(number[order]),
        frame=frame[order],
        position=camera.world_from_pixel(column_row.astype(np.float64), depth),
        column_row=column_row,
    )


def _counted(number: Int32[np.ndarray, "row"]) -> Int64[np.ndarray, "row"]:
    """Sorted numbers, without gaps from 0."""
    return np.cumsum(np.diff(number, prepend=number[:1]) > 0)
