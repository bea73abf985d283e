"""Axes that turn with a path, so that what moves along it is seen from beside."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from algorithm.representative import Curve

_SMOOTH_SECONDS = 0.3
"""A path sways with the steps; its heading does not."""
_SLOW_SHARE = 0.25
"""Below this share of the median speed the heading is that of before and after."""


def body_axes(curve: Curve, *, fps: float) -> Float[np.ndarray, "moment 3 3"]:
    """Rotations world_from_body that turn with the path and nothing more, the identity at its first moment.

    They are the rotation-minimising ones: from moment to moment the least rotation that takes heading to heading
    [Bishop, American Mathematical Monthly 1975]. So nothing needs to know which way is up, and a mirrored world
    gives mirrored axes. A straight path, or none, turns nothing.
    """
    heading = _headings(curve, fps)
    axes = [np.eye(3)]
    for before, after in pairwise(heading):
        axes.append(_least_rotation(before, after) @ axes[-1])
    return np.array(axes)


def _headings(curve: Curve, fps: float) -> Float[np.ndarray, "moment 3"]:
    """The smoothed unit direction of the path at every moment."""
    if len(curve.position) < 2:
        return np.tile([1.0, 0.0, 0.0], (len(curve.position), 1))
    smooth = gaussian_filter1d(curve.position, _SMOOTH_SECONDS * fps, axis=0, mode="nearest")
    step = np.gradient(smooth, axis=0)
    size = np.linalg.norm(step, axis=1)
    moves = np.flatnonzero(size > max(_SLOW_SHARE * float(np.median(size)), 1e-9))
    if not len(moves):
        return np.tile([1.0, 0.0, 0.0], (len(size), 1))
    direction = step[moves] / size[moves, None]
    moment = np.arange(len(size))
    known = np.stack([np.interp(moment, moves, direction[:, axis]) for axis in range(3)], axis=1)
    heading = gaussian_filter1d(known, _SMOOTH_SECONDS * fps, axis=0, mode="nearest")
    return heading / np.maximum(np.linalg.norm(heading, axis=1, keepdims=True), 1e-9)


def _least_rotation(before: np.ndarray, after: np.ndarray) -> Float[np.ndarray, "3 3"]:
    """The rotation by the smallest angle that takes one unit vector to the other; opposite ones turn nothing."""
    cosine = float(before @ after)
    if cosine < -0.999:
        return np.eye(3)
    x, y, z = np.cross(before, after)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + cross + cross @ cross / (1.0 + cosine)
