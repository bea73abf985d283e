"""What is known of each segment in each frame; segments are united without going back to the trajectories."""

from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from algorithm.compiled import compiled
from algorithm.outlines import DIRECTIONS, reaches
from algorithm.patches import Patches
from algorithm.trajectories import Trajectories

_NOTHING = 1e-12
_BARE_PIXELS = 1e-3
"""So much weighs a point without a pixel of its own: a segment of such alone has a centre too."""
_POINTS, _AREA, _FOLLOWED, _CENTRE, _STEP = 0, 1, 2, 3, 6
"""Columns of the sums; the last two are vectors."""


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
    known = np.flatnonzero(segment >= 0)
    if not len(known):
        return _nothing()
    count = int(segment.max()) + 1
    first, last = np.full(count, np.iinfo(np.int64).max // 2), np.full(count, -1)
    np.minimum.at(first, segment[known], trajectories.first_frame[known])
    np.maximum.at(last, segment[known], trajectories.last_frame[known])
    span = np.maximum(last - first + 1, 0)
    room = np.cumsum(span) - span - first  # Where frame 0 of each segment would be.
    observed = trajectories.trajectory, trajectories.frame, trajectories.position
    totals, reach = _totals(observed, (segment, room), (patches.pixels, patches.centre), camera_position, span.sum())
    seen = np.flatnonzero(totals[:, _POINTS] > 0)
    label = np.repeat(np.arange(count), span)[seen]
    totals, reach = totals[seen], reach[seen].astype(float)
    area, followed = totals[:, _AREA], totals[:, _FOLLOWED]
    return SegmentFrames(
        segment=label,
        frame=seen - room[label],
        points=totals[:, _POINTS],
        area=area,
        centre=totals[:, _CENTRE : _CENTRE + 3] / area[:, None],
        followed=followed,
        step=totals[:, _STEP : _STEP + 3] / np.maximum(followed, _NOTHING)[:, None],
        low=reach[:, 0],
        high=reach[:, 1],
    )


@compiled
def _totals(
    observed: tuple[np.ndarray, np.ndarray, np.ndarray],
    named: tuple[np.ndarray, np.ndarray],
    patches: tuple[np.ndarray, np.ndarray],
    eye: np.ndarray,
    rows: int,
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """Sums over the points of each segment and frame, in the columns below, and their least and largest reach."""
    trajectory, frame, position = observed
    segment, room = named
    pixels, centre = patches
    totals = np.zeros((rows, _STEP + 3))
    reach = np.empty((rows, 2, len(DIRECTIONS)), np.float32)
    reach[:, 0], reach[:, 1] = np.inf, -np.inf
    for point in range(len(trajectory)):
        label = segment[trajectory[point]]
        if label < 0:
            continue
        row = room[label] + frame[point]
        square = 0.0
        for axis in range(3):
            square += (position[point, axis] - eye[axis]) ** 2
        weight = (pixels[point] + _BARE_PIXELS) * square
        totals[row, _POINTS] += 1.0
        totals[row, _AREA] += weight
        onward = point + 1 < len(trajectory) and trajectory[point + 1] == trajectory[point]
        if onward:
            totals[row, _FOLLOWED] += weight
        for axis in range(3):
            totals[row, _CENTRE + axis] += centre[point, axis] * weight
            if onward:
                totals[row, _STEP + axis] += (position[point + 1, axis] - position[point, axis]) * weight
        for number in range(len(DIRECTIONS)):
            distance = 0.0
            for axis in range(3):
                distance += position[point, axis] * DIRECTIONS[number, axis]
            along = np.float32(distance)
            reach[row, 0, number] = min(reach[row, 0, number], along)
            reach[row, 1, number] = max(reach[row, 1, number], along)
    return totals, reach


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
