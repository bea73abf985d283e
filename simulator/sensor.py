"""Sensors: what a scanner makes of exact depth.

A sensor takes a frame as it really is, the camera and a random generator, and says what depth comes back and why none
does. Labels and exact depth stay as they are: a pixel keeps the material point of its centre ray, whatever the noise.
"""

from dataclasses import dataclass, replace
from typing import Annotated, Literal, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, UInt32
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, model_validator

from recording.camera import Camera
from recording.checks import Frozen
from recording.frame import Frame

OUT_OF_RANGE = 2
"""The reason of a pixel whose surface is nearer or farther than the sensor measures (`recording.frame.REASONS`)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensed:
    """What comes back from a sensor."""

    depth: Float32[np.ndarray, "row column"]
    """Metres along the camera's z axis; NaN = no return."""
    reason: UInt32[np.ndarray, "row column"]
    """Why a return is missing or mixed (`recording.frame.REASONS`); 0 = it is as it should be."""


@runtime_checkable
class SensorModel(Protocol):
    """A kind of sensor with its parameters."""

    @property
    def seed(self) -> int:
        """Which draw of the noise."""

    def sensed(self, exact: Frame, camera: Camera, generator: np.random.Generator) -> Sensed:
        """What it makes of a frame whose depth is exact and whose reasons are those of the rays."""


class Ideal(Frozen):
    """Exact depth wherever the ray meets something."""

    preset: Literal["ideal"] = "ideal"

    @property
    def seed(self) -> int:
        """No noise, no draw."""
        return 0

    def sensed(self, exact: Frame, camera: Camera, generator: np.random.Generator) -> Sensed:
        """The frame as it is."""
        return Sensed(depth=exact.depth, reason=_reasons(exact))


class StructuredLight(Frozen):
    """The paper's scanner: depth with Gaussian noise of one size at every distance, within a range."""

    preset: Literal["structured_light"]
    sigma_m: NonNegativeFloat = 0.001
    """Standard deviation of the depth, metres."""
    nearest_m: NonNegativeFloat = 0.5
    """What is nearer does not return, metres."""
    farthest_m: PositiveFloat = 10.0
    """What is farther does not return, metres."""
    seed: NonNegativeInt = 0
    """Which draw of the noise; a recording with a seed other than 0 has its own."""

    @model_validator(mode="after")
    def _measures_something(self) -> "StructuredLight":
        if self.nearest_m >= self.farthest_m:
            raise ValueError(f"expected 'nearest_m' below 'farthest_m' ({self.farthest_m}), got {self.nearest_m}")
        return self

    def sensed(self, exact: Frame, camera: Camera, generator: np.random.Generator) -> Sensed:
        """Independent noise in every pixel; the range goes by the exact depth."""
        noise = generator.normal(scale=self.sigma_m, size=exact.depth.shape)
        beyond = (exact.depth < self.nearest_m) | (exact.depth > self.farthest_m)
        depth = np.where(beyond, np.nan, exact.depth + noise).astype(np.float32)
        return Sensed(depth=depth, reason=np.where(beyond, np.uint32(OUT_OF_RANGE), _reasons(exact)))


Sensor = Annotated[Ideal | StructuredLight, Field(discriminator="preset")]


def sensed_frame(exact: Frame, camera: Camera, sensor: SensorModel, *, number: int) -> Frame:
    """The frame of that number as the sensor sees it; its labels and exact depth are kept.

    The noise depends on the sensor's seed and the frame's number alone: frames may be made in any order, by anyone.
    """
    if isinstance(sensor, Ideal):
        return exact
    sensed = sensor.sensed(exact, camera, np.random.default_rng((sensor.seed, number)))
    return replace(exact, depth=sensed.depth, clean_depth=exact.depth, reason=sensed.reason)


def on_another_day(sensor: Sensor, seed: int) -> Sensor:
    """The sensor with the noise of a recording's seed; with 0 it is as it is."""
    return sensor if seed == 0 or isinstance(sensor, Ideal) else sensor.model_copy(update={"seed": seed})


def _reasons(exact: Frame) -> UInt32[np.ndarray, "row column"]:
    return np.zeros(exact.depth.shape, np.uint32) if exact.reason is None else exact.reason
