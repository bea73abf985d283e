"""Table 1 as text, Markdown, LaTeX and CSV."""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import Any, Literal

from tabulate import tabulate

from evaluation.paper_rows import PaperRow
from evaluation.scores import Scores
from evaluation.table1 import OwnRow, Result, Row, misses, points_deviation
from recording.atomic import whole_file
from recording.errors import InputError

NOTHING = "-"
"""Stands for a number that cannot be computed; in CSV an empty cell does."""
Style = Literal["plain", "pipe", "latex_booktabs"]
Cells = dict[str, str]


@dataclass(frozen=True, kw_only=True)
class Table:
    """One of the tables that Table 1 falls into."""

    title: str
    rows: list[Cells]
    """The keys are the columns."""
    note: str

    def text(self, style: Style) -> str:
        """The rows and columns; numbers stand as they are written."""
        return tabulate(self.rows, headers="keys", tablefmt=style, disable_numparse=True)


COUNTED = (
    "In each cell the paper's number / ours; missed are the columns outside the tolerances (frames, objects, static "
    "and holes exact, points within 15 %, longest hole within 2 frames). The paper prints 4 objects for its five "
    "juggled balls: 5 here."
)
FOUND = (
    "Seg, Flow and Total are the paper's / ours. The paper's times have no unit and are of an Intel i5-4430; ours are "
    "seconds of wall clock on this machine. e1 to e5 are those that were used; with the preset paper they are the "
    "paper's. Beyond the paper: motions found, of the objects, and motions in all; purity and inverse purity of the "
    "motions on points; errors of centres and points in hidden frames, centimetres."
)
FILES = ("table1.md", "table1.tex", "table1.csv")
_WIDTH = 120
"""Characters in a line of notes."""


def tables_of(rows: Sequence[Row]) -> list[Table]:
    """What the scenes hold, then what every preset finds in them."""
    tables = [Table(title="What the scenes hold", rows=[_counts(row.paper, row.own) for row in rows], note=COUNTED)]
    for number, result in enumerate(rows[0].results if rows else ()):
        found = [_findings(row.paper, row.results[number]) for row in rows]
        failures = [row.results[number].failure for row in rows]
        if any(failures):
            found = [cells | {"failure": failure or NOTHING} for cells, failure in zip(found, failures, strict=True)]
        tables.append(Table(title=f"What is found with the preset {result.preset}", rows=found, note=FOUND))
    return tables


def text_of(tables: Sequence[Table]) -> str:
    """The tables as text in aligned columns, each followed by its notes."""
    return "\n\n".join(f"{table.title}\n\n{table.text('plain')}\n\n{fill(table.note, _WIDTH)}" for table in tables)


def markdown_of(tables: Sequence[Table]) -> str:
    """The tables as a Markdown document."""
    parts = ["# Table 1, the paper's and ours"]
    for table in tables:
        parts += [f"## {table.title}", table.text("pipe"), table.note]
    return "\n\n".join(parts) + "\n"


def latex_of(tables: Sequence[Table]) -> str:
    """The tables as LaTeX for a paper to put in; they need the package booktabs."""
    parts = ["% Needs \\usepackage{booktabs}."]
    for table in tables:
        caption = f"{table.title}. {table.note}".replace("%", "\\%")
        lines = ["\\begin{table*}", "\\centering\\scriptsize\\setlength{\\tabcolsep}{3pt}", f"\\caption{{{caption}}}"]
        parts.append("\n".join([*lines, table.text("latex_booktabs"), "\\end{table*}"]))
    return "\n\n".join(parts) + "\n"


def require_no_tables(folder: Path, *, overwrite: bool = False) -> None:
    """InputError where the folder holds tables that are not to be replaced: known before hours of work."""
    existing = next((folder / name for name in FILES if (folder / name).exists()), None)
    if existing is not None and not overwrite:
        raise InputError(f"{existing} exists already: choose another place, or pass --overwrite to replace it")


def write_tables(rows: Sequence[Row], folder: Path, *, overwrite: bool = False) -> None:
    """Write `table1.md`, `table1.tex` and `table1.csv` into the folder."""
    tables = tables_of(rows)
    for name, text in zip(FILES, (markdown_of(tables), latex_of(tables), csv_of(rows)), strict=True):
        with whole_file(folder / name, overwrite=overwrite) as partial:
            partial.write_text(text, encoding="utf-8")


def csv_of(rows: Sequence[Row]) -> str:
    """The rows as CSV, a line a scene and preset, in metres and seconds."""
    records = [record for row in rows for record in records_of(row)]
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(records[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return text.getvalue()


def records_of(row: Row) -> list[dict[str, Any]]:
    """The row as plain values, one record a preset (one without, if there is none); None where there is no number."""
    paper, own = row.paper, row.own
    counts = {
        **{"test": paper.test, "scene": paper.scene, "frames": own.frames, "points": own.points},
        **{"objects": own.objects, "static": own.static, "holes": own.holes, "longest_hole_frames": own.longest},
        "missed": " ".join(name.replace(" ", "_") for name in misses(paper, own)),
        **{"paper_frames": paper.frames, "paper_points_least": paper.points[0], "paper_points_most": paper.points[1]},
        **{"paper_objects": paper.objects, "paper_static": paper.static, "paper_holes": paper.holes},
        **{"paper_longest_hole_frames": paper.longest, "paper_segments": paper.segments},
        **{"paper_flow": paper.flow, "paper_total": paper.total},
        **{f"paper_eps{number}": value for number, value in enumerate(paper.epsilons, start=1)},
    }
    return [counts | _record(result) for result in row.results] or [counts]


def _record(result: Result) -> dict[str, Any]:
    return {
        "preset": result.preset,
        **_numbers(result.scores),
        **{f"eps{number}": value for number, value in enumerate(result.epsilons, start=1)},
        "failure": result.failure,
    }


def _numbers(scores: Scores | None) -> dict[str, Any]:
    """What the table takes from the scores; None where there are none."""
    wanted = {
        "segments": ("segments", "count"),
        "flow_s": ("seconds", "flow"),
        "total_s": ("seconds", "total"),
        "motions_found": ("motions", "found"),
        "motions": ("motions", "count"),
        "purity": ("motions", "purity"),
        "inverse_purity": ("motions", "inverse_purity"),
        "centre_mean_m": ("completion", "centre_mean_m"),
        "centre_max_m": ("completion", "centre_max_m"),
        "points_mean_m": ("completion", "mean_m"),
    }
    return {name: None if scores is None else scores[family][key] for name, (family, key) in wanted.items()}


def _counts(paper: PaperRow, own: OwnRow) -> Cells:
    low, high = paper.points
    points = f"{low}" if low == high else f"{low}-{high}"
    more = "+" if paper.at_least else ""
    return {
        "test": paper.test,
        "scene": paper.scene,
        "Fr": f"{paper.frames} / {own.frames}",
        "Pts": f"{points} / {own.points:.0f} ({100 * points_deviation(paper, own):+.0f} %)",
        "Obj": f"{paper.objects} / {own.objects}",
        "Stat": f"{paper.static} / {own.static}",
        "Occ": f"{paper.holes}{more} / {own.holes}",
        "Max Occ": f"{paper.longest} / {own.longest}",
        "missed": ", ".join(misses(paper, own)) or NOTHING,
    }


def _findings(paper: PaperRow, result: Result) -> Cells:
    number = _numbers(result.scores)
    objects = "" if result.scores is None else f" of {_cell(result.scores['objects'])}"
    return {
        "test": paper.test,
        "Seg": f"{paper.segments} / {_cell(number['segments'])}",
        "Flow": f"{paper.flow} / {_cell(number['flow_s'], '.1f')}",
        "Total": f"{paper.total} / {_cell(number['total_s'], '.1f')}",
        **{f"e{place}": f"{value:g}" for place, value in enumerate(result.epsilons, start=1)},
        "found": f"{_cell(number['motions_found'])}{objects}",
        "motions": _cell(number["motions"]),
        "purity": _cell(number["purity"], ".3f"),
        "inverse": _cell(number["inverse_purity"], ".3f"),
        "centre mean": _centimetres(number["centre_mean_m"]),
        "centre max": _centimetres(number["centre_max_m"]),
        "points mean": _centimetres(number["points_mean_m"]),
    }


def _cell(value: float | int | None, form: str = "") -> str:
    return NOTHING if value is None else format(value, form)


def _centimetres(metres: float | None) -> str:
    return NOTHING if metres is None else f"{100 * metres:.1f}"
