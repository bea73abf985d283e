"""Motions that merge and split: something small is caught, carried along, and thrown.

The paper leaves it open: to it a caught ball ends, or was always a part of who caught it. Here both keep their numbers,
and the moment is told in which they become one, or two.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from algorithm.trajectories import Trajectories
from recording.motions import Event

_TOUCH_M = 0.15
"""So near one another are the points of what is held and of who holds it."""
_APART_M, _ASTRAY_M = 0.3, 0.8
"""So far away it is at some time before it is caught, or after it is thrown, and so far it goes about who holds it: no
part of a body does both, not even where what lies between is hidden."""
_TOGETHER_M_PER_S = 1.0
"""What is held moves about the part of the body next to it slower than this."""
_NEXT_M = 0.3
"""That part reaches so far."""
_LARGEST_M, _SHARE = 0.6, 0.5
"""What is held is no larger than this, nor than this share of who holds it."""
_HOLE_SECONDS = 0.1
"""What is out of sight for longer may have changed hands meanwhile."""
_HOLD_SECONDS = 0.2
"""What stays in touch for so long is held; what passes by is not."""
_SPEED_SECONDS = 0.1
"""Speeds are measured over this time."""
_LEAST_FRAMES = 3
"""Of what is free in between."""
_FREE = -1


@dataclass(frozen=True, kw_only=True, eq=False)
class Thing:
    """The points of a motion, frame by frame."""

    trajectories: Trajectories
    """Everybody's."""
    first: int
    rows: tuple[Int[np.ndarray, "_"], ...]
    """Its own of them in each frame from the first on."""
    extent: float
    """Median over frames of the largest extent, metres."""
    low: Float[np.ndarray, "3"]
    """Corner of the box that it never leaves, metres."""
    high: Float[np.ndarray, "3"]

    @property
    def last(self) -> int:
        """The last frame with a point."""
        return self.first + len(self.rows) - 1

    def at(self, frame: int) -> Float[np.ndarray, "point 3"]:
        """Its points in any frame, world axes, metres; none where nothing is seen."""
        inside = self.first <= frame <= self.last
        return self.trajectories.position[self.rows[frame - self.first]] if inside else np.zeros((0, 3))

    def steps(self, frame: int) -> Float[np.ndarray, "point 3"]:
        """Their displacements from a frame with points to the next; NaN where a point is not followed."""
        number, position = self.trajectories.trajectory, self.trajectories.position
        rows = self.rows[frame - self.first]
        onward = np.minimum(rows + 1, len(number) - 1)
        goes_on = (onward > rows) & (number[onward] == number[rows])
        return np.where(goes_on[:, None], position[onward] - position[rows], np.nan)

    def step(self, frame: int) -> Float[np.ndarray, "3"]:
        """Its mean displacement from a frame with points to the next; NaN where nothing is followed."""
        return _mean(self.steps(frame))

    def may_touch(self, other: "Thing") -> bool:
        """Whether it could be in touch with the other one for all that their boxes say, or would be a frame later."""
        reach = _TOUCH_M + self.high - self.low
        return bool(np.all((self.low - reach <= other.high) & (other.low <= self.high + reach)))


@dataclass(frozen=True, kw_only=True)
class Clock:
    """The recording's frames."""

    fps: float
    frames: int

    def lasting(self, seconds: float) -> int:
        """The number of frames, one at the least."""
        return max(1, round(seconds * self.fps))


@dataclass(frozen=True, kw_only=True, eq=False)
class Contact:
    """One thing beside a larger one, in the frames of a stretch."""

    gap: Float[np.ndarray, "moment"]
    """Between their nearest points, metres; infinite where one of them is not seen."""
    speed: Float[np.ndarray, "moment"]
    """About the points next to it, metres a second; NaN where it is not known."""
    beside: Float[np.ndarray, "moment 3"]
    """Its centre's place about the larger one, metres, but for a constant."""


def things(trajectories: Trajectories, motion: Int[np.ndarray, "trajectory"]) -> tuple[Thing, ...]:
    """The points of every motion; trajectories of motion -1 are nobody's."""
    order = np.argsort(motion, kind="stable")
    bounds = np.searchsorted(motion[order], np.arange(int(motion.max(initial=-1)) + 2)).tolist()
    return tuple(_thing(trajectories, order[begin:end]) for begin, end in pairwise(bounds))


def events_between(every: Sequence[Thing], clock: Clock) -> tuple[Event, ...]:
    """The moments in which a small thing is caught by a larger one, or leaves it, in order of time.

    A thing is *held* while for 0.2 s at least it touches a larger one (15 cm) and moves with the part of it that is
    next to it. It is also held where it comes into sight, or is lost, in touch with a larger one that is seen on: the
    hand hides it, or it counts as a part of who holds it. A merge leads from being free to being held, a split back.
    What is free has been 30 cm away, and goes 80 cm about who holds it. So somebody who vanishes behind somebody else,
    and a ball that flies by, make no event.
    """
    found = [
        event
        for number, thing in enumerate(every)
        if thing.extent <= _LARGEST_M
        for event in _events(number, every, clock)
    ]
    return tuple(sorted(found, key=lambda event: event.frame))


def _thing(trajectories: Trajectories, members: Int[np.ndarray, "member"]) -> Thing:
    length = trajectories.length[members]
    begin = trajectories.first_row[members] - (np.cumsum(length) - length)
    rows = (np.arange(length.sum()) + np.repeat(begin, length)).astype(np.int32)
    frame, position = trajectories.frame[rows], trajectories.position[rows]
    order = np.argsort(frame, kind="stable")
    first = int(frame.min())
    bounds = np.searchsorted(frame[order], np.arange(first, int(frame.max()) + 2)).tolist()
    parts = [order[begin:end] for begin, end in pairwise(bounds)]
    extents = [np.ptp(position[part], axis=0).max() for part in parts if len(part)]
    return Thing(
        trajectories=trajectories,
        first=first,
        rows=tuple(rows[part] for part in parts),
        extent=float(np.median(extents)),
        low=position.min(axis=0),
        high=position.max(axis=0),
    )


def _events(number: int, every: Sequence[Thing], clock: Clock) -> Iterator[Event]:
    """The events of one small thing."""
    thing = every[number]
    larger = [
        other
        for other, holder in enumerate(every)
        if thing.extent <= _SHARE * holder.extent
        and holder.first <= thing.last + 1
        and holder.last >= thing.first - 1
        and thing.may_touch(holder)
    ]
    for stretch in _stretches(thing, clock.lasting(_HOLE_SECONDS)) if larger else []:
        contacts = [_contact(thing, every[other], stretch, clock) for other in larger]
        held = _held(contacts, clock)
        bounds = [0, *(np.flatnonzero(np.diff(held)) + 1).tolist(), len(stretch)]
        for begin, end in pairwise(bounds):
            if held[begin] != _FREE or end - begin < _LEAST_FRAMES:
                continue
            before = held[begin - 1] if begin else _seized(thing, every, larger, int(stretch[0]), -1, clock)
            after = held[end] if end < len(stretch) else _seized(thing, every, larger, int(stretch[-1]), 1, clock)
            if before != _FREE and _apart(contacts[before], begin, end):
                yield Event(kind="split", frame=int(stretch[begin]), motions=(number, larger[before]))
            if after != _FREE and _apart(contacts[after], begin, end):
                yield Event(kind="merge", frame=int(stretch[end - 1]) + 1, motions=(number, larger[after]))


def _stretches(thing: Thing, hole: int) -> list[Int[np.ndarray, "moment"]]:
    """The frames with points, parted where more than `hole` frames in a row have none."""
    seen = thing.first + np.flatnonzero([len(rows) > 0 for rows in thing.rows])
    return np.split(seen, np.flatnonzero(np.diff(seen) > hole + 1) + 1)


def _contact(thing: Thing, holder: Thing, stretch: Int[np.ndarray, "moment"], clock: Clock) -> Contact:
    gap, drift = np.full(len(stretch), np.inf), np.full((len(stretch), 3), np.nan)
    onward = np.zeros((len(stretch), 3))
    for moment, frame in enumerate(stretch.tolist()):
        points, others = thing.at(frame), holder.at(frame)
        if not len(others):
            continue
        distance, _ = cKDTree(points).query(others)
        gap[moment] = distance.min()
        onward[moment] = np.nan_to_num(holder.step(frame))
        next_to = distance <= _NEXT_M
        if next_to.any():
            drift[moment] = thing.step(frame) - _mean(holder.steps(frame)[next_to])
    span = clock.lasting(_SPEED_SECONDS)
    speed = [np.linalg.norm(_mean(drift[max(0, m - span) : m + span])) for m in range(len(stretch))]
    centre = np.array([thing.at(frame).mean(axis=0) for frame in stretch.tolist()])
    beside = centre - (np.cumsum(onward, axis=0) - onward)
    return Contact(gap=gap, speed=np.array(speed) * clock.fps, beside=beside)


def _held(contacts: Sequence[Contact], clock: Clock) -> Int[np.ndarray, "moment"]:
    """Who holds the thing in each moment, as a number of the contacts; -1 where nobody does."""
    together = np.array([(each.gap <= _TOUCH_M) & (each.speed <= _TOGETHER_M_PER_S) for each in contacts])
    gap = np.where(together, np.array([each.gap for each in contacts]), np.inf)
    held = np.where(together.any(axis=0), np.argmin(gap, axis=0), _FREE)
    bounds = [0, *(np.flatnonzero(np.diff(held)) + 1).tolist(), len(held)]
    for begin, end in pairwise(bounds):
        if end - begin < clock.lasting(_HOLD_SECONDS):
            held[begin:end] = _FREE
    return held


def _seized(thing: Thing, every: Sequence[Thing], larger: Sequence[int], frame: int, onward: int, clock: Clock) -> int:
    """Who holds the thing beyond the end (`onward` 1) or the beginning (-1) of a stretch, as it stands in `larger`.

    It is lost in touch, or would have been a frame later, and who touches it is seen on for 0.2 s; -1 for nobody.
    """
    hold = clock.lasting(_HOLD_SECONDS)
    if not hold <= frame < clock.frames - hold:
        return _FREE
    before = frame - max(onward, 0)
    step = thing.step(before) if len(thing.at(before)) else np.full(3, np.nan)
    gaps = [np.inf] * len(larger)
    for place, other in enumerate(larger):
        holder = every[other]
        if len(holder.at(frame + onward * hold)):
            drawn_out = _gap(thing.at(frame) + onward * np.nan_to_num(step), holder.at(frame + onward))
            gaps[place] = min(_gap(thing.at(frame), holder.at(frame)), drawn_out)
    nearest = int(np.argmin(gaps))
    return nearest if gaps[nearest] <= _TOUCH_M else _FREE


def _apart(contact: Contact, begin: int, end: int) -> bool:
    """Whether the thing is free of the larger one from one moment to before another."""
    gap = contact.gap[begin:end]
    farthest = np.max(gap[np.isfinite(gap)], initial=0.0)
    astray = np.linalg.norm(contact.beside[end - 1] - contact.beside[begin])
    return bool(farthest >= _APART_M and astray >= _ASTRAY_M)


def _gap(one: Float[np.ndarray, "point 3"], other: Float[np.ndarray, "another 3"]) -> float:
    """The distance of the nearest two points, metres; infinite where one has none."""
    return float(cKDTree(one).query(other)[0].min()) if len(one) and len(other) else np.inf


def _mean(steps: Float[np.ndarray, "step 3"]) -> Float[np.ndarray, "3"]:
    """The mean of the known ones; NaN where none is."""
    known = np.isfinite(steps[:, 0])
    return np.asarray(steps[known].mean(axis=0)) if known.any() else np.full(3, np.nan)
