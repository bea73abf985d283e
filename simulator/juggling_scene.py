"""The schema of a juggler on a scene.

Lengths are metres, times seconds; what is in degrees says so in its name.
"""

from typing import Annotated

from pydantic import Field, field_validator, model_validator

from recording.checks import Frozen
from simulator.body_name import BodyName
from simulator.siteswap import check_siteswap
from simulator.things import Ground, Positive


class Juggler(Frozen):
    """Somebody who stands and juggles; the balls are objects of their own."""

    name: str | None = None
    """Shown in reports; `juggler 1` and so on where it is not given."""
    body: BodyName
    """A body in `scenes/assets`."""
    position: Ground = (0.0, 0.0)
    """Where the juggler stands (x, y), metres."""
    facing_deg: float = -90.0
    """Where the juggler looks: 0 along x, 90 along y, degrees."""
    siteswap: Annotated[tuple[int, ...], Field(min_length=1)]
    """How many beats after each throw its ball is thrown again; [3] is the cascade of three balls."""
    beat_s: Positive
    """From a throw of one hand to the next of the other, seconds."""
    dwell_s: Positive
    """How long a ball lies in the hand before each throw, seconds."""
    phase: float = Field(default=0.0, ge=0.0)
    """Beats since the first throw of the siteswap, the left hand's, at the first frame."""
    ball_radius: Positive = 0.05
    """Metres."""
    hand_height: Positive | None = None
    """Height of the balls' centres where hands throw and catch, metres; if not given, 0.25 arms below the
    shoulders, or higher where the arms would be too short for the scoop. An arm is the body's, shoulder to wrist."""
    reach: Positive | None = None
    """How far before the juggler's middle that is, metres; 0.6 arms if not given."""
    throw_width: Positive | None = None
    """Distance between where the left and the right hand throw, metres; 0.4 arms if not given."""
    catch_width: Positive | None = None
    """Distance between where the left and the right hand catch, metres; 1.05 arms if not given."""

    @field_validator("siteswap")
    @classmethod
    def _jugglable(cls, siteswap: tuple[int, ...]) -> tuple[int, ...]:
        check_siteswap(siteswap)
        return siteswap

    @model_validator(mode="after")
    def _time_to_fly(self) -> "Juggler":
        lowest = min(height for height in self.siteswap if height)
        if self.dwell_s >= min(lowest, 2) * self.beat_s:
            raise ValueError(
                f"expected 'dwell_s' below {min(lowest, 2) * self.beat_s:.3g}: 'beat_s' times {min(lowest, 2)}, "
                f"or else a ball has no time to fly or a hand no time to come back, not {self.dwell_s}"
            )
        return self
