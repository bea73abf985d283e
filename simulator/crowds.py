"""Many crowds at once: who wants to walk where, and how near people came to one another."""

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


@dataclass(frozen=True, kw_only=True, eq=False)
class Clearances:
    """The smallest distances in each crowd, at the sampled moments, metres; infinite where nothing is to measure."""

    people_m: Float[np.ndarray, "crowd"]
    """Between the centres of two people."""
    discs_m: Float[np.ndarray, "crowd"]
    """From a person's centre to a disc's edge; negative inside."""


def clearances(walks: Float[np.ndarray, "crowd person time 2"], discs: Float[np.ndarray, "crowd disc 3"]) -> Clearances:
    """How near people come to one another and to discs in each crowd; NaN is nobody, and no disc."""
    first, second = np.triu_indices(walks.shape[1], k=1)
    between = np.linalg.norm(walks[:, first] - walks[:, second], axis=-1)
    centres, radii = discs[:, None, :, None, :2], discs[:, None, :, None, 2]
    beside = np.linalg.norm(walks[:, :, None] - centres, axis=-1) - radii
    return Clearances(people_m=_smallest(between), discs_m=_smallest(beside))


def _smallest(distances: Float[np.ndarray, "crowd ..."]) -> Float[np.ndarray, "crowd"]:
    """The smallest distance in each crowd; NaN does not count."""
    known = np.where(np.isnan(distances), np.inf, distances)
    return known.min(axis=tuple(range(1, known.ndim)), initial=np.inf)
