"""Kinect 1: a projected pattern of dots, found again by correlation and measured by its shift.

Noise as Nguyen, Izadi and Lovell measured it ("Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
Tracking", 3DIMPVT 2012), disparity in eighths of a pixel (Handa et al., ICRA 2014), shadow and correlation window as in
BlenSor (Gschwandtner et al., ISVC 2011).
"""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float64
from pydantic import Field, NonNegativeFloat, PositiveFloat
from scipy.special import ndtr

from recording.camera import PIXEL_CENTRE
from recording.frame import Frame, Reason
from simulator.grain import box, grain
from simulator.matching import FAR_OFF, own_share, window_size
from simulator.sensed import Scanner, Sensed, lost, returned
from simulator.tangent import Tangents, tangents
from simulator.view import View

_MEASURED_FROM_M = 0.4
"""The distance from which on Nguyen's axial noise grows, metres."""
_STEEP = np.radians(60.0)
"""The angle from which on a surface's slope adds to Nguyen's axial noise."""
_STEEPEST = np.radians(89.0)
"""Where his formulas, which end at infinity, are held."""

Image = Float64[np.ndarray, "row column"]


class Kinect1(Scanner):
    """Pixels are those of a sensor whose focal length is `focal_px`; the picture may have others.

    So a picture of another size has the same noise in metres, and windows as wide as they are on the sensor.
    """

    preset: Literal["kinect1"]
    focal_px: PositiveFloat = 480.0
    """Focal length of the sensor, f, in its own pixels: 480 as in Handa et al.'s simulated camera; a real one has about
    580, whose steps of disparity are so much finer."""
    baseline_m: PositiveFloat = 0.075
    """The projector stands so far to the right of the camera, b, metres."""
    disparity_step_px: NonNegativeFloat = 0.125
    """Disparity f b / z is rounded to multiples of this, pixels; 0 = not at all."""
    axial_m: NonNegativeFloat = 0.0012
    """Depth noise of a near surface, metres."""
    axial_growth_per_m: NonNegativeFloat = 0.0019
    """How it grows with the square of the distance beyond 0.4 m, 1/metres."""
    axial_slope_m: NonNegativeFloat = 0.0001
    """How it grows on surfaces that are steeper than 60 degrees, metres (at 1 m)."""
    lateral_px: NonNegativeFloat = 0.8
    """How far a pixel looks beside its place, standard deviation along rows and columns, pixels."""
    lateral_slope_px: NonNegativeFloat = 0.035
    """How that grows with the surface's slope, pixels."""
    window_px: PositiveFloat = 9.0
    """Side of the window that is correlated, pixels."""
    edge_share: Annotated[float, Field(ge=0, le=1)] = 0.6
    """A pixel is lost where less of its window has its own disparity."""
    edge_px: PositiveFloat = 1.0
    """What disparity is still its own, pixels."""
    grazing_deg: Annotated[float, Field(gt=0, le=90)] = 80.0
    """Angle between ray and normal at which every second pixel is lost, degrees; 90 = none."""
    grazing_soft_deg: PositiveFloat = 3.0
    """How softly that sets in: the standard deviation of the angle that is too much, degrees."""

    def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
        """Lateral shift, axial noise, rounded disparity; shadow, edges and grazing angles are lost.

        Errors are shared within half a window, for each disparity is that of a window.
        """
        scale = view.camera.fx / self.focal_px
        size = window_size(self.window_px, scale=scale)
        noise = [grain(generator, exact.depth.shape, box(size)) for _ in range(4)]
        surface = tangents(exact.depth, view.camera)
        reason = self.in_range(exact)
        lit = view.reached_from(self.baseline_m, np.where(reason == Reason.RETURN, exact.depth, np.float32(np.nan)))
        reason = lost(reason, ~lit, Reason.SHADOW)
        reason = lost(reason, self._at_edges(surface.inverse, reason, size), Reason.EDGE)
        reason = lost(reason, self._grazed(surface.angle, noise[3]), Reason.GRAZING)
        inverse, mixed = self._beside(surface, reason, [scale * noise[0], scale * noise[1]])
        depth = 1.0 / inverse
        depth = depth + self.axial_sigma_m(depth, surface.angle) * noise[2]
        return returned(self._rounded(depth), lost(reason, mixed, Reason.MIXED))

    def axial_sigma_m(self, depth: Image, angle: Image) -> Image:
        """Standard deviation of the depth, metres: 0.0012 + 0.0019 (z - 0.4)^2.

        Above 60 degrees 0.0001 a^2 / ((pi/2 - a)^2 sqrt z) is added.
        """
        angle = np.minimum(angle, _STEEPEST)
        slope = self.axial_slope_m / np.sqrt(depth) * (angle / (np.pi / 2 - angle)) ** 2
        flat = self.axial_m + self.axial_growth_per_m * (depth - _MEASURED_FROM_M) ** 2
        return flat + np.where(angle > _STEEP, slope, 0.0)

    def lateral_sigma_px(self, angle: Image) -> Image:
        """Standard deviation of the place, the sensor's pixels: 0.8 + 0.035 a / (pi/2 - a)."""
        angle = np.minimum(angle, _STEEPEST)
        return self.lateral_px + self.lateral_slope_px * angle / (np.pi / 2 - angle)

    def _at_edges(self, inverse: Image, reason: np.ndarray, size: int) -> np.ndarray:
        """Where too little of the window belongs to the pixel's own surface; what does not return never does."""
        disparity = np.where(reason == Reason.RETURN, self.focal_px * self.baseline_m * inverse, FAR_OFF)
        return own_share(disparity, size, tolerance_px=self.edge_px) < self.edge_share

    def _grazed(self, angle: Image, noise: np.ndarray) -> np.ndarray:
        """Where the surface is too steep."""
        if self.grazing_deg == 90:
            return np.zeros(angle.shape, bool)
        return ndtr(noise) < ndtr((np.degrees(angle) - self.grazing_deg) / self.grazing_soft_deg)

    def _beside(self, surface: Tangents, reason: np.ndarray, noise: list[np.ndarray]) -> tuple[Image, np.ndarray]:
        """The inverse depth at a place beside each pixel's, and where it belongs to another surface.

        It is that of the plane which touches the nearest pixel that returns.
        """
        sigma, rows_columns = self.lateral_sigma_px(surface.angle), reason.shape
        right, down = np.nan_to_num(sigma * noise[0]), np.nan_to_num(sigma * noise[1])
        row, column = (axis + PIXEL_CENTRE for axis in np.ogrid[: rows_columns[0], : rows_columns[1]])
        there = (
            np.clip(np.floor(row + down), 0, rows_columns[0] - 1).astype(np.int64),
            np.clip(np.floor(column + right), 0, rows_columns[1] - 1).astype(np.int64),
        )
        own = np.indices(rows_columns)
        there = tuple(np.where(reason[there] == Reason.RETURN, there, own))
        beyond_right, beyond_down = column + right - there[1] - PIXEL_CENTRE, row + down - there[0] - PIXEL_CENTRE
        # A place between two pixels that has none of its own is no farther than half a pixel away.
        beyond_right, beyond_down = np.clip(beyond_right, -0.5, 0.5), np.clip(beyond_down, -0.5, 0.5)
        seen = surface.inverse[there] + surface.right[there] * beyond_right + surface.down[there] * beyond_down
        seen = np.maximum(seen, 0.5 * surface.inverse[there])  # However steep: half a pixel does not double a depth.
        expected = surface.inverse + surface.right * right + surface.down * down
        mixed = np.abs(seen - expected) * self.focal_px * self.baseline_m > self.edge_px
        return seen, mixed

    def _rounded(self, depth: Image) -> Image:
        """The depth of the nearest disparity that the sensor can tell."""
        if self.disparity_step_px == 0:
            return depth
        product = self.focal_px * self.baseline_m
        steps = np.round(product / depth / self.disparity_step_px)
        return product / np.where(steps > 0, steps * self.disparity_step_px, np.nan)
