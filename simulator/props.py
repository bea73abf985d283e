"""The schema of what somebody carries or wears: it follows the body and counts as part of the person.

Lengths are metres.
"""

from typing import Annotated, Literal

from pydantic import Field

from recording.checks import Frozen

Side = Literal["left", "right"]
Extent = Annotated[float, Field(gt=0, le=1)]
Height = Annotated[float, Field(gt=0, le=0.5)]


class Umbrella(Frozen):
    """Held above the head by one arm: the upper arm forward, the forearm up; it does not swing."""

    kind: Literal["umbrella"]
    side: Side = "right"
    """Whose hand holds it."""
    radius: Extent = 0.5
    """From the shaft to the rim, metres."""
    depth: Height = 0.18
    """From the rim up to the top, metres."""


class Suitcase(Frozen):
    """It hangs from a hand, beside the leg; the arm is straight and does not swing."""

    kind: Literal["suitcase"]
    side: Side = "right"
    """Whose hand holds it."""
    size: tuple[Extent, Extent, Height] = (0.5, 0.18, 0.36)
    """Along the walk, across it, and up, metres."""


class Coat(Frozen):
    """Worn open at the bottom, round torso, thighs and arms."""

    kind: Literal["coat"]
    hem: Annotated[float, Field(ge=0.2, le=0.7)] = 0.4
    """Height of its lower edge above the ground while the wearer stands, metres."""
    flare: Annotated[float, Field(ge=0, le=0.4)] = 0.16
    """By how much farther out it is at the hem than round the hips, metres."""
    loose: Annotated[float, Field(gt=0, le=0.15)] = 0.04
    """Between the coat and the body, metres."""


Prop = Annotated[Umbrella | Suitcase | Coat, Field(discriminator="kind")]


def check_props(props: tuple[Prop, ...]) -> None:
    """Raise unless one body can have them all: one thing a hand, and one coat."""
    places = [prop.kind if isinstance(prop, Coat) else f"{prop.side} hand" for prop in props]
    twice = next((place for place in places if places.count(place) > 1), None)
    if twice is not None:
        raise ValueError(f"expected one thing at the most for each hand and one coat, got two for the {twice}")
