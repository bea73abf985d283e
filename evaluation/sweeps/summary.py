"""What a sweep has found: the best setting, what is known of it, and how much each parameter matters."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tabulate import tabulate

from evaluation.interval import Interval
from evaluation.sweeps.levels import by, interval_of, levels_of
from evaluation.sweeps.plan import Sweep, points_of
from evaluation.sweeps.table import Row
from evaluation.sweeps.worth import less_is_better
from recording.atomic import whole_file
from recording.version import VERSION

_LISTED = 10
"""Points of the table of the best."""


@dataclass(frozen=True, kw_only=True)
class Standing:
    """What a point of the sweep has reached."""

    point: int
    values: dict[str, Any]
    """Of the axes; empty for the preset itself."""
    goal: Interval | None
    """Mean over its recordings, and the interval over seeds; None where no recording has the score."""
    failed: int
    """Recordings on which it failed."""


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """How much a parameter matters within its range."""

    axis: str
    effect: float | None
    """The greatest mean of the goal over the parameter's values less the least."""
    share: float | None
    """Of the variance of the goal over all points that which the parameter alone explains (first-order Sobol index).

    The variance of the means over the parameter's values, by the variance of the points' means. None for
    `one_at_a_time`, which has no combinations.
    """


@dataclass(frozen=True, kw_only=True)
class Summary:
    """What there is to say of a sweep."""

    sweep: Sweep
    standings: tuple[Standing, ...]
    """From the best point to the worst; those with failures after all others."""
    sensitivities: tuple[Sensitivity, ...]
    """From the greatest effect to the least."""
    rows: int
    failures: tuple[str, ...]
    """A sentence for each row that failed."""


def summary_of(sweep: Sweep, rows: Sequence[Row]) -> Summary:
    """The summary of the sweep's rows."""
    sign = 1.0 if less_is_better(sweep.goal) else -1.0
    points, groups = points_of(sweep), by(rows, "point")
    standings = [
        Standing(
            point=point.number,
            values=dict(point.values),
            goal=interval_of(groups[point.number], sweep.goal),
            failed=sum(row["failure"] is not None for row in groups[point.number]),
        )
        for point in points
    ]
    standings.sort(key=lambda one: (one.failed, np.inf if one.goal is None else sign * one.goal.mean))
    sensitivities = [_sensitivity(sweep, rows, axis) for axis in sweep.axes]
    sensitivities.sort(key=lambda one: -(one.effect or 0.0))
    failures = [f"point {row['point']} on {row['recording']}: {row['failure']}" for row in rows if row["failure"]]
    return Summary(
        sweep=sweep,
        standings=tuple(standings),
        sensitivities=tuple(sensitivities),
        rows=len(rows),
        failures=tuple(failures),
    )


def summary_text(summary: Summary) -> str:
    """The summary as Markdown, which reads well on a terminal too."""
    sweep, best = summary.sweep, summary.standings[0]
    recordings = summary.rows // len(summary.standings)
    lines = [
        f"# {sweep.name}",
        *([sweep.description] if sweep.description else []),
        f"{len(summary.standings)} points ({sweep.design}, preset {sweep.preset}) on {recordings} recordings; "
        f"{len(summary.failures)} of {summary.rows} failed.",
        f"Best {sweep.goal}: {_interval(best.goal)} with {_values(best.values)}.",
        _table(("point", "settings", sweep.goal, "failed"), [_standing(one) for one in summary.standings[:_LISTED]]),
        f"How much each parameter matters: the difference that it makes to the mean of {sweep.goal} (effect), and its "
        "share of the variance over all points (first-order Sobol index).",
        _table(
            ("parameter", "effect", "share"),
            [(one.axis, _number(one.effect), _number(one.share)) for one in summary.sensitivities],
        ),
        "±: 95 % confidence interval over seeds, Student's t.",
        *summary.failures,
    ]
    return "\n\n".join(lines) + "\n"


def summary_document(summary: Summary) -> dict[str, Any]:
    """The summary as one JSON object."""
    return {
        "version": VERSION,
        "sweep": summary.sweep.model_dump(mode="json", by_alias=True),
        "best": asdict(summary.standings[0]),
        "standings": [asdict(one) for one in summary.standings],
        "sensitivity": [asdict(one) for one in summary.sensitivities],
        "rows": summary.rows,
        "failures": list(summary.failures),
    }


def write_summary(summary: Summary, folder: Path) -> None:
    """Write `summary.md` and `summary.json`."""
    texts = {
        "md": summary_text(summary),
        "json": json.dumps(summary_document(summary), indent=1, allow_nan=False) + "\n",
    }
    for ending, text in texts.items():
        with whole_file(folder / f"summary.{ending}", overwrite=True) as partial:
            partial.write_text(text, encoding="utf-8")


def _sensitivity(sweep: Sweep, rows: Sequence[Row], axis: str) -> Sensitivity:
    levels = [(interval_of(level.rows, sweep.goal), len(level.rows)) for level in levels_of(sweep, rows, axis)]
    known = [(one.mean, count) for one, count in levels if one is not None]
    if not known:
        return Sensitivity(axis=axis, effect=None, share=None)
    means, weights = np.array(known).T
    share = None if sweep.design == "one_at_a_time" else _explained(means, weights, _point_means(sweep, rows))
    return Sensitivity(axis=axis, effect=float(np.ptp(means)), share=share)


def _point_means(sweep: Sweep, rows: Sequence[Row]) -> np.ndarray:
    intervals = (interval_of(group, sweep.goal) for group in by(rows, "point").values())
    return np.array([one.mean for one in intervals if one is not None])


def _explained(means: np.ndarray, weights: np.ndarray, points: np.ndarray) -> float | None:
    total = float(points.var())
    centre = np.average(means, weights=weights)
    return float(np.average((means - centre) ** 2, weights=weights)) / total if total > 0 else None


def _standing(one: Standing) -> tuple[str, ...]:
    return str(one.point), _values(one.values), _interval(one.goal), str(one.failed)


def _values(values: dict[str, Any]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in values.items()) or "the preset's values"


def _interval(interval: Interval | None) -> str:
    if interval is None:
        return "-"
    return _number(interval.mean) + (f" ±{interval.half_width:.3f}" if interval.half_width is not None else "")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return tabulate(rows, headers=head, tablefmt="pipe", disable_numparse=True)
