"""Where on a face a ray from the camera's centre meets it, in float64.

Depth and material point follow from the face alone, so whatever chose the face has no say in their precision.
"""

import numpy as np
from jaxtyping import Float64


def met_points(
    rays: Float64[np.ndarray, "2 hit"], corners: Float64[np.ndarray, "3 3 hit"]
) -> tuple[Float64[np.ndarray, "hit"], Float64[np.ndarray, "hit"], Float64[np.ndarray, "hit"]]:
    """The depth, and the weights of the corners B and C, of the point of each face that its ray meets.

    Rays are (x, y) for the direction (x, y, 1); `corners` are x, y and z, each of A, B and C, in camera axes.
    Slid along the ray to depth 0, the corners are a triangle around the origin: each weighs as much as the
    triangle that the origin makes with the two others (Cramer's rule; nothing is divided by a depth).

    A ray caster in float32 may choose a face that the exact ray misses by a rounding: the face's point
    nearest to the ray is met. Seen edge-on that may be far from where the ray meets the face's plane.
    """
    depth = corners[2]
    x, y = corners[0] - depth * rays[0], corners[1] - depth * rays[1]
    weights = np.stack([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]])
    with np.errstate(divide="ignore", invalid="ignore"):  # Exactly edge-on they sum to 0.
        weights /= weights[0] + weights[1] + weights[2]
    missed = np.flatnonzero(~(weights >= 0).all(axis=0))
    if len(missed):
        weights[:, missed] = _nearest_edge_weights(rays[:, missed].T, corners[:, :, missed].T)
    return (weights * depth).sum(axis=0), weights[1], weights[2]


def _nearest_edge_weights(
    rays: Float64[np.ndarray, "hit 2"], corners: Float64[np.ndarray, "hit 3 3"]
) -> Float64[np.ndarray, "3 hit"]:
    """The weights of the corners in the point of the face's three edges that is nearest to the ray."""
    forward = np.concatenate([rays, np.ones((len(rays), 1))], axis=1)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    beside = corners - np.einsum("hci,hi->hc", corners, forward)[..., None] * forward[:, None]
    edge = np.roll(beside, -1, axis=1) - beside  # A to B, B to C, C to A, as seen along the ray.
    square_length = np.maximum((edge**2).sum(axis=-1), np.finfo(np.float64).tiny)
    share = np.clip(-(beside * edge).sum(axis=-1) / square_length, 0.0, 1.0)
    miss = np.linalg.norm(beside + share[..., None] * edge, axis=-1)
    start, hit = miss.argmin(axis=1), np.arange(len(rays))
    weights = np.zeros((3, len(rays)))
    weights[start, hit] = 1.0 - share[hit, start]
    weights[(start + 1) % 3, hit] = share[hit, start]
    return weights
