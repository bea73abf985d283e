"""What is known of each segment in each frame; segments are united without going back to the trajectories."""

from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from algorithm.outlines import reaches
from algorithm.patches import Patches
from algorithm.trajectories import Trajectories

_NOTHING = 1e-12
_BARE_PIXELS = 1e-3
"""So much weighs a point without a pixel of its own: a segment of such alone has a centre too."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentFrames:
    """One row a segment and frame in which it has points, sorted by segment, then frame."""

    segment: Int[np.ndarray, "row"]
    frame: Int[np.ndarray, "row"]
    points: Float[np.ndarray, "row"]
    """Number of observed points."""
    area: Float[np.ndarray, "row"]
    """Pixels that they stand for, times the square of their distance: it does not shrink with distance."""
    centre: Float[np.ndarray, "row 3"]
    """Mean place of these pixels, metres."""
    followed: Float[np.ndarray, "row"]
    """The area of the points that are followed to the next frame."""
    step: Float[np.ndarray, "row 3"]
    """Their mean displacement, by area, metres; 0 without any."""
    low: Float[np.ndarray, "row direction"]
    """Least reach along `outlines.DIRECTIONS`, metres."""
    high: Float[np.ndarray, "row direction"]

    @property
    def count(self) -> int:
        """The number of segments."""
        return int(self.segment[-1]) + 1 if len(self.segment) else 0

    def singles(self) -> list["SegmentFrames"]:
        """The rows of every segment by themselves."""
        bounds = np.searchsorted(self.segment, np.arange(self.count + 1)).tolist()
        return [self.part(slice(begin, end)) for begin, end in pairwise(bounds)]

    def part(self, rows: slice) -> "SegmentFrames":
        """Some of the rows, all as segment 0."""
        columns = {name: getattr(self, name)[rows] for name in _COLUMNS}
        return SegmentFrames(**columns | {"segment": np.zeros_like(columns["segment"])})

    @staticmethod
    def together(one: "SegmentFrames", other: "SegmentFrames") -> "SegmentFrames":
        """The rows of two, all as segment 0."""
        columns = {name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in _COLUMNS}
        columns["segment"] = np.zeros_like(columns["segment"])
        return SegmentFrames(**columns).renamed(np.zeros(1, int))

    def renamed(self, name: Int[np.ndarray, "segment"]) -> "SegmentFrames":
        """The rows under new names, -1 for none; segments of the same name become one."""
        kept = name[self.segment] >= 0
        segment, frame = name[self.segment[kept]], self.frame[kept]
        order = np.lexsort((frame, segment))
        segment, frame = segment[order], frame[order]
        start = _starts(segment, frame)

        def total(values: np.ndarray) -> np.ndarray:
            return np.add.reduceat(values[kept][order], start, axis=0) if len(start) else values[:0]

        points, area, followed = total(self.points), total(self.area), total(self.followed)
        return SegmentFrames(
            segment=segment[start],
            frame=frame[start],
            points=points,
            area=area,
            centre=total(self.centre * self.area[:, None]) / area[:, None],
            followed=followed,
            step=total(self.step * self.followed[:, None]) / np.maximum(followed, _NOTHING)[:, None],
            low=np.minimum.reduceat(self.low[kept][order], start) if len(start) else self.low[:0],
            high=np.maximum.reduceat(self.high[kept][order], start) if len(start) else self.high[:0],
        )


_COLUMNS = tuple(entry.name for entry in fields(SegmentFrames))


def segment_frames(
    trajectories: Trajectories,
    segment: Int[np.ndarray, "trajectory"],
    patches: Patches,
    *,
    camera_position: Float[np.ndarray, "3"],
) -> SegmentFrames:
    """The rows of all segments, from 0; trajectories of segment -1 count nowhere."""
    rows = np.flatnonzero(segment[trajectories.trajectory] >= 0)
    label = segment[trajectories.trajectory[rows]]
    position = trajectories.position[rows]
    onward = np.zeros(len(trajectories.trajectory), bool)
    onward[:-1] = trajectories.trajectory[1:] == trajectories.trajectory[:-1]
    following = np.minimum(rows + 1, len(trajectories.trajectory) - 1)
    step = np.where(onward[rows, None], trajectories.position[following] - position, 0.0)
    order = np.lexsort((trajectories.frame[rows], label))
    label, frame = label[order], trajectories.frame[rows][order]
    start = _starts(label, frame)
    if not len(start):
        return _nothing()
    reach = reaches(position[order]).astype(float)
    points = np.diff([*start, len(order)]).astype(float)
    square = np.sum((position[order] - camera_position) ** 2, axis=1)
    weight = (patches.pixels[rows][order] + _BARE_PIXELS) * square
    area = np.add.reduceat(weight, start)
    followed = np.add.reduceat(onward[rows][order] * weight, start)
    return SegmentFrames(
        segment=label[start],
        frame=frame[start],
        points=points,
        area=area,
        centre=np.add.reduceat(patches.centre[rows][order] * weight[:, None], start, axis=0) / area[:, None],
        followed=followed,
        step=np.add.reduceat(step[order] * weight[:, None], start, axis=0) / np.maximum(followed, _NOTHING)[:, None],
        low=np.minimum.reduceat(reach, start),
        high=np.maximum.reduceat(reach, start),
    )


def _starts(segment: np.ndarray, frame: np.ndarray) -> Int[np.ndarray, "row"]:
    """Where a new segment or frame begins."""
    if not len(segment):
        return np.zeros(0, int)
    return np.flatnonzero(np.r_[True, (np.diff(segment) != 0) | (np.diff(frame) != 0)])


def _nothing() -> SegmentFrames:
    number, value, vector = np.zeros(0, int), np.zeros(0), np.zeros((0, 3))
    reach = reaches(vector).astype(float)
    return SegmentFrames(
        segment=number,
        frame=number,
        points=value,
        area=value,
        centre=vector,
        followed=value,
        step=vector,
        low=reach,
        high=reach,
    )
