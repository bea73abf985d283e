"""Juggling patterns: which hand throws which ball when, and where balls and hands are at every moment.

A siteswap names the height of each throw by the number of beats until the ball is thrown again (Buhler, Eisenbud,
Graham and Wright, "Juggling drops and descents", American Mathematical Monthly, 1994). Hands take turns, the left one
at even beats. A ball flies as gravity has it, and lies in the hand for the dwell time before each throw. A hand moves
with the ball's velocity where it catches and where it throws, and smoothly in between: a scoop below with the ball,
a swing above without it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int64

GRAVITY = 9.81
"""Metres a second squared."""
IN_THE_AIR = -1
"""The hand that holds a ball which none holds."""
_GENTLENESS = 0.25
"""How a hand reverses: at 1 evenly over the whole stroke, which takes the longest way; at 0 mostly at its ends."""

Place = Float[np.ndarray, "3"]
Places = Float[np.ndarray, "moment 3"]


@dataclass(frozen=True, kw_only=True)
class Throw:
    """One throw of a pattern that began with beat 0."""

    ball: int
    """Number of the ball, from 0 in the order of the first throws."""
    beat: int
    """When it is thrown; by the left hand where even."""
    height: int
    """After how many beats the ball is thrown again."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Juggling:
    """A pattern in time and space."""

    pattern: tuple[int, ...]
    """The siteswap, repeated for ever."""
    beat_s: float
    """Seconds between a hand's throw and the other's."""
    dwell_s: float
    """Seconds that a ball lies in a hand before each throw."""
    phase: float
    """Beats since the pattern's first throw, in which the left hand has its turn, at time 0."""
    throw_spots: Float[np.ndarray, "hand 3"]
    """Where the left and the right hand throw: the ball's centre, metres, z up."""
    catch_spots: Float[np.ndarray, "hand 3"]
    """Where they catch."""

    @property
    def balls(self) -> int:
        """How many balls there are: the mean of the pattern."""
        return sum(self.pattern) // len(self.pattern)

    def ball_places(self, times: Float[np.ndarray, "moment"]) -> Float[np.ndarray, "ball moment 3"]:
        """The balls' centres at the times, seconds, not before 0; metres, in the spots' axes."""
        clock = self._clock(times)
        hands = self.hand_places(times)
        places = np.full((self.balls, len(times), 3), np.nan)
        for throw in self._throws(clock):
            flying, held = self._flying(throw, clock), self._held(throw, clock)
            start, velocity = self._release(throw.beat)
            elapsed = (clock[flying] - throw.beat * self.beat_s)[:, None]
            places[throw.ball, flying] = start + velocity * elapsed - [0, 0, GRAVITY / 2] * elapsed**2
            places[throw.ball, held] = hands[_hand(throw.beat + throw.height), held]
        return places

    def holders(self, times: Float[np.ndarray, "moment"]) -> Int64[np.ndarray, "ball moment"]:
        """The hand that holds each ball, 0 the left, 1 the right; `IN_THE_AIR` for none."""
        clock = self._clock(times)
        holders = np.full((self.balls, len(times)), IN_THE_AIR)
        for throw in self._throws(clock):
            holders[throw.ball, self._held(throw, clock)] = _hand(throw.beat + throw.height)
        return holders

    def hand_places(self, times: Float[np.ndarray, "moment"]) -> Float[np.ndarray, "hand moment 3"]:
        """Where a ball's centre is, or would be, in each hand; seconds, metres, in the spots' axes."""
        clock = self._clock(times)
        places = np.full((2, len(times), 3), np.nan)
        last = int(np.floor(clock.max(initial=0.0) / self.beat_s)) + 3
        for beat in range(last):
            thrown, again = beat * self.beat_s, (beat + 2) * self.beat_s
            caught = again - self.dwell_s
            leave, meet, throw_again = self._release(beat), self._arrival(beat + 2), self._release(beat + 2)
            empty = (clock >= thrown) & (clock < caught)
            full = (clock >= caught) & (clock < again)
            hand = places[_hand(beat)]
            hand[empty] = _stroke(clock[empty] - thrown, caught - thrown, leave, meet)
            hand[full] = _stroke(clock[full] - caught, self.dwell_s, meet, throw_again)
        return places

    def _clock(self, times: Float[np.ndarray, "moment"]) -> Float[np.ndarray, "moment"]:
        """Seconds since beat 0, far enough behind for all balls to have been thrown once."""
        cycle = 2 * len(self.pattern)
        lead = cycle * (max(self.pattern) // cycle + 2)
        return np.asarray(times + (lead + self.phase) * self.beat_s)

    def _throws(self, clock: Float[np.ndarray, "moment"]) -> list[Throw]:
        return planned_throws(self.pattern, int(np.floor(clock.max(initial=0.0) / self.beat_s)) + 1)

    def _flying(self, throw: Throw, clock: np.ndarray) -> np.ndarray:
        caught = (throw.beat + throw.height) * self.beat_s - self.dwell_s
        return (clock >= throw.beat * self.beat_s) & (clock < caught)

    def _held(self, throw: Throw, clock: np.ndarray) -> np.ndarray:
        again = (throw.beat + throw.height) * self.beat_s
        return (clock >= again - self.dwell_s) & (clock < again)

    def _release(self, beat: int) -> tuple[Place, Place]:
        """Where a beat's hand throws, and with what velocity; that is 0 where it has nothing to throw."""
        height = self.pattern[beat % len(self.pattern)]
        start = self.throw_spots[_hand(beat)]
        if height == 0:
            return start, np.zeros(3)
        flight = height * self.beat_s - self.dwell_s
        way = self.catch_spots[_hand(beat + height)] - start
        return start, way / flight + [0, 0, GRAVITY * flight / 2]

    def _arrival(self, beat: int) -> tuple[Place, Place]:
        """Where the hand catches what it throws at the beat, and the ball's velocity there; 0 without a ball."""
        spot = self.catch_spots[_hand(beat)]
        heights = (height for height in set(self.pattern) if height and self._height(beat - height) == height)
        height = next(heights, None)
        if height is None:
            return spot, np.zeros(3)
        _, velocity = self._release(beat - height)
        return spot, velocity - [0, 0, GRAVITY * (height * self.beat_s - self.dwell_s)]

    def _height(self, beat: int) -> int:
        return self.pattern[beat % len(self.pattern)]


def check_siteswap(pattern: Sequence[int]) -> None:
    """Raise a ValueError unless the numbers can be juggled: at no beat two balls land, and there is a ball."""
    if any(height < 0 for height in pattern) or not any(pattern):
        raise ValueError("expected throws of 0 beats or more, and one of 1 or more")
    if sum(pattern) % len(pattern):
        mean = sum(pattern) / len(pattern)
        raise ValueError(f"expected throws whose mean is the number of balls, a whole one, not {mean:.3g}")
    landing: dict[int, int] = {}
    for beat, height in enumerate(pattern):
        other = landing.setdefault((beat + height) % len(pattern), beat)
        if other != beat:
            raise ValueError(f"expected one ball at a time, but throws {other + 1} and {beat + 1} come down together")


def planned_throws(pattern: Sequence[int], beats: int) -> list[Throw]:
    """The throws of the beats from 0 on, in their order; every ball is there once the highest throw has come down."""
    due: dict[int, int] = {}
    throws = []
    balls = 0
    for beat in range(beats):
        height = pattern[beat % len(pattern)]
        if height == 0:
            continue
        if beat in due:
            ball = due.pop(beat)
        else:
            ball, balls = balls, balls + 1
        throws.append(Throw(ball=ball, beat=beat, height=height))
        due[beat + height] = ball
    return throws


def _hand(beat: int) -> int:
    return beat % 2


def _stroke(
    elapsed: Float[np.ndarray, "moment"], duration: float, begin: tuple[Place, Place], end: tuple[Place, Place]
) -> Places:
    """A smooth way between two places with given velocities at both.

    With s from -1 to 1 over the duration, the velocity is even + odd: A + B s^2, which covers the distance, and
    D (g s + (1 - g) s^3), which turns the hand round; g is `_GENTLENESS`.
    """
    (start, leave), (goal, arrive) = begin, end
    half = duration / 2
    s = (elapsed / half - 1)[:, None]
    mean, turn = (leave + arrive) / 2, (arrive - leave) / 2
    speed = (goal - start) / duration
    bend = 1.5 * (mean - speed)
    steady = mean - bend
    covered = steady * (s + 1) + bend * (s**3 + 1) / 3
    turned = turn * (_GENTLENESS * (s**2 - 1) / 2 + (1 - _GENTLENESS) * (s**4 - 1) / 4)
    return np.asarray(start + half * (covered + turned))
