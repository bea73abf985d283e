"""What all sensors have in common: what comes back, from how far, and why it does not."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt32
from pydantic import NonNegativeFloat, NonNegativeInt, PositiveFloat, model_validator

from recording.checks import Frozen
from recording.frame import Frame, Reason

Reasons = UInt32[np.ndarray, "row column"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensed:
    """What comes back from a sensor."""

    depth: Float32[np.ndarray, "row column"]
    """Metres along the camera's z axis; NaN = no return."""
    reason: UInt32[np.ndarray, "row column"]
    """Why a return is missing or mixed (`recording.frame.Reason`); 0 = it is as it should be."""


class Scanner(Frozen):
    """A sensor that measures within a range, with noise of its own."""

    nearest_m: NonNegativeFloat = 0.5
    """What is nearer does not return, metres; this goes by the exact depth."""
    farthest_m: PositiveFloat = 10.0
    """What is farther does not return, metres."""
    seed: NonNegativeInt = 0
    """Which draw of the noise; a recording with a seed other than 0 has its own."""

    @model_validator(mode="after")
    def _measures_something(self) -> "Scanner":
        if self.nearest_m >= self.farthest_m:
            raise ValueError(f"expected 'nearest_m' below 'farthest_m' ({self.farthest_m}), got {self.nearest_m}")
        return self

    def in_range(self, exact: Frame) -> Reasons:
        """The reasons of the frame, and of those that are too near or too far."""
        beyond = (exact.depth < self.nearest_m) | (exact.depth > self.farthest_m)
        return lost(exact_reasons(exact), beyond, Reason.OUT_OF_RANGE)


def exact_reasons(exact: Frame) -> Reasons:
    """The reasons of a frame before any sensor."""
    if exact.reason is not None:
        return exact.reason
    return np.where(exact.seen, np.uint32(Reason.RETURN), np.uint32(Reason.NOTHING_THERE))


def lost(reason: Reasons, where: Bool[np.ndarray, "row column"], because: Reason) -> Reasons:
    """The reasons with a further one where there was a return; the first one stays."""
    return np.where(where & (reason == Reason.RETURN), np.uint32(because), reason)


def returned(depth: Float[np.ndarray, "row column"], reason: Reasons) -> Sensed:
    """The depths where the reasons leave a return, whole or mixed; what noise takes to 0 or below gives no signal."""
    reason = lost(reason, ~(depth > 0), Reason.NO_SIGNAL)
    kept = ((reason == Reason.RETURN) | (reason == Reason.MIXED)) & (depth > 0)
    reason = np.where((reason == Reason.MIXED) & ~kept, np.uint32(Reason.NO_SIGNAL), reason)
    return Sensed(depth=np.where(kept, depth, np.nan).astype(np.float32), reason=reason)
