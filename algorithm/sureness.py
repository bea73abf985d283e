"""How sure a completed place is: the probability that it is off by less than 16 cm."""

import numpy as np
from jaxtyping import Float, Int

from algorithm.trajectories import Trajectories

_JOINED, _ALONE = 3.0, 3.1
"""Log-odds beside the seen end, of places between two trajectories and of those that only one leads to."""
_PER_SECOND = 0.4
"""Log-odds lost for each second to the nearest seen end."""
_PER_COST = 0.5
"""Log-odds lost where the two sides of a join agree no better than the gate asks for."""
_SHORT = 0.6
"""Log-odds lost for a trajectory of one second; twice as many for one half as long."""
_WITHOUT_GAIT = 0.6
"""Log-odds lost where no gait was found."""
_LEAST_SECONDS = 0.25
"""Shorter trajectories count as so long."""


def sureness(
    trajectories: Trajectories,
    ends: tuple[Int[np.ndarray, "place"], Int[np.ndarray, "place"]],
    frame: Int[np.ndarray, "place"],
    *,
    cost: Float[np.ndarray, "place"],
    has_gait: bool,
    fps: float,
) -> Float[np.ndarray, "place"]:
    """The probability that each place is off by less than 16 cm, by a logistic formula fitted on development seeds.

    It falls with the time to the nearest seen end, with how badly the two sides of a join agree (`cost`, share of
    the gate; NaN where a place has one side only), and is less for short trajectories and without a gait.
    """
    known, length = features(trajectories, ends, frame, fps=fps)
    joined = ~np.isnan(cost)
    odds = np.where(joined, _JOINED, _ALONE) - _PER_SECOND * known - _SHORT / length
    odds -= _PER_COST * np.where(joined, cost, 0.0) + (0.0 if has_gait else _WITHOUT_GAIT)
    return 1.0 / (1.0 + np.exp(-odds))


def features(
    trajectories: Trajectories,
    ends: tuple[Int[np.ndarray, "place"], Int[np.ndarray, "place"]],
    frame: Int[np.ndarray, "place"],
    *,
    fps: float,
) -> tuple[Float[np.ndarray, "place"], Float[np.ndarray, "place"]]:
    """Seconds to the nearest seen end of each place, and seconds that the trajectories it hangs on were seen."""
    before, after = ends
    first, last, length = trajectories.first_frame, trajectories.last_frame, trajectories.length
    outside = np.minimum(np.abs(frame - last[before]), np.abs(frame - first[after]))
    seen = np.where(before == after, length[before], length[before] + length[after])
    return outside / fps, np.maximum(seen / fps, _LEAST_SECONDS)
