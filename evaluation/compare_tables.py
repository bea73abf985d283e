"""Compared methods as text, Markdown, CSV and JSON."""

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from textwrap import fill
from typing import Any, Literal

from tabulate import tabulate

from evaluation.compare_plot import draw_hidden_time
from evaluation.hidden_time import EDGES_S, Span, spans_of
from evaluation.interval import Interval, mean_interval
from evaluation.outcome import Outcome, one_group
from evaluation.scores import Scores
from recording.atomic import whole_file
from recording.version import VERSION

Style = Literal["plain", "pipe"]
Cells = dict[str, str]
EVERYTHING = "all recordings"
NOTHING = "-"
NOTE = (
    "Means over the recordings, with the 95 % confidence interval of the mean (Student's t) where all are of one scene "
    "or family. n: recordings on which the method did not fail; its means are over these, or over those of them on "
    "which it has the number. found: share of the objects that a motion stands for. centre and points: "
    "mean error in hidden frames, cm, worth nothing without recall and surface (shares of what is hidden). link prec. "
    "and rec.: precision and recall of the links between segments. s: wall-clock seconds of processes that share the "
    "machine. The true_ methods are default with one stage that knows the truth."
)
_WIDTH = 120


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of the table."""

    key: str
    """Of the score, dotted."""
    scale: float = 1.0
    digits: int = 3


COLUMNS: Mapping[str, Column] = {
    "found": Column(key="found_share"),
    "purity": Column(key="motions.purity"),
    "inverse": Column(key="motions.inverse_purity"),
    "coverage": Column(key="coverage"),
    "HOTA": Column(key="identity.hota"),
    "IDF1": Column(key="identity.idf1"),
    "switches": Column(key="identity.id_switches", digits=1),
    "recall": Column(key="completion.recall"),
    "surface": Column(key="completion.surface_coverage_10cm"),
    "centre cm": Column(key="completion.centre_mean_m", scale=100.0, digits=1),
    "points cm": Column(key="completion.mean_m", scale=100.0, digits=1),
    "link prec.": Column(key="links.precision"),
    "link rec.": Column(key="links.recall"),
    "s": Column(key="seconds.total", digits=1),
}


def comparison_text(outcomes: Sequence[Outcome]) -> str:
    """A table for each scene or family, one for all recordings, one by the time hidden; then what failed."""
    parts = [f"{title}\n\n{_table(rows, 'plain')}" for title, rows in _titled(outcomes)]
    return "\n\n".join([*parts, fill(NOTE, _WIDTH), *_failures(outcomes)])


def comparison_markdown(outcomes: Sequence[Outcome]) -> str:
    """The same as a Markdown document."""
    parts = [f"## {title}\n\n{_table(rows, 'pipe')}" for title, rows in _titled(outcomes)]
    return "\n\n".join(["# Methods side by side", *parts, NOTE, *_failures(outcomes)]) + "\n"


def comparison_document(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Everything as one JSON object: means of all scores by group and method, and by the time hidden."""
    return {
        "version": VERSION,
        "interval": "mean +- half_width: 95 % confidence interval of the mean over recordings of a group, Student's t",
        "groups": {
            title: {
                method: {
                    "recordings": len(own),
                    "failed": sum(one.failure is not None for one in own),
                    "scores": {key: _as_json(interval) for key, interval in intervals_of(own).items()},
                }
                for method, own in _by(members, lambda one: one.method).items()
            }
            for title, members in groups_of(outcomes).items()
        },
        "by_hidden_seconds": [_span_as_json(span) for span in spans_of(outcomes)],
        "failures": [
            {"recording": one.recording, "method": one.method, "failure": one.failure}
            for one in outcomes
            if one.failure is not None
        ],
    }


def write_comparison(outcomes: Sequence[Outcome], folder: Path) -> None:
    """Write `comparison.json`, `.md` and `.csv` (all scores, a row an outcome), and the plot as PNG and SVG.

    They follow from the outcomes that are kept in the folder, so they replace what an earlier call left there.
    """
    texts = {
        "json": json.dumps(comparison_document(outcomes), indent=1, allow_nan=False) + "\n",
        "md": comparison_markdown(outcomes),
    }
    for ending, text in texts.items():
        with whole_file(folder / f"comparison.{ending}", overwrite=True) as partial:
            partial.write_text(text, encoding="utf-8")
    records = [_record(outcome) for outcome in outcomes]
    names = list(dict.fromkeys(name for record in records for name in record))
    with (
        whole_file(folder / "comparison.csv", overwrite=True) as partial,
        partial.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, fieldnames=names)
        writer.writeheader()
        writer.writerows(records)
    for ending in ("png", "svg"):
        draw_hidden_time(spans_of(outcomes), folder / f"hidden_time.{ending}", overwrite=True)


def groups_of(outcomes: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    """The outcomes by scene or family, and all of them where there are several."""
    groups = _by(outcomes, lambda one: one.group)
    return groups | {EVERYTHING: list(outcomes)} if len(groups) > 1 else groups


def intervals_of(outcomes: Sequence[Outcome]) -> dict[str, Interval | None]:
    """The mean of every score by dotted key over the outcomes that have it; of several groups without intervals."""
    flat = [flattened(outcome.scores) for outcome in outcomes if outcome.scores is not None]
    words = {key for scores in flat for key, value in scores.items() if isinstance(value, str)}
    keys = dict.fromkeys(key for scores in flat for key in scores if key not in words)
    alike = one_group(outcomes)
    return {key: mean_interval([scores.get(key) for scores in flat], alike=alike) for key in keys}


def flattened(scores: Scores) -> Scores:
    """The scores by dotted key, and `found_share`: the share of the objects that were found; lists are left out."""
    flat: Scores = {}
    for name, value in scores.items():
        inner = {f"{name}.{key}": each for key, each in value.items()} if isinstance(value, dict) else {name: value}
        flat |= {key: each for key, each in inner.items() if not isinstance(each, list)}
    objects, found = flat["objects"], flat["motions.found"]
    return flat | {"found_share": found / objects if objects and found is not None else None}


def _titled(outcomes: Sequence[Outcome]) -> list[tuple[str, list[Cells]]]:
    tables = []
    for title, members in groups_of(outcomes).items():
        count = len(dict.fromkeys(one.recording for one in members))
        rows = [_cells(method, own) for method, own in _by(members, lambda one: one.method).items()]
        tables.append((f"{title}: {count} recording{'s' * (count > 1)}", rows))
    hidden = [_span_cells(span) for span in spans_of(outcomes)]
    return [*tables, ("By the time hidden", hidden)] if hidden else tables


def _cells(method: str, outcomes: Sequence[Outcome]) -> Cells:
    intervals = intervals_of(outcomes)
    failed = sum(one.failure is not None for one in outcomes)
    cells = {name: _cell(intervals.get(column.key), column) for name, column in COLUMNS.items()}
    name = f"{method} ({failed} failed)" if failed else method
    return {"method": name, "n": str(len(outcomes) - failed), **cells}


def _span_cells(span: Span) -> Cells:
    error = Column(key="", scale=100.0, digits=1)
    return {
        "method": span.method,
        "hidden": span.name,
        "object-frames": str(span.object_frames),
        "recordings": str(span.recall.count),
        "recall": _cell(span.recall, Column(key="")),
        "centre cm": _cell(span.centre_m, error),
        "points cm": _cell(span.points_m, error),
    }


def _cell(interval: Interval | None, column: Column) -> str:
    if interval is None:
        return NOTHING
    mean = f"{interval.mean * column.scale:.{column.digits}f}"
    if interval.half_width is None:
        return mean
    return f"{mean} ±{interval.half_width * column.scale:.{column.digits}f}"


def _table(rows: Sequence[Cells], style: Style) -> str:
    return tabulate(rows, headers="keys", tablefmt=style, disable_numparse=True)


def _failures(outcomes: Sequence[Outcome]) -> list[str]:
    lines = [f"{one.method} failed on {one.recording}: {one.failure}" for one in outcomes if one.failure is not None]
    return ["\n".join(lines)] if lines else []


def _by(outcomes: Sequence[Outcome], key: Callable[[Outcome], str]) -> dict[str, list[Outcome]]:
    parts: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        parts.setdefault(key(outcome), []).append(outcome)
    return parts


def _record(outcome: Outcome) -> dict[str, Any]:
    known = {"group": outcome.group, "recording": outcome.recording, "seed": outcome.seed}
    scores = flattened(outcome.scores) if outcome.scores is not None else {}
    return {**known, "method": outcome.method, "failure": outcome.failure, **scores}


def _as_json(interval: Interval | None) -> dict[str, Any] | None:
    return None if interval is None else asdict(interval)


def _span_as_json(span: Span) -> dict[str, Any]:
    return {
        "method": span.method,
        "begin_s": span.begin_s,
        "end_s": None if span.end_s == EDGES_S[-1] else span.end_s,
        "object_frames": span.object_frames,
        "recall": _as_json(span.recall),
        "centre_m": _as_json(span.centre_m),
        "points_m": _as_json(span.points_m),
    }
