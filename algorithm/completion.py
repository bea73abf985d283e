"""The hidden places of a motion's points, by its representative: steps 8 and 9 brought to every trajectory."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from algorithm.intra import Joins, aligned, bridged, joined
from algorithm.representative import Curve
from algorithm.settings import Settings
from algorithm.trajectories import Trajectories
from recording.motions import INTER, INTRA


@dataclass(frozen=True, kw_only=True, eq=False)
class Completion:
    """Places that no one saw, of the trajectories of one motion."""

    trajectory: Int[np.ndarray, "place"]
    """The trajectory of the motion that each place continues."""
    frame: Int[np.ndarray, "place"]
    position: Float[np.ndarray, "place 3"]
    """World axes, metres."""
    source: Int[np.ndarray, "place"]
    """`INTRA` within a segment, `INTER` across a hole between two."""
    confidence: Float[np.ndarray, "place"]
    """1 for a join without a miss, 0 for one at the gate; not calibrated."""
    joins: tuple[Int[np.ndarray, "join"], Int[np.ndarray, "join"]]
    """Pairs of trajectories that are one from now on."""


def completed(
    trajectories: Trajectories,
    segment: Int[np.ndarray, "trajectory"],
    curve: Curve,
    *,
    settings: Settings,
    spacing_m: float,
    fps: float,
) -> Completion:
    """The missing places of the trajectories of one motion.

    Trajectories that go on as one another are joined (step 8). With `complete_unmatched`, a point that
    was last seen before a hole, or first seen after it, and found no partner follows the representative
    through the hole as well: the surface seen on either side goes with the motion.
    """
    gate_m = settings.intra_gate * spacing_m
    longest_frames = settings.longest_hole_seconds * fps
    alignment = aligned(trajectories, curve, method=settings.alignment)
    joins = joined(trajectories, curve, alignment, gate_m=gate_m, longest_frames=longest_frames)
    number, frame, position = bridged(trajectories, curve, alignment, joins)
    before, after, cost = joins
    source = np.where(segment[before] == segment[after], INTRA, INTER)[number]
    parts = [(before[number], frame, position, source, 1.0 - cost[number] / gate_m)]
    if settings.complete_unmatched:
        border_frames = round(settings.border_seconds * fps)
        parts += _continued_into_holes(trajectories, curve, joins, border_frames)
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return Completion(
        trajectory=columns[0],
        frame=columns[1],
        position=columns[2],
        source=columns[3],
        confidence=columns[4],
        joins=(before, after),
    )


Part = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def _continued_into_holes(trajectories: Trajectories, curve: Curve, joins: Joins, border_frames: int) -> list[Part]:
    """The places in holes of the trajectories at their borders that found no partner.

    A trajectory is at the border if it ends at most `border_frames` before the hole, or begins at most
    as many after it: a body takes that long to vanish behind an edge.
    """
    alone_end = np.ones(trajectories.count, bool)
    alone_end[joins[0]] = False
    alone_begin = np.ones(trajectories.count, bool)
    alone_begin[joins[1]] = False
    last_row = trajectories.first_row + trajectories.length - 1
    begin, end = trajectories.first_frame, trajectories.last_frame
    found = holes(curve)
    earlier = [-1, *(last for _, last in found)]  # A point enters the next hole only, and came out of the last one.
    later = [*(first for first, _ in found), np.inf][1:]
    parts = []
    for (first, last), previous, following in zip(found, earlier, later, strict=False):
        ended = alone_end & (end > previous) & (end >= first - border_frames) & (end < last)
        begun = alone_begin & (begin < following) & (begin <= last + border_frames) & (begin > first)
        parts.append(_carried(trajectories, curve, np.flatnonzero(ended), last_row, (None, last)))
        parts.append(_carried(trajectories, curve, np.flatnonzero(begun), trajectories.first_row, (first, None)))
    return parts


def _carried(
    trajectories: Trajectories,
    curve: Curve,
    which: Int[np.ndarray, "border"],
    row: Int[np.ndarray, "trajectory"],
    until: tuple[int | None, int | None],
) -> Part:
    """Trajectories carried along by the curve from the given rows: up to a last frame, or from a first one."""
    own = trajectories.frame[row[which]]
    begin = own + 1 if until[0] is None else np.full(len(which), until[0])
    end = own - 1 if until[1] is None else np.full(len(which), until[1])
    count = np.maximum(end - begin + 1, 0)
    index = np.repeat(np.arange(len(which)), count)
    frame = begin[index] + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    shift = trajectories.position[row[which]] - curve.position[own - curve.first]
    place = curve.position[frame - curve.first] + shift[index]
    return which[index], frame, place, np.full(len(frame), INTER), np.full(len(frame), 0.5)


def holes(curve: Curve) -> list[tuple[int, int]]:
    """First and last frame of every stretch of a motion that was completed."""
    hidden = np.concatenate([[False], ~curve.observed, [False]]).astype(int)
    begin, end = np.flatnonzero(np.diff(hidden) == 1), np.flatnonzero(np.diff(hidden) == -1)
    return [(curve.first + int(b), curve.first + int(e) - 1) for b, e in zip(begin, end, strict=True)]
