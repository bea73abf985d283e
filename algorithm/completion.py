"""The hidden places of a motion's points: every point that was seen before or after gets its place."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from algorithm.faint import Stretch, faint_stretches
from algorithm.gait import Gait, found_gait
from algorithm.intra import Joins, aligned, bridged, joined
from algorithm.representative import Curve
from algorithm.settings import Settings
from algorithm.sureness import sureness
from algorithm.trajectories import Trajectories
from recording.motions import INTER, INTRA

_CHUNK = 200_000
"""Places at a time: bounds the memory."""


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
    """The probability that the place is off by less than 16 cm (`sureness`)."""
    joins: tuple[Int[np.ndarray, "join"], Int[np.ndarray, "join"]]
    """Pairs of trajectories that are one from now on."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Places:
    """Places between a trajectory that ends and one that begins; both are the same where the other is not known."""

    before: Int[np.ndarray, "place"]
    after: Int[np.ndarray, "place"]
    share: Float[np.ndarray, "place"]
    """0 at the end of the one, 1 at the beginning of the other."""
    frame: Int[np.ndarray, "place"]
    position: Float[np.ndarray, "place 3"]
    """In the axes of the trajectories that were completed."""
    cost: Float[np.ndarray, "place"]
    """Of the join, share of the gate; NaN where there is none."""


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

    Trajectories that go on as one another are joined (step 8). With `complete_unmatched`, a point that was last
    seen before the motion was hidden, or first seen after it, and found no partner goes with the representative as
    long as it is hidden. With `limb_swing` the gait is taken out first and put back in the end, so that limbs
    swing on while they are hidden; what has no gait goes with the representative as it is.
    """
    gait = found_gait(trajectories, curve, fps=fps, spacing_m=spacing_m) if settings.limb_swing else None
    calm, path = trajectories, curve
    if gait is not None:
        calm = gait.calmed(trajectories)
        path = Curve(first=curve.first, position=np.zeros_like(curve.position), points=curve.points)
    gate_m = settings.intra_gate * spacing_m
    alignment = aligned(calm, path, method=settings.alignment)
    joins = joined(calm, path, alignment, gate_m=gate_m, longest_frames=settings.longest_hole_seconds * fps)
    number, frame, position = bridged(calm, path, alignment, joins)
    parts = [_between(calm, joins, (number, frame, position), gate_m)]
    if settings.complete_unmatched:
        stretches = faint_stretches(curve, share=settings.faint_below, fps=fps)
        parts += _continued(calm, path, joins, stretches, round(settings.border_seconds * fps))
    return _completion(trajectories, segment, _stacked(parts), (joins, gait, curve, fps))


def _between(
    trajectories: Trajectories, joins: Joins, bridges: tuple[np.ndarray, np.ndarray, np.ndarray], gate_m: float
) -> _Places:
    """The places of joined trajectories."""
    number, frame, position = bridges
    before, after, cost = joins
    begin, end = trajectories.last_frame[before][number], trajectories.first_frame[after][number]
    return _Places(
        before=before[number],
        after=after[number],
        share=(frame - begin) / (end - begin),
        frame=frame,
        position=position,
        cost=cost[number] / gate_m,
    )


def _continued(
    trajectories: Trajectories, curve: Curve, joins: Joins, stretches: list[Stretch], border_frames: int
) -> list[_Places]:
    """The places in the stretches of the trajectories at their borders that found no partner.

    A trajectory is at the border if it ends at most `border_frames` before the stretch, or begins at most as many
    after it: a body takes that long to vanish behind an edge.
    """
    alone_end = np.ones(trajectories.count, bool)
    alone_end[joins[0]] = False
    alone_begin = np.ones(trajectories.count, bool)
    alone_begin[joins[1]] = False
    last_row = trajectories.first_row + trajectories.length - 1
    begin, end = trajectories.first_frame, trajectories.last_frame
    earlier = [-1, *(last for _, last in stretches)]  # A point enters the next stretch only, and left the last one.
    later = [*(first for first, _ in stretches), np.inf][1:]
    parts = []
    for (first, last), previous, following in zip(stretches, earlier, later, strict=False):
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
) -> _Places:
    """Trajectories carried along by the curve from the given rows: up to a last frame, or from a first one."""
    own = trajectories.frame[row[which]]
    begin = own + 1 if until[0] is None else np.full(len(which), until[0])
    end = own - 1 if until[1] is None else np.full(len(which), until[1])
    count = np.maximum(end - begin + 1, 0)
    index = np.repeat(np.arange(len(which)), count)
    frame = begin[index] + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    shift = trajectories.position[row[which]] - curve.position[own - curve.first]
    return _Places(
        before=which[index],
        after=which[index],
        share=np.zeros(len(frame)),
        frame=frame,
        position=curve.position[frame - curve.first] + shift[index],
        cost=np.full(len(frame), np.nan),
    )


def _stacked(parts: list[_Places]) -> _Places:
    """All places, one part after the other."""
    return _Places(
        before=np.concatenate([part.before for part in parts], dtype=np.int32),
        after=np.concatenate([part.after for part in parts], dtype=np.int32),
        share=np.concatenate([part.share for part in parts], dtype=np.float32),
        frame=np.concatenate([part.frame for part in parts], dtype=np.int32),
        position=np.concatenate([part.position for part in parts]),
        cost=np.concatenate([part.cost for part in parts], dtype=np.float32),
    )


def _completion(
    trajectories: Trajectories,
    segment: Int[np.ndarray, "trajectory"],
    places: _Places,
    made: tuple[Joins, Gait | None, Curve, float],
) -> Completion:
    """The places in world axes, swing included, and how sure they are."""
    joins, gait, curve, fps = made
    count = len(places.frame)
    position, confidence = np.empty((count, 3)), np.empty(count, np.float32)
    source = np.empty(count, np.int8)
    for begin in range(0, count, _CHUNK):
        part = slice(begin, begin + _CHUNK)
        before, after, frame, cost = places.before[part], places.after[part], places.frame[part], places.cost[part]
        position[part] = _swinging(places, part, gait)
        alone = np.isnan(cost) & ~curve.observed[frame - curve.first]
        source[part] = np.where((segment[before] != segment[after]) | alone, INTER, INTRA)
        confidence[part] = sureness(trajectories, (before, after), frame, cost=cost, has_gait=gait is not None, fps=fps)
    return Completion(
        trajectory=places.before,
        frame=places.frame,
        position=position,
        source=source,
        confidence=confidence,
        joins=(joins[0], joins[1]),
    )


def _swinging(places: _Places, part: slice, gait: Gait | None) -> Float[np.ndarray, "place 3"]:
    """Some of the places in world axes, swing included."""
    if gait is None:
        return places.position[part]
    frame, share = places.frame[part], places.share[part, None]
    swing = (1 - share) * gait.swing(places.before[part], frame) + share * gait.swing(places.after[part], frame)
    return gait.restored(places.position[part] + swing, frame)
