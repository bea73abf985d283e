"""Two cameras beside one another: depth by the shift between their pictures.

The error of depth is z^2 / (f b) times that of the shift (Intel, "Best-known methods for tuning Intel RealSense D400
depth cameras for best performance"; Gallup et al., "Variable baseline/resolution stereo", CVPR 2008). Windows fatten
what is in front (Hirschmueller, Innocent and Garibaldi, "Real-time correlation-based stereo vision with reduced border
errors", IJCV 2002).
"""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Float64
from pydantic import Field, NonNegativeFloat, PositiveFloat

from recording.frame import Frame, Reason
from simulator.grain import box, grain
from simulator.matching import uneven, window_size, windows
from simulator.sensed import Reasons, Scanner, Sensed, lost, returned
from simulator.view import View

Image = Float64[np.ndarray, "row column"]


class Stereo(Scanner):
    """Pixels are the sensor's own, whose focal length is `focal_px`; the picture may have others."""

    preset: Literal["stereo"]
    nearest_m: NonNegativeFloat = 0.3
    """What is nearer does not return, metres; this goes by the exact depth."""
    focal_px: PositiveFloat = 424.0
    """Focal length of the sensor, f, in its own pixels: 848 of them across 90 degrees."""
    baseline_m: PositiveFloat = 0.05
    """The second camera stands so far to the right of the first, b, metres."""
    disparity_sigma_px: NonNegativeFloat = 0.08
    """Standard deviation of the disparity f b / z, pixels."""
    disparity_step_px: NonNegativeFloat = 0.03125
    """Disparity is rounded to multiples of this, pixels; 0 = not at all."""
    window_px: PositiveFloat = 7.0
    """Side of the window that is matched, pixels; 1 = every pixel for itself."""
    fattening_share: Annotated[float, Field(gt=0, le=0.5)] = 0.3
    """What is in front takes a pixel of whose window it has so much."""
    edge_px: PositiveFloat = 1.0
    """What disparity is another surface's, pixels."""

    def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
        """Noise and rounding in the disparity; fat edges; what the second camera does not see is lost.

        Errors are shared within half a window, for each disparity is that of a window.
        """
        size = window_size(self.window_px, scale=view.camera.fx / self.focal_px)
        noise = grain(generator, exact.depth.shape, box(size))
        reason = self.in_range(exact)
        there = np.where(reason == Reason.RETURN, exact.depth, np.float32(np.nan))
        reason = lost(reason, ~view.reached_from(self.baseline_m, there), Reason.SHADOW)
        disparity = self.focal_px * self.baseline_m / exact.depth.astype(np.float64)
        matched, fat = self._fattened(disparity, reason, size)
        measured = self._rounded(matched + self.disparity_sigma_px * noise)
        depth = self.focal_px * self.baseline_m / np.where(measured > 0, measured, np.nan)
        return returned(depth, lost(reason, fat, Reason.MIXED))

    def _fattened(self, disparity: Image, reason: Reasons, size: int) -> tuple[Image, Bool[np.ndarray, "row column"]]:
        """The disparities with fat edges, and where they are another surface's than the pixel's own."""
        there = np.where(reason == Reason.RETURN, disparity, 0.0)
        pixels = np.argwhere(uneven(there, size, tolerance_px=self.edge_px) & (reason == Reason.RETURN))
        fat, matched = np.zeros(disparity.shape, bool), disparity.copy()
        if len(pixels):
            around, own = windows(there, size, pixels), disparity[tuple(pixels.T)]
            front = np.quantile(around, 1 - self.fattening_share, axis=0, method="lower")
            fat[tuple(pixels.T)] = front > own + self.edge_px
            matched[tuple(pixels.T)] = np.where(front > own + self.edge_px, front, own)
        return matched, fat

    def _rounded(self, disparity: Image) -> Image:
        """The nearest disparity that the sensor can tell."""
        step = self.disparity_step_px
        return disparity if step == 0 else np.round(disparity / step) * step
