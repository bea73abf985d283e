"""Two bones that reach for a place: where the joint between them goes, and how bones turn to lie along directions."""

import numpy as np
from jaxtyping import Float

Directions = Float[np.ndarray, "moment 3"]
Rotations = Float[np.ndarray, "moment 3 3"]


def middle_joint(root: Directions, end: Directions, lengths: tuple[float, float], *, towards: Directions) -> Directions:
    """Where the elbow or knee of a limb is, metres: as far as may be `towards` a direction from the limb's line.

    NaN where the end is out of reach: farther than both bones are long, or nearer than their difference.
    """
    first, second = lengths
    reach = end - root
    distance = np.linalg.norm(reach, axis=-1, keepdims=True)
    along = (first**2 - second**2 + distance**2) / (2 * distance)
    with np.errstate(invalid="ignore"):
        aside = np.sqrt(first**2 - along**2)
    line = reach / distance
    return np.asarray(root + along * line + aside * across(towards, line))


def across(direction: Directions, line: Directions) -> Directions:
    """The part of the direction that is orthogonal to the line, of length 1; the line has length 1."""
    part = direction - np.sum(direction * line, axis=-1, keepdims=True) * line
    return np.asarray(part / np.linalg.norm(part, axis=-1, keepdims=True))


def turns(rest: tuple[np.ndarray, np.ndarray], goal: tuple[Directions, Directions]) -> Rotations:
    """The rotations that take the first rest direction to the first goal, the second as near to its own as can be."""
    return _axes(*goal) @ np.swapaxes(_axes(rest[0][None], rest[1][None]), -1, -2)


def _axes(first: Directions, second: Directions) -> Rotations:
    """Right-handed axes: the first direction, the second made orthogonal to it, and what stands on both."""
    line = first / np.linalg.norm(first, axis=-1, keepdims=True)
    side = across(second, line)
    return np.stack([line, side, np.cross(line, side)], axis=-1)
