"""Where on a face a ray from the camera's centre meets it, in float64.

Depth and material point follow from the face alone, so whatever chose the face has no say in their precision.
"""

import numpy as np
from jaxtyping import Float64


def weight_from_ray(corners: Float64[np.ndarray, "face 3 3"]) -> Float64[np.ndarray, "face 3 3"]:
    """For each face with corners A, B, C in camera axes: the rows B x C, C x A, A x B.

    Where a ray from the camera's centre meets the face's plane, the corners' weights are proportional to
    these rows' products with the ray (Cramer's rule for ray = a A + b B + c C).
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)


def met_weights(
    rays: Float64[np.ndarray, "hit 3"],
    weights_from_rays: Float64[np.ndarray, "hit 3 3"],
    corners: Float64[np.ndarray, "hit 3 3"],
) -> Float64[np.ndarray, "hit 3"]:
    """The weights of the corners A, B, C in the point of the face that the ray meets: none negative, sum 1.

    A ray caster in float32 may choose a face that the exact ray misses by a rounding: the face's point
    nearest to the ray is met. Seen edge-on that may be far from where the ray meets the face's plane.
    """
    weights = np.einsum("hij,hj->hi", weights_from_rays, rays)
    with np.errstate(divide="ignore", invalid="ignore"):  # Exactly edge-on they sum to 0.
        weights /= weights.sum(axis=1, keepdims=True)
    missed = np.flatnonzero(~(weights >= 0).all(axis=1))
    weights[missed] = _nearest_edge_weights(rays[missed], corners[missed])
    return weights


def _nearest_edge_weights(
    rays: Float64[np.ndarray, "hit 3"], corners: Float64[np.ndarray, "hit 3 3"]
) -> Float64[np.ndarray, "hit 3"]:
    """The weights of the corners in the point of the face's three edges that is nearest to the ray."""
    forward = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    beside = corners - np.einsum("hci,hi->hc", corners, forward)[..., None] * forward[:, None]
    edge = np.roll(beside, -1, axis=1) - beside  # A to B, B to C, C to A, as seen along the ray.
    square_length = np.maximum((edge**2).sum(axis=-1), np.finfo(np.float64).tiny)
    share = np.clip(-(beside * edge).sum(axis=-1) / square_length, 0.0, 1.0)
    miss = np.linalg.norm(beside + share[..., None] * edge, axis=-1)
    start, hit = miss.argmin(axis=1), np.arange(len(rays))
    weights = np.zeros((len(rays), 3))
    weights[hit, start] = 1.0 - share[hit, start]
    weights[hit, (start + 1) % 3] = share[hit, start]
    return weights
