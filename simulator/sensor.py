"""Sensors: what a scanner makes of exact depth.

A sensor takes a frame as it really is, the view that it is of and a random generator, and says what depth comes back
and why none does. Labels and exact depth stay as they are: a pixel keeps the material point of its centre ray, whatever
the noise. `docs/sensors.md` has the models' formulas and sources; each has a file of its name.
"""

from dataclasses import replace
from typing import Annotated, Literal, Protocol, runtime_checkable

import numpy as np
from pydantic import Field, TypeAdapter

from recording.checks import Frozen, nearest_name
from recording.errors import InputError
from recording.frame import Frame
from simulator.kinect1 import Kinect1
from simulator.sensed import Sensed, exact_reasons
from simulator.stereo import Stereo
from simulator.structured_light import StructuredLight
from simulator.tof import TimeOfFlight
from simulator.view import View

_NOISE = 1
"""Sets the noise apart from all that a seed draws by itself: to numpy (seed, 0) is the same as the seed alone, with
which scenes are drawn and varied, and only a last number other than 0 makes another stream of it."""


@runtime_checkable
class SensorModel(Protocol):
    """A kind of sensor with its parameters."""

    @property
    def seed(self) -> int:
        """Which draw of the noise."""

    def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
        """What it makes of a frame whose depth is exact and whose reasons are those of the rays.

        The view has the camera, and casts further rays for who asks.
        """


class Ideal(Frozen):
    """Exact depth wherever the ray meets something."""

    preset: Literal["ideal"] = "ideal"

    @property
    def seed(self) -> int:
        """No noise, no draw."""
        return 0

    def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
        """The frame as it is."""
        return Sensed(depth=exact.depth, reason=exact_reasons(exact))


Sensor = Annotated[Ideal | Kinect1 | TimeOfFlight | StructuredLight | Stereo, Field(discriminator="preset")]
PRESETS = ("ideal", "kinect1", "tof", "structured_light", "stereo")


def sensor_named(preset: str) -> Sensor:
    """The sensor of that name with the parameters that it has when nobody says otherwise."""
    if preset not in PRESETS:
        raise InputError(f"unknown sensor {preset!r}: {nearest_name(preset, PRESETS)}")
    adapter: TypeAdapter[Sensor] = TypeAdapter(Sensor)
    return adapter.validate_python({"preset": preset})


def sensed_frame(exact: Frame, view: View, sensor: SensorModel, *, number: int) -> Frame:
    """The frame of that number as the sensor sees it; its labels and exact depth are kept.

    The noise depends on the sensor's seed and the frame's number alone: frames may be made in any order, by anyone.
    """
    if isinstance(sensor, Ideal):
        return exact
    sensed = sensor.sensed(exact, view, np.random.default_rng((sensor.seed, number, _NOISE)))
    return replace(exact, depth=sensed.depth, clean_depth=exact.depth, reason=sensed.reason)


def on_another_day(sensor: Sensor, seed: int) -> Sensor:
    """The sensor with the noise of a recording's seed; with 0 it is as it is."""
    return sensor if seed == 0 or isinstance(sensor, Ideal) else sensor.model_copy(update={"seed": seed})
