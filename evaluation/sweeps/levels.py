"""The rows of a sweep by the values of its axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any, TypeGuard

import numpy as np

from evaluation.interval import Interval, mean_interval
from evaluation.sweeps.plan import Sweep, Value
from evaluation.sweeps.table import Row

_MOST_LEVELS = 8
"""An axis with more values than twice this is looked at in so many parts."""


@dataclass(frozen=True, kw_only=True)
class Level:
    """The rows of one value of an axis, or of values near one another."""

    value: Value
    """Their value; of several numbers the mean."""
    rows: tuple[Row, ...]


def levels_of(sweep: Sweep, rows: Sequence[Row], axis: str) -> list[Level]:
    """The rows by the values of an axis, ascending; of `one_at_a_time` the rows that are steps on this axis."""
    own = [row for row in rows if row["axis"] == axis] if sweep.design == "one_at_a_time" else list(rows)
    groups: dict[Value, list[Row]] = {}
    for row in own:
        groups.setdefault(row[f"settings.{axis}"], []).append(row)
    numbers = sorted(value for value in groups if _is_number(value))
    if len(numbers) < len(groups):
        return [Level(value=value, rows=tuple(group)) for value, group in groups.items()]
    count = len(numbers) if len(numbers) <= 2 * _MOST_LEVELS else _MOST_LEVELS
    return [
        Level(value=float(np.mean(part)), rows=tuple(row for value in part for row in groups[value]))
        for part in np.array_split(np.array(numbers), count)
    ]


def interval_of(rows: Sequence[Row], score: str) -> Interval | None:
    """The mean of a score over the rows, with its interval over seeds; None where no row has it.

    Each seed counts with the mean over its rows, so that the interval says what another seed would change, and not how
    different the recordings are.
    """
    by_seed: dict[Any, list[float]] = {}
    for row in rows:
        if row.get(score) is not None:
            by_seed.setdefault(row["seed"], []).append(row[score])
    return mean_interval([fmean(values) for values in by_seed.values()])


def by(rows: Sequence[Row], column: str) -> Mapping[Any, list[Row]]:
    """The rows by what stands in a column."""
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        groups.setdefault(row[column], []).append(row)
    return groups


def _is_number(value: Value) -> TypeGuard[int | float]:
    return isinstance(value, int | float) and not isinstance(value, bool)
