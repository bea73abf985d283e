"""The dial: how much of a random scene's people shall be hidden, for how long and by what.

A moving object is *hidden* in a frame in which under 20 % of its unoccluded pixels are seen; a *hole* is a maximal run
of hidden frames between two frames in which it is seen (`recording.visibility`). What has come of a wish stands in
every recording (`recording.occlusion`).
"""

from typing import Annotated, Literal

from pydantic import Field

from recording.checks import Frozen

By = Literal["people", "obstacles", "both", "anything"]


class OcclusionWish(Frozen):
    """What is wanted of a random scene's holes."""

    hole_frames: Annotated[float, Field(ge=2)]
    """The median length of a hole, frames."""
    spread: Annotated[float, Field(ge=0.05, le=1)] = 0.25
    """Standard deviation of the logarithm of the lengths: two thirds lie within a factor of exp(spread)."""
    hidden_share: Annotated[float, Field(gt=0, lt=1)] | None = None
    """Share of the object-frames in view in which the object is hidden; by default it does not matter."""
    by: By = "anything"
    """What hides: other people, obstacles, each of them at least a quarter of the time (`both`), or whatever does."""
