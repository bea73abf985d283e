"""The ground, and what lies below it: the largest plane, found by RANSAC, also when the sensor makes it wobble."""

from dataclasses import dataclass
from itertools import islice

import numpy as np
from jaxtyping import Bool, Float, Float32
from sklearn.linear_model import LinearRegression, RANSACRegressor

from importing.source import DepthSource
from recording.camera import Camera, pixel_grid
from recording.errors import InputError
from recording.over_time import wobble_m
from recording.progress import tracked

_FRAMES_FOR_MEDIAN = 31
_PIXELS_FOR_PLANE = 20_000
_WITHIN = 0.02
"""A point lies on the plane if its distance from it is below this share of the camera's own."""
_LEAST_SHARE = 0.1
"""A plane with a smaller share of the returns is no ground."""
_STEEPEST_DEG = 30.0
"""So far from level the ground may be where it is known which way is up."""
_CLEARANCE_M = 0.05
"""What is no higher above the plane than this is ground, metres."""
_LEAST_PIXELS = 50


@dataclass(frozen=True, kw_only=True, eq=False)
class Ground:
    """A plane before the camera."""

    inverse_depth: Float[np.ndarray, "row column"]
    """1/z of the plane behind every pixel, per metre; below or equal to 0 where the pixel's ray never meets it."""
    distance_m: float
    """Of the camera from the plane."""

    def covers(self, depth: Float32[np.ndarray, "row column"]) -> Bool[np.ndarray, "row column"]:
        """Which returns lie on the ground, less than 5 cm above it, or below it.

        The frame's wobble is the median of how far its returns lie behind the plane along z, over those within 15 cm.
        """
        with np.errstate(divide="ignore"):
            behind = depth - 1 / self.inverse_depth
        wobble = np.float32(wobble_m(behind[self.inverse_depth > 0], least=_LEAST_PIXELS))
        height = self.distance_m * (1 - (depth - wobble) * self.inverse_depth)
        return height < _CLEARANCE_M  # NaN: no.


def ground_of(source: DepthSource, camera: Camera, *, up_is_known: bool) -> Ground:
    """The largest plane of the recording, and a level one where the world's z axis is known to point up.

    Taken from each pixel's median over frames spread over the recording, in which people and single frames' wobble
    vanish.
    """
    depth = _usual_depth(source)
    rays = camera.camera_from_pixel(pixel_grid(camera.height, camera.width), np.ones(depth.shape))
    seen = np.isfinite(depth)
    if seen.sum() < _LEAST_PIXELS:
        raise InputError(f"ground: expected at least {_LEAST_PIXELS} returns to find it in, got {seen.sum()}")
    chosen = np.random.default_rng(0).permutation(np.flatnonzero(seen))[:_PIXELS_FOR_PLANE]
    up = camera.world_from_camera[2, :3] if up_is_known else None  # The world's z axis, in camera axes.
    plane = _plane(rays.reshape(-1, 3)[chosen], 1 / depth.ravel()[chosen].astype(np.float64), up)
    inverse = rays @ plane
    share = float(np.mean(np.abs(depth[seen] * inverse[seen] - 1) < _WITHIN))
    if share < _LEAST_SHARE:
        raise InputError(
            f"ground: expected a plane with a tenth of the returns, the largest has {share:.0%}: leave "
            "--remove-ground out"
        )
    return Ground(inverse_depth=inverse, distance_m=float(1 / np.linalg.norm(plane)))


def _plane(
    rays: Float[np.ndarray, "point 3"], inverse_depth: Float[np.ndarray, "point"], up: Float[np.ndarray, "3"] | None
) -> Float[np.ndarray, "3"]:
    """The vector p of the plane p . X = 1: on it 1/z = p . ray, which is linear."""

    def level(model: LinearRegression, *_: np.ndarray) -> bool:
        if up is None:
            return True
        return bool(abs(model.coef_ @ up) > np.cos(np.radians(_STEEPEST_DEG)) * np.linalg.norm(model.coef_))

    search = RANSACRegressor(
        LinearRegression(fit_intercept=False),
        min_samples=3,
        residual_threshold=_WITHIN,
        loss=lambda true, found: np.abs(found / true - 1),  # Distance from the plane, over the camera's.
        is_model_valid=level,
        max_trials=500,
        random_state=0,
    )
    try:
        search.fit(rays, inverse_depth)
    except ValueError:
        raise InputError("ground: expected a level plane, found none: leave --remove-ground out") from None
    if not level(search.estimator_):  # Fitted once more, to all of its points.
        raise InputError("ground: expected a level plane, found a steep one: leave --remove-ground out")
    return np.asarray(search.estimator_.coef_)


def _usual_depth(source: DepthSource) -> Float32[np.ndarray, "row column"]:
    """Each pixel's median over some frames; NaN where it has a return in fewer than half of them."""
    step = -(-source.count // _FRAMES_FOR_MEDIAN)
    frames = tracked(source.frames(), "looking for the ground", total=source.count)
    stack = np.stack([frame.depth for frame in islice(frames, 0, None, step)])
    often = np.isfinite(stack).mean(axis=0) >= 0.5
    filled = np.where(often, stack, np.float32(1))
    return np.where(often, np.nanmedian(filled, axis=0), np.float32(np.nan)).astype(np.float32)
