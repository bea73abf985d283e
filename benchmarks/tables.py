"""How every benchmark runs, and what it prints: a table for people, or with --json one object for programs."""

import json
import sys
from pathlib import Path
from typing import Any

from cyclopts import App
from rich.console import Console
from rich.table import Table

from commands import common

Row = dict[str, Any]


def run(app: App) -> None:
    """Run a benchmark, which ends as a command of `unocclude` does: wrong input is one line and exit status 2."""
    common.run(app, name=Path(sys.argv[0]).name)


def show(title: str, rows: list[Row], *, as_json: bool) -> None:
    """Print the rows, whose keys are the columns; None is a dash."""
    if as_json:
        print(json.dumps(document(title, rows), allow_nan=False))
        return
    table = Table(title=title, title_justify="left")
    columns = list(dict.fromkeys(name for row in rows for name in row))
    for name in columns:
        table.add_column(name, justify="left" if isinstance(rows[0].get(name), str) else "right")
    for row in rows:
        table.add_row(*(_cell(row.get(name)) for name in columns))
    Console(width=max(80, 14 * len(columns))).print(table)


def document(title: str, rows: list[Row]) -> dict[str, Any]:
    """A table as JSON has it."""
    return {"title": title, "rows": rows}


def score_row(scores: dict[str, Any]) -> Row:
    """The scores that the tables of this folder have in common; lengths in centimetres."""
    motions, completion = scores["motions"], scores["completion"]
    return {
        "found": f"{_cell(motions['found'])} of {scores['objects']}",
        "motions": motions["count"],
        "purity": motions["purity"],
        "inverse": motions["inverse_purity"],
        "coverage": scores["coverage"],
        "IDF1": scores["identity"]["idf1"],
        "holes": scores["holes"],
        "longest": scores["longest_hole_frames"],
        "recall": completion["recall"],
        "centre cm": _centimetres(completion["centre_mean_m"]),
        "max cm": _centimetres(completion["centre_max_m"]),
        "points cm": _centimetres(completion["mean_m"]),
        "seconds": scores["seconds"]["total"],
    }


def mean_row(rows: list[Row]) -> Row:
    """The mean of every column of numbers, over the rows that have one."""
    mean: Row = {}
    for name in rows[0]:
        values = [row[name] for row in rows if isinstance(row[name], int | float)]
        mean[name] = sum(values) / len(values) if values else ""
    return mean


def _centimetres(metres: float | None) -> float | None:
    return None if metres is None else 100 * metres


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    return (
        f"{value:.3g}"
        if isinstance(value, float) and abs(value) >= 1
        else f"{value:.3f}"
        if isinstance(value, float)
        else str(value)
    )
