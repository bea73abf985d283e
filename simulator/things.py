"""The schema of what is on a scene: people, balls, obstacles.

Lengths are metres, times seconds, speeds metres a second; what is in degrees says so in its name.
"""

from itertools import pairwise
from math import dist, inf
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from recording.checks import Frozen
from simulator.body_name import BodyName
from simulator.motion_file import Motion
from simulator.path import FASTEST_WALK
from simulator.props import Prop, Side, check_props

Positive = Annotated[float, Field(gt=0, le=1e6)]
Coordinate = Annotated[float, Field(ge=-1e5, le=1e5)]
"""Metres, as far as single precision tells points a centimetre apart."""
Ground = tuple[Coordinate, Coordinate]
Point = tuple[Coordinate, Coordinate, Coordinate]


class Person(Frozen):
    """Somebody who walks along a path, waits at its first way-point before and stands at its last after.

    Or somebody who does what was captured: then there is a `motion`, and no path.
    """

    name: str | None = None
    """Shown in reports; `person 1` and so on where it is not given."""
    body: BodyName
    """A body in `scenes/assets`."""
    waypoints: tuple[Ground, ...] = ()
    """Places on the ground (x, y) that are passed, metres: two make a straight line, more a smooth curve."""
    speed: Annotated[float, Field(gt=0, le=FASTEST_WALK)] | None = None
    """Metres a second, the same all along; or else `times`."""
    times: tuple[float, ...] | None = None
    """When each way-point is passed, seconds after `start`; or else `speed`."""
    start: float = 0.0
    """When the first way-point is left, seconds after the first frame; negative: already under way."""
    phase: float = 0.0
    """Where in the gait's cycle the first frame finds the walker, in cycles: at 0 and 1 the left foot comes down."""
    props: tuple[Prop, ...] = ()
    """What is carried or worn; it counts as part of the person."""
    motion: Motion | None = Field(default=None, exclude_if=lambda motion: motion is None)
    """A captured motion in place of a path; scenes without one are written as if there were no such key."""

    @field_validator("waypoints")
    @classmethod
    def _enough(cls, waypoints: tuple[Ground, ...]) -> tuple[Ground, ...]:
        if len(waypoints) == 1:
            raise ValueError("expected at least 2 way-points")
        return waypoints

    @model_validator(mode="after")
    def _path(self) -> "Person":
        check_props(self.props)
        if self.motion is not None:
            if self.waypoints or self.speed is not None or self.times is not None or self.start or self.phase:
                raise ValueError("expected 'motion' in place of way-points, 'speed', 'times', 'start' and 'phase'")
            return self
        if not self.waypoints:
            raise ValueError("expected 'waypoints' (or a 'trajectory' or a 'motion')")
        _check_timing(self.waypoints, self.speed, self.times)
        for (a, b), pace in zip(pairwise(self.waypoints), self._paces(), strict=True):
            if pace > FASTEST_WALK:
                raise ValueError(f"from {a} to {b} at {pace:.1f} m/s: people walk at {FASTEST_WALK} m/s at most")
        return self

    @property
    def top_speed(self) -> float:
        """The speed on the fastest stretch, metres a second; 0 where there is no path."""
        return max(self._paces(), default=0.0)

    def _paces(self) -> list[float]:
        lengths = [dist(a, b) for a, b in pairwise(self.waypoints)]
        if self.times is None:
            return [self.speed or 0.0] * len(lengths)
        return [
            length / (later - sooner) for length, (sooner, later) in zip(lengths, pairwise(self.times), strict=True)
        ]


class Held(Frozen):
    """A time in which a ball lies in somebody's hand; the arm is held out for it in all frames."""

    by: str
    """The name of one of the people."""
    side: Side = "right"
    """Whose hand it is."""
    begin: float | None = None
    """When it is caught, seconds after the first frame; from the beginning if not given."""
    end: float | None = None
    """When it is let go, seconds after the first frame; never if not given."""

    @property
    def span(self) -> tuple[float, float]:
        """From when till when, seconds after the first frame; infinite where it has no beginning or end."""
        return (-inf if self.begin is None else self.begin, inf if self.end is None else self.end)


class Ball(Frozen):
    """A ball whose centre follows straight lines between way-points, or flies, and may be caught on its way."""

    name: str | None = None
    """`ball 1` and so on where it is not given."""
    radius: Positive
    """Metres."""
    waypoints: tuple[Point, ...] = ()
    """Places of the centre, metres; two at the least, none are needed where it is `held`."""
    speed: Positive | None = None
    """Metres a second, the same all along; or else `times`."""
    times: tuple[float, ...] | None = None
    """When each way-point is passed, seconds after `start`; or else `speed`."""
    start: float = 0.0
    """When the first way-point is left, seconds after the first frame."""
    thrown: bool = Field(default=False, exclude_if=lambda thrown: not thrown)
    """Whether it flies from place to place as gravity has it; else it goes straight."""
    held: tuple[Held, ...] = Field(default=(), exclude_if=lambda held: not held)
    """When it lies in whose hand; in between it goes from hand to way-point to hand, each at its time."""

    @model_validator(mode="after")
    def _path(self) -> "Ball":
        if not self.held and len(self.waypoints) < 2:
            raise ValueError("expected at least 2 way-points")
        if self.held and self.speed is not None:
            raise ValueError("expected 'times' in place of 'speed', so that it is known when it meets the hand")
        if self.waypoints or not self.held:
            _check_timing(self.waypoints, self.speed, self.times)
        spans = [held.span for held in self.held]
        if any(end <= begin for begin, end in spans) or any(b[0] <= a[1] for a, b in pairwise(spans)):
            raise ValueError("expected times in hands that follow one another, each with its 'begin' before its 'end'")
        passed = [self.start + time for time in self.times or ()]
        if any(begin <= time <= end for begin, end in spans for time in passed):
            raise ValueError("expected way-points that are passed before it is caught or after it is let go")
        return self


class Obstacle(Frozen):
    """Something that stands still."""

    name: str | None = None
    """`box 1` and so on where it is not given."""
    shape: Literal["box", "cylinder", "cone"]
    size: tuple[Positive, Positive, Positive] | None = None
    """A box's extent along x, y and z before it is turned, metres."""
    radius: Positive | None = None
    """A cylinder's radius, or a cone's at its base, metres."""
    height: Positive | None = None
    """A cylinder's or cone's height, metres."""
    position: Point
    """The middle of its base, metres."""
    yaw_deg: float = 0.0
    """By how much it is turned about the vertical, from x towards y, degrees."""

    @model_validator(mode="after")
    def _measured(self) -> "Obstacle":
        wanted = ("size",) if self.shape == "box" else ("radius", "height")
        given = tuple(key for key in ("size", "radius", "height") if getattr(self, key) is not None)
        if given != wanted:
            raise ValueError(f"expected a {self.shape} to have {' and '.join(map(repr, wanted))}, no more, no less")
        return self


def _check_timing(
    waypoints: tuple[Ground, ...] | tuple[Point, ...], speed: float | None, times: tuple[float, ...] | None
) -> None:
    """Raise unless way-points and their timing go together."""
    if (speed is None) == (times is None):
        raise ValueError("expected either 'speed' or 'times'" + (", not both" if speed is not None else ""))
    if times is not None and len(times) != len(waypoints):
        raise ValueError(f"expected one of 'times' for each of the {len(waypoints)} way-points, not {len(times)}")
    if times is not None and any(later <= sooner for sooner, later in pairwise(times)):
        raise ValueError("expected 'times' that grow from way-point to way-point")
    if times is None and any(a == b for a, b in pairwise(waypoints)):
        raise ValueError("expected way-points that differ from the one before (to wait, give 'times')")
