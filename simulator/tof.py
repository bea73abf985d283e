"""Time of flight: light that is modulated comes back later from farther away.

Sizes after the Azure Kinect (Toelgyessy et al., Sensors 21, 2021: sigma at most 17 mm, bias below 11 mm up to 3.5 m)
and what a Kinect 2 on a ceiling really recorded (`docs/sensors.md`).
"""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Float32, Float64
from pydantic import Field, NonNegativeFloat, PositiveFloat
from scipy.special import ndtr

from recording.camera import PIXEL_CENTRE, Camera
from recording.frame import Frame, Reason
from simulator.grain import bell, grain
from simulator.sensed import Scanner, Sensed, lost, returned
from simulator.view import View

Share = Annotated[float, Field(ge=0, le=1)]
_RAYS = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) / 3
"""The light of a pixel at an edge is that of its centre's ray and of four more: as a five on a die, in spots."""


class TimeOfFlight(Scanner):
    """Radii are in half diagonals of the picture: the light fills the picture, whatever its size and angle."""

    preset: Literal["tof"]
    noise_m: NonNegativeFloat = 0.001
    """Depth noise of a near surface, standard deviation, metres."""
    noise_growth_per_m: NonNegativeFloat = 0.0003
    """How it grows with the square of the distance, 1/metres."""
    noise_at_border: NonNegativeFloat = 10.0
    """How many times as much is added where the light ends."""
    grain_px: NonNegativeFloat = 0.7
    """How far neighbours share their noise: standard deviation of the Gaussian that smooths it, pixels."""
    bias_m: NonNegativeFloat = 0.005
    """Height of the error that goes up and down with the distance, metres."""
    bias_period_m: PositiveFloat = 0.47
    """Its period, metres: a quarter of half a wave of 80 MHz."""
    wobble_m: NonNegativeFloat = 0.015
    """By how much all depths of a frame are off, standard deviation from frame to frame, metres."""
    lit_radius: PositiveFloat = 0.81
    """Distance from the picture's middle at which every second pixel is too dark, half diagonals."""
    lit_border: PositiveFloat = 0.075
    """How softly the light ends: the standard deviation of that radius, half diagonals."""
    mixed_m: PositiveFloat = 0.1
    """A pixel whose rays end farther apart than this is mixed, metres."""
    spot_px: Annotated[float, Field(gt=0, le=2)] = 1.5
    """Side of the square from which a pixel gathers light, pixels: lenses blur; at most 2."""
    rejected_share: Share = 0.9
    """Share of the mixed pixels that the sensor's own filter takes out; the others fly."""

    def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
        """Mixed depth at edges, noise, bias, and one offset for the whole frame; dark and mixed pixels are lost."""
        wobble = generator.normal(scale=self.wobble_m)
        noise = grain(generator, exact.depth.shape, bell(self.grain_px))
        dark, rejected = generator.random((2, *exact.depth.shape), dtype=np.float32)
        radius, reason = _half_diagonals(view.camera), self.in_range(exact)
        depth, mixed = self._mixed(exact.depth, reason == Reason.RETURN, view)
        reason = lost(reason, dark < ndtr((radius - self.lit_radius) / self.lit_border), Reason.NO_SIGNAL)
        reason = lost(reason, mixed & (rejected < self.rejected_share), Reason.EDGE)
        error = self.sigma_m(depth, radius) * noise + self.bias_m * np.sin(2 * np.pi * depth / self.bias_period_m)
        return returned(depth + error + wobble, lost(reason, mixed, Reason.MIXED))

    def sigma_m(
        self, depth: Float64[np.ndarray, "row column"], radius: Float64[np.ndarray, "row column"]
    ) -> Float64[np.ndarray, "row column"]:
        """Standard deviation of the depth, metres: (c + g z^2) (1 + n e^((r - R) / s)) with the light's border R, s."""
        beyond = np.minimum((radius - self.lit_radius) / self.lit_border, 0.0)
        return (self.noise_m + self.noise_growth_per_m * depth**2) * (1.0 + self.noise_at_border * np.exp(beyond))

    def _mixed(
        self, exact: Float32[np.ndarray, "row column"], asked: Bool[np.ndarray, "row column"], view: View
    ) -> tuple[Float64[np.ndarray, "row column"], Bool[np.ndarray, "row column"]]:
        """The depths as light from all over each pixel mixes them, and where that is of more than one surface.

        Light comes back from a distance z with the share 1 / z^2: the mean depth is the sum of 1 / z over the sum of
        1 / z^2. Rays are cast only where it is asked for and neighbours are not on one plane.
        """
        depth, mixed = exact.astype(np.float64), np.zeros(exact.shape, bool)
        pixels = np.nonzero(asked & _bent(exact, self.mixed_m))
        if not len(pixels[0]):
            return depth, mixed
        centre = np.stack(pixels[::-1], axis=-1) + PIXEL_CENTRE
        around = view.depth_at(centre[:, None] + self.spot_px * _RAYS)
        found = np.concatenate([around, depth[pixels][:, None]], axis=1)
        spread = np.nanmax(found, axis=1) - np.nanmin(found, axis=1)
        blend = np.nansum(1 / found, axis=1) / np.nansum(1 / found**2, axis=1)
        mixed[pixels] = spread > self.mixed_m
        depth[pixels] = np.where(mixed[pixels], blend, depth[pixels])
        return depth, mixed


def _bent(depth: Float32[np.ndarray, "row column"], least_m: float) -> Bool[np.ndarray, "row column"]:
    """Where something is, and a row or a column of three pixels leaves its plane by more than so much, or ends."""
    inverse, bent = 1.0 / depth.astype(np.float64), np.zeros(depth.shape, bool)
    least = least_m * inverse**2  # Planes are linear in the inverse depth.
    bent[1:-1] |= ~(np.abs(inverse[2:] - 2 * inverse[1:-1] + inverse[:-2]) <= least[1:-1])
    bent[:, 1:-1] |= ~(np.abs(inverse[:, 2:] - 2 * inverse[:, 1:-1] + inverse[:, :-2]) <= least[:, 1:-1])
    return bent & np.isfinite(depth)


def _half_diagonals(camera: Camera) -> Float64[np.ndarray, "row column"]:
    """Each pixel's distance from the picture's middle."""
    across = np.arange(camera.width) + PIXEL_CENTRE - camera.width / 2
    down = np.arange(camera.height) + PIXEL_CENTRE - camera.height / 2
    return np.hypot(across, down[:, None]) / np.hypot(camera.width / 2, camera.height / 2)
