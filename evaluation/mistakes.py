"""What is wrong with a solution's segments and links, each with the correction by hand that says what is right."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Int64

from evaluation.clustering import contingency
from evaluation.observations import BACKGROUND, Observations
from recording.camera import Camera
from recording.corrections import Anchor, Correction, CorrectionKind
from recording.motions import NOISE

LEAST_POINTS = 50
"""Observed points of what anybody sees."""


@dataclass(frozen=True, kw_only=True)
class Mistake:
    """What is wrong."""

    points: int
    """Observed points of the object that are in the wrong place."""
    correction: Correction
    """What is right."""


def mistakes(observations: Observations, camera: Camera) -> list[Mistake]:
    """The mistakes that are to be seen, the worst first.

    A segment holds points of a second object: both are different. A segment lies outside the motion that has most of
    its object: it is the same as the nearest in time of those within. It lies in the motion of another object, and
    its own has none: it is different from the other's nearest.
    """
    found = _Mistakes(observations=observations, camera=camera)
    return sorted([*found.mixed(), *found.strayed()], key=lambda mistake: -mistake.points)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Mistakes:
    observations: Observations
    camera: Camera

    @cached_property
    def _parts(self) -> list[tuple[int, int, int]]:
        """Segment, object and points of what anybody sees, the most points first."""
        seen = self.observations
        kept = (seen.segment != NOISE) & (seen.objectid != BACKGROUND)
        table = contingency(seen.segment[kept], seen.objectid[kept])
        parts = zip(table.cluster.tolist(), table.label.tolist(), table.count.tolist(), strict=True)
        return sorted((part for part in parts if part[2] >= LEAST_POINTS), key=lambda part: -part[2])

    @cached_property
    def _owner(self) -> dict[int, int]:
        """The object that each segment is of."""
        return {segment: objectid for segment, objectid, _ in reversed(self._parts)}

    @cached_property
    def _motion(self) -> dict[int, int]:
        """The motion that each segment is in, or noise."""
        segment, first = np.unique(self.observations.segment, return_index=True)
        return dict(zip(segment.tolist(), self.observations.motion[first].tolist(), strict=True))

    def mixed(self) -> Iterator[Mistake]:
        """The segments of two objects."""
        for segment, objectid, points in self._parts:
            owner = self._owner[segment]
            if objectid != owner:
                marks = self._mark(segment, owner), self._mark(segment, objectid)
                yield Mistake(points=points, correction=Correction(kind="different", one=marks[0], other=marks[1]))

    def strayed(self) -> Iterator[Mistake]:
        """The segments that are in the wrong motion."""
        home = self._homes()
        for segment, objectid, points in self._parts:
            if self._owner[segment] != objectid or self._motion[segment] == home.get(objectid):
                continue
            kind: CorrectionKind = "same"
            owner, motion = objectid, home.get(objectid)
            if motion is None:  # Its object has no motion of its own.
                motion = self._motion[segment]
                kind, owner = "different", self._holder[motion]
            others = [each for each, its in self._owner.items() if its == owner and self._motion[each] == motion]
            near = min(others, key=lambda each: self._apart(segment, each))
            marks = self._mark(near, owner), self._mark(segment, objectid)
            yield Mistake(points=points, correction=Correction(kind=kind, one=marks[0], other=marks[1]))

    @cached_property
    def _holder(self) -> dict[int, int]:
        """The object that has most points of each motion."""
        points: dict[tuple[int, int], int] = {}
        for segment, objectid, count in self._parts:
            key = self._motion[segment], objectid
            points[key] = points.get(key, 0) + count
        return {motion: objectid for (motion, objectid), _ in sorted(points.items(), key=lambda item: item[1])}

    def _homes(self) -> dict[int, int]:
        """Of the motions that an object has most points of, the one with the most of its points."""
        points: dict[tuple[int, int], int] = {}
        for segment, objectid, count in self._parts:
            motion = self._motion[segment]
            if motion != NOISE and self._holder[motion] == objectid:
                points[objectid, motion] = points.get((objectid, motion), 0) + count
        return {objectid: motion for (objectid, motion), _ in sorted(points.items(), key=lambda item: item[1])}

    def _apart(self, one: int, other: int) -> int:
        """Frames between two segments, below 0 where they overlap."""
        (first, last), (begin, end) = self._span[one], self._span[other]
        return max(begin - last, first - end)

    @cached_property
    def _span(self) -> dict[int, tuple[int, int]]:
        """First and last frame of each segment."""
        seen = self.observations
        order = np.lexsort((seen.frame, seen.segment))
        segment, begin = np.unique(seen.segment[order], return_index=True)
        first, last = seen.frame[order][begin], seen.frame[order][np.r_[begin[1:], len(order)] - 1]
        return {number: (a, b) for number, a, b in zip(segment.tolist(), first.tolist(), last.tolist(), strict=True)}

    def _mark(self, segment: int, objectid: int) -> Anchor:
        """The point in the middle of what is seen of an object's segment in the frame where most of it is."""
        seen = self.observations
        rows = np.flatnonzero((seen.segment == segment) & (seen.objectid == objectid))
        frame = int(np.bincount(seen.frame[rows]).argmax())
        place = self._column_row(seen.pixel[rows[seen.frame[rows] == frame]])
        column, row = place[np.argmin(np.linalg.norm(place - place.mean(axis=0), axis=1))].tolist()
        return Anchor(frame=frame, column=column, row=row, segment=segment)

    def _column_row(self, pixel: Int64[np.ndarray, "point"]) -> np.ndarray:
        """The centres of pixels that are counted through all frames."""
        inside = pixel % (self.camera.height * self.camera.width)
        return np.stack([inside % self.camera.width, inside // self.camera.width], axis=1) + 0.5
