"""A sweep as its TOML file has it: which settings, on which recordings."""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, ConfigDict, Field, NonNegativeInt, PositiveInt, model_validator
from scipy.stats import qmc

from algorithm.settings import Preset, Settings, changed_settings
from recording.checks import Frozen, toml_document, validated
from recording.errors import InputError

Value = bool | int | float | str
Design = Literal["grid", "one_at_a_time", "sobol", "random"]
_MOST_POINTS = 100_000
_DIGITS = 6
"""Significant digits of a value from a range."""


class Axis(Frozen):
    """The values that a setting takes: a list of them, or a range."""

    model_config = ConfigDict(populate_by_name=True)

    values: Annotated[tuple[Value, ...], Field(min_length=1)] | None = None
    first: float | None = Field(default=None, alias="from")
    last: float | None = Field(default=None, alias="to")
    steps: Annotated[int, Field(ge=1, le=_MOST_POINTS)] | None = None
    """Values of a range, its ends among them; samples are drawn between the ends and need none."""
    scale: Literal["linear", "logarithmic"] = "linear"
    """Of a range: steps of equal difference, or of equal ratio."""

    @model_validator(mode="after")
    def _list_or_range(self) -> "Axis":
        if (self.values is None) == (self.first is None or self.last is None):
            raise ValueError("expected a list of values, or a range such as {from = 1, to = 10, steps = 4}")
        if self.scale == "logarithmic" and min(self.first or 0, self.last or 0) <= 0:
            raise ValueError("expected a range above 0 for a logarithmic scale")
        return self

    def at(self, share: float) -> Value:
        """The value at a share of the way from the first to the last."""
        if self.values is not None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        low, high = float(self.first or 0), float(self.last or 0)
        if self.scale == "linear":
            return _rounded(low + share * (high - low))
        return _rounded(low * (high / low) ** share)

    def listed(self) -> tuple[Value, ...]:
        """All values."""
        if self.values is not None:
            return self.values
        steps = self.steps or 1
        return tuple(self.at(number / max(steps - 1, 1)) for number in range(steps))


def _axis(value: object) -> object:
    return {"values": value} if isinstance(value, list) else value


class Sweep(Frozen):
    """The content of a sweep's file."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]
    description: str = ""
    scenes: tuple[str, ...] = ()
    """Scenes to simulate, by name or path of a TOML file, each under every seed."""
    seeds: tuple[NonNegativeInt, ...] = (1, 2, 3)
    frames: PositiveInt | None = None
    """Number of frames in place of the scenes' own."""
    size: str | None = None
    """Picture size in place of the scenes' own, such as `2x`."""
    sensor: str | None = None
    """Sensor preset in place of the scenes' own."""
    recordings: tuple[str, ...] = ()
    """Folders of recordings or data sets, seen from the file's own folder."""
    preset: Preset = "default"
    settings: dict[str, Value] = Field(default_factory=dict)
    """What replaces the preset's settings in every point."""
    design: Design = "grid"
    """All combinations; one axis at a time from the preset's values; or samples of the axes' ranges."""
    samples: Annotated[int, Field(ge=1, le=_MOST_POINTS)] = 64
    """Number of points of the designs `sobol` and `random`."""
    sampling_seed: NonNegativeInt = 0
    """Of those samples."""
    goal: str = "worth"
    """The score that tells the best setting."""
    axes: Annotated[dict[str, Annotated[Axis, BeforeValidator(_axis)]], Field(min_length=1)]

    @model_validator(mode="after")
    def _complete(self) -> "Sweep":
        if not self.scenes and not self.recordings:
            raise ValueError("expected scenes or recordings to sweep over")
        if self.design in ("grid", "one_at_a_time"):
            bare = next((name for name, axis in self.axes.items() if axis.values is None and not axis.steps), None)
            if bare is not None:
                raise ValueError(f"expected the number of steps of the range of {bare!r}")
        points = math.prod(len(axis.values or ()) or axis.steps or 1 for axis in self.axes.values())
        if self.design == "grid" and points > _MOST_POINTS:
            raise ValueError(f"expected {_MOST_POINTS} points at the most, got {points}: take another design")
        return self


@dataclass(frozen=True, kw_only=True)
class Point:
    """Some values of the axes."""

    number: int
    values: Mapping[str, Value]
    axis: str | None = None
    """The axis that it is a step on, where the others keep the preset's values."""


def load_sweep(path: Path) -> Sweep:
    """The sweep in a TOML file; its recordings as seen from here."""
    sweep = validated(Sweep, toml_document(path), source=str(path))
    try:
        for point in points_of(sweep):
            settings_at(sweep, point, Settings())
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return sweep.model_copy(update={"recordings": tuple(str(path.parent / place) for place in sweep.recordings)})


def settings_at(sweep: Sweep, point: Point, base: Settings) -> Settings:
    """The settings of a point, from those of the preset for a recording."""
    fixed = changed_settings(base, dict(sweep.settings), source="settings")
    return changed_settings(fixed, dict(point.values), source="axes")


def points_of(sweep: Sweep) -> tuple[Point, ...]:
    """The points of the sweep, none twice."""
    drawn = {"grid": _grid, "one_at_a_time": _one_at_a_time, "sobol": _samples, "random": _samples}[sweep.design](sweep)
    points: dict[tuple[Any, ...], Point] = {}
    for values, axis in drawn:
        fitting = {name: _fitting(name, value) for name, value in values.items()}
        points.setdefault(tuple(fitting.items()), Point(number=len(points), values=fitting, axis=axis))
    return tuple(points.values())


_Drawn = Iterator[tuple[dict[str, Value], str | None]]


def _grid(sweep: Sweep) -> _Drawn:
    for values in itertools.product(*(axis.listed() for axis in sweep.axes.values())):
        yield dict(zip(sweep.axes, values, strict=True)), None


def _one_at_a_time(sweep: Sweep) -> _Drawn:
    yield {}, None
    for name, axis in sweep.axes.items():
        for value in axis.listed():
            yield {name: value}, name


def _samples(sweep: Sweep) -> _Drawn:
    """Points that fill the space evenly (Sobol's sequence, scrambled), or at random."""
    count, generator = len(sweep.axes), np.random.default_rng(sweep.sampling_seed)
    if sweep.design == "sobol":
        power = math.ceil(math.log2(sweep.samples))  # The sequence is even for powers of 2; its beginning nearly so.
        shares = qmc.Sobol(count, rng=generator).random_base2(power)[: sweep.samples]
    else:
        shares = generator.random((sweep.samples, count))
    for row in shares:
        yield {name: axis.at(share) for (name, axis), share in zip(sweep.axes.items(), row, strict=True)}, None


def _fitting(name: str, value: Value) -> Value:
    """Whole numbers for settings that count, which a range would miss."""
    field = Settings.model_fields.get(name)
    whole = field is not None and field.annotation is int and isinstance(value, float)
    return round(value) if whole and not isinstance(value, str) else value


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
