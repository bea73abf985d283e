"""A mean with what is known of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

LEVEL = 0.95


@dataclass(frozen=True, kw_only=True)
class Interval:
    """A mean over recordings, and how far it is to be trusted."""

    mean: float
    half_width: float | None
    """Half of the 95 % confidence interval of the mean; None for a single value, or recordings of several kinds."""
    count: int
    """Values that the mean is of."""


def mean_interval(values: Sequence[float | int | None], *, alike: bool = True) -> Interval | None:
    """The mean of the values that are there, with its confidence interval if they are `alike`; None without any.

    The interval is mean +- t s / sqrt(n): s the standard deviation of the n values, t the 97.5 % quantile of Student's
    distribution with n - 1 degrees of freedom. It is one for the mean over recordings of the same kind (`alike`); of a
    share it may reach beyond 0 and 1.
    """
    known = np.array([value for value in values if value is not None], float)
    if not len(known):
        return None
    half_width = None
    if alike and len(known) > 1:
        half_width = float(stats.t.ppf((1 + LEVEL) / 2, len(known) - 1) * stats.sem(known))
    return Interval(mean=float(known.mean()), half_width=half_width, count=len(known))
