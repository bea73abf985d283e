"""What is wanted of each scene, and how what was reached is held against it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.tables import Row
from evaluation.compare_tables import flattened
from evaluation.outcome import Outcome

SCENES = ("wall", "house", "forest", "4men", "9men", "juggler3", "juggler5", "scan1", "scan2", "scan3")
FAILURE_SCENES = ("in_step", "u_turn", "swap", "stop", "catch", "throw")
"""Those in which common fate or good continuation fail; nothing is asked of their numbers."""
FOUND = "all found"
"""Share of the recordings in which every object is found."""


@dataclass(frozen=True, kw_only=True)
class Column:
    """A number of the table: the mean over a scene's recordings."""

    key: str
    """Of the score, dotted."""
    scale: float = 1.0
    more_is_better: bool = True
    digits: int = 3


COLUMNS: Mapping[str, Column] = {
    "purity": Column(key="motions.purity"),
    "inverse": Column(key="motions.inverse_purity"),
    "IDF1": Column(key="identity.idf1"),
    "centre cm": Column(key="completion.centre_mean_m", scale=100.0, more_is_better=False, digits=1),
    "max cm": Column(key="completion.centre_max_m", scale=100.0, more_is_better=False, digits=1),
    "points cm": Column(key="completion.mean_m", scale=100.0, more_is_better=False, digits=1),
    "coverage": Column(key="coverage"),
    "recall": Column(key="completion.recall"),
    "surface": Column(key="completion.surface_coverage_10cm"),
    "too many": Column(key="too_many", more_is_better=False, digits=1),
}
"""Beside the share of recordings in which all is found."""


def _wanted(found: float, *values: float | None, coverage: float = 0.75) -> dict[str, float]:
    """The targets of a scene: those of its row, in the order of the columns, and those of all scenes."""
    row = dict(zip(COLUMNS, values, strict=False))
    everywhere = {"coverage": coverage, "recall": 0.85, "surface": 0.6, "too many": 1.0}
    return {FOUND: found} | {name: value for name, value in row.items() if value is not None} | everywhere


TARGETS: Mapping[str, Mapping[str, float]] = {
    "wall": _wanted(1.0, 0.99, 0.97, 0.97, 10, 20, 10),
    "house": _wanted(1.0, 0.99, 0.97, 0.97, 10, 20, 10, coverage=0.65),  # Its points move fastest.
    "forest": _wanted(1.0, 0.99, 0.95, 0.97, 8, 16, 12),
    "4men": _wanted(0.9, 0.98, 0.95, 0.93, 12, 30, 10),
    "9men": _wanted(0.9, 0.99, 0.95, 0.96, 10, 20, 8),
    **dict.fromkeys(("juggler3", "juggler5"), _wanted(0.8, 0.97, 0.90, 0.90, 8, 20)),
    **dict.fromkeys(("scan1", "scan2", "scan3"), _wanted(0.9, 0.97, 0.90, 0.90, 15, 30)),
}
"""By scene: the least of what should be large, the most of what should be small; lengths in centimetres."""


def scene_means(outcomes: Sequence[Outcome]) -> dict[str, Row]:
    """By scene: the recordings, the share in which all is found, and the mean of each number over those that have it.

    A recording on which the method failed has nothing found. The maximum of hidden centres is each recording's own,
    averaged.
    """
    rows: dict[str, Row] = {}
    for scene in dict.fromkeys(outcome.name for outcome in outcomes):
        own = [outcome for outcome in outcomes if outcome.name == scene]
        flat = [_with_too_many(flattened(outcome.scores)) for outcome in own if outcome.scores is not None]
        whole = sum(scores["motions.found"] == scores["objects"] for scores in flat)
        rows[scene] = {"recordings": len(own), FOUND: whole / len(own)}
        for name, column in COLUMNS.items():
            known = [scores[column.key] for scores in flat if scores.get(column.key) is not None]
            rows[scene][name] = column.scale * sum(known) / len(known) if known else None
    return rows


def judged(scene: str, row: Row, wanted: Mapping[str, float] | None) -> Row:
    """The row with its `targets`, and the names of those that are `missed`; what cannot be computed misses its own."""
    missed = [name for name, target in (wanted or {}).items() if not _met(name, row[name], target)]
    return {"scene": scene, **row, "targets": dict(wanted or {}), "missed": missed}


def printed(row: Row) -> Row:
    """The judged row for people: each missed number with its target beside it, and how many are met."""
    cells: Row = {"scene": row["scene"]}
    for name in (FOUND, *COLUMNS):
        cells[name] = _cell(name, row)
        if name in row["missed"]:
            cells[name] += f" ({'<' if _more_is_better(name) else '>'} {row['targets'][name]:g})"
    met = len(row["targets"]) - len(row["missed"])
    return cells | {"met": f"{met} of {len(row['targets'])}" if row["targets"] else "-"}


def tracker_factors(means: Mapping[str, Mapping[str, Row]]) -> list[Row]:
    """By scene, the tracker's mean error of hidden centres over ours; last, the mean of these factors."""
    rows: list[Row] = []
    for scene, ours in means["default"].items():
        theirs = means["tracker"][scene]["centre cm"]
        if ours["centre cm"] and theirs is not None:
            factor = theirs / ours["centre cm"]
            rows.append({"scene": scene, "ours cm": ours["centre cm"], "tracker cm": theirs, "factor": factor})
    if rows:
        rows.append({"scene": "mean", "factor": sum(row["factor"] for row in rows) / len(rows)})
    return rows


def _with_too_many(scores: Row) -> Row:
    """The scores, and by how many the motions outnumber the objects."""
    return scores | {"too_many": max(scores["motions.count"] - scores["objects"], 0)}


def _met(name: str, value: float | None, wanted: float) -> bool:
    if value is None:
        return False
    return value >= wanted - 1e-9 if _more_is_better(name) else value <= wanted + 1e-9


def _more_is_better(name: str) -> bool:
    return name == FOUND or COLUMNS[name].more_is_better


def _cell(name: str, row: Row) -> str:
    if row[name] is None:
        return "-"
    if name == FOUND:
        return f"{round(row[FOUND] * row['recordings'])} of {row['recordings']}"
    return f"{row[name]:.{COLUMNS[name].digits}f}"
