"""How much of a recording is hidden, for how long and by what: as `recording.json` and a manifest state it.

Hidden, in view and hole are meant as in `recording.visibility`.
"""

from typing import Any

from pydantic import NonNegativeFloat, NonNegativeInt

from recording.checks import Frozen


class Holes(Frozen):
    """The lengths of the holes of all moving objects, frames; what there is nothing of is None."""

    count: NonNegativeInt
    median: NonNegativeFloat | None = None
    lower_quartile: NonNegativeFloat | None = None
    upper_quartile: NonNegativeFloat | None = None
    longest: NonNegativeInt | None = None
    lengths: tuple[NonNegativeInt, ...]
    """Of all of them, ascending."""


class Hiders(Frozen):
    """The shares of the hidden object-frames by what hides most of the object there; they add up to 1."""

    people: NonNegativeFloat
    """Other people, jugglers too."""
    balls: NonNegativeFloat
    obstacles: NonNegativeFloat
    sensor: NonNegativeFloat
    """It shows, but more of it is lost to the sensor than anything covers."""


class Nearness(Frozen):
    """The smallest distances on the ground in all frames, metres; None where there is nothing to measure."""

    people: NonNegativeFloat | None = None
    """Between the centres of two people."""
    obstacles: NonNegativeFloat | None = None
    """From a person's centre to the outline of an obstacle; 0 inside it."""


class Achieved(Frozen):
    """What a recording has come to, measured in its pictures; an object-frame is a moving object in a frame."""

    object_frames: NonNegativeInt
    """How many there are with the object in view."""
    hidden_object_frames: NonNegativeInt
    """How many of these have the object hidden."""
    hidden_share: NonNegativeFloat | None = None
    """The one by the other; None where nothing is ever in view."""
    hole_frames: Holes
    by: Hiders | None = None
    """None where nothing is hidden."""
    clearance_m: Nearness


class Occlusion(Frozen):
    """What was wanted, if anything was, and what has come of it."""

    wanted: dict[str, Any] | None = None
    """As the random family states it."""
    achieved: Achieved
