"""Many crowds at once: who wants to walk where."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, kw_only=True, eq=False)
class Crowds:
    """Many crowds side by side, none of which knows of another; on the ground, metres.

    Where there are fewer people or discs in a crowd than in others, the rest is NaN.
    """

    starts: Float[np.ndarray, "crowd person 2"]
    """Where everybody is at first, already under way."""
    goals: Float[np.ndarray, "crowd person 2"]
    """Where everybody wants to pass; who is past it walks on. Whose goal is the start stands."""
    speeds: Float[np.ndarray, "crowd person"]
    """How fast everybody wants to walk, metres a second."""
    discs: Float[np.ndarray, "crowd disc 3"]
    """What stands in the way: x, y and radius; a wall is a row of discs."""
