"""How sure a completed place is."""

import numpy as np
from jaxtyping import Float, Int

from algorithm.trajectories import Trajectories


def sureness(
    trajectories: Trajectories,
    ends: tuple[Int[np.ndarray, "place"], Int[np.ndarray, "place"]],
    frame: Int[np.ndarray, "place"],
    *,
    cost: Float[np.ndarray, "place"],
    has_gait: bool,
    fps: float,
) -> Float[np.ndarray, "place"]:
    """The probability that a place is off by less than 16 cm."""
    return np.where(np.isnan(cost), 0.5, 1.0 - np.nan_to_num(cost))
