"""Segments that somebody points at, to say something of them: the first and the second."""

from dataclasses import dataclass

import numpy as np

from recording.corrections import Anchor
from recording.motions import NOISE, Motions
from viewer.clock import Signal

_SLOTS = 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Mark:
    """A point on a segment."""

    segment: int
    anchor: Anchor


class Marks:
    """The marked points, by slot, first and second."""

    def __init__(self) -> None:
        self.changed = Signal()
        self.slots: tuple[Mark | None, Mark | None] = (None, None)

    @property
    def known(self) -> list[Mark]:
        """Those that there are."""
        return [mark for mark in self.slots if mark is not None]

    @property
    def segments(self) -> tuple[int | None, ...]:
        """The segments, by slot."""
        return tuple(None if mark is None else mark.segment for mark in self.slots)

    def put(self, slot: int, mark: Mark | None) -> None:
        """Another mark, or none, in a slot."""
        first, second = (mark if number == slot else each for number, each in enumerate(self.slots))
        self.slots = first, second
        self.changed()

    def add(self, mark: Mark) -> None:
        """Put it into the first empty slot; where both are taken it is the first of the next two."""
        if len(self.known) == _SLOTS:
            self.forget()
        self.put(self.slots.index(None), mark)

    def clear(self) -> None:
        """Mark nothing any more."""
        self.forget()
        self.changed()

    def forget(self) -> None:
        """Mark nothing, and tell nobody: for who tells of more than this."""
        self.slots = (None, None)


def segment_frames(motions: Motions) -> dict[int, tuple[int, int]]:
    """Each segment's first and last frame."""
    seen = motions.observed & (motions.segment != NOISE)
    segment, frame = motions.segment[seen], motions.frame[seen]
    order = np.lexsort((frame, segment))
    number, first = np.unique(segment[order], return_index=True)
    last = np.append(first[1:], len(order)) - 1
    return {
        int(each): (int(a), int(b)) for each, a, b in zip(number, frame[order][first], frame[order][last], strict=True)
    }


def mark_at(motions: Motions, row: int) -> Mark | None:
    """A mark at a row of the motions; at a completed one, which no picture shows, on its segment; None on noise."""
    segment = int(motions.segment[row])
    if motions.observed[row] and segment != NOISE:
        return _mark(motions, row)
    return mark_on(motions, segment)


def mark_on(motions: Motions, segment: int) -> Mark | None:
    """A mark amid a segment: in the middle of its time, near the mean of its points; None where it has none."""
    rows = np.flatnonzero(motions.observed & (motions.segment == segment))
    if segment == NOISE or not len(rows):
        return None
    frames = np.sort(motions.frame[rows])
    rows = rows[motions.frame[rows] == frames[len(frames) // 2]]
    points = motions.position[rows].astype(np.float64)
    return _mark(motions, int(rows[np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()]))


def _mark(motions: Motions, row: int) -> Mark:
    column, line = motions.column_row[row].tolist()
    segment = int(motions.segment[row])
    return Mark(
        segment=segment,
        anchor=Anchor(frame=int(motions.frame[row]), column=round(column, 2), row=round(line, 2), segment=segment),
    )
