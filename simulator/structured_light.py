"""The paper's scanner: depth with Gaussian noise of one size at every distance, and holes."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat
from scipy.special import ndtri

from recording.frame import Frame, Reason
from simulator.grain import bell, grain
from simulator.sensed import Scanner, Sensed, lost, returned
from simulator.view import View


class StructuredLight(Scanner):
    """Section 5 of the paper: 1 mm, 0.5 to 10 m, 15 frames a second; how many frames, the scene says."""

    preset: Literal["structured_light"]
    sigma_m: NonNegativeFloat = 0.001
    """Standard deviation of the depth, metres."""
    hole_share: Annotated[float, Field(ge=0, lt=1)] = 0.01
    """Share of the surface that does not return, in patches that are drawn anew in each frame."""
    hole_px: NonNegativeFloat = 1.5
    """Size of the patches: the standard deviation of the Gaussian by which they are smoothed, pixels."""

    def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
        """Independent noise in every pixel; holes where a smooth random field is high."""
        noise = generator.normal(scale=self.sigma_m, size=exact.depth.shape)
        patches = grain(generator, exact.depth.shape, bell(self.hole_px))
        reason = lost(self.in_range(exact), patches > ndtri(1 - self.hole_share), Reason.NO_SIGNAL)
        return returned(exact.depth + noise, reason)
