"""The page of a comparison: the folder that `unocclude compare` leaves."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from evaluation.compare_tables import COLUMNS, NOTE, Column
from evaluation.figures.panels import draw_curve
from evaluation.outcome import Outcome
from evaluation.report.definitions import NOTHING, meaning_of
from evaluation.report.images import drawn, stored
from evaluation.report.page import Card, Cards, Fold, Page, Picture, Section, Table, Text
from recording.checks import json_document, validated
from recording.errors import InputError
from recording.motions import mean_places
from recording.parquet import load_motions

COMPARISON = "comparison.json"
_SHOWN = 6
"""The worst outcomes, with pictures."""
_SHOWN_DIGITS = 16
"""Of a digest."""
_BAD_BELOW = 1.0
"""Share of the objects found."""
Record = Mapping[str, str]


def comparison_page(folder: Path) -> Page:
    """The worst outcomes, tables by group and by the time hidden, the plot, every recording, what the scores mean."""
    document, records = json_document(folder / COMPARISON), _records(folder / "comparison.csv")
    try:
        groups, spans, failures = document["groups"], document["by_hidden_seconds"], document["failures"]
        tables = tuple(_group_table(title, methods) for title, methods in groups.items())
        hidden = _hidden_table(spans)
    except (KeyError, TypeError, AttributeError):
        raise InputError(f"{folder / COMPARISON}: expected what 'unocclude compare' writes: compare again") from None
    methods = list(dict.fromkeys(record["method"] for record in records))
    places = list(dict.fromkeys(record["recording"] for record in records))
    plot = folder / "hidden_time.svg"
    caption = "Recall and errors by how long somebody was hidden; those with a stage that knows the truth are dashed."
    sections = (
        _failures_section(folder, records, failures),
        Section(key="tables", title="Side by side", lead=NOTE, blocks=tables),
        Section(
            key="hidden",
            title="By the time hidden",
            blocks=(*((stored(plot, alt=caption, caption=caption),) if plot.is_file() else ()), hidden),
        ),
        Section(key="recordings", title="Every recording", blocks=(_records_table(records),)),
        _meanings_section(),
        _making_section(folder, records),
    )
    return Page(
        title="Methods side by side",
        subtitle=f"{', '.join(methods)} on {len(places)} recording{'' if len(places) == 1 else 's'}; "
        f"Unocclude {document.get('version', NOTHING)}",
        sections=sections,
    )


def _records(path: Path) -> list[Record]:
    try:
        with path.open(encoding="utf-8", newline="") as file:
            records: list[Record] = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError):
        raise InputError(f"{path}: expected what 'unocclude compare' writes: compare again") from None
    if any(not {"recording", "method", "failure"} <= set(record) for record in records):
        raise InputError(f"{path}: expected columns 'recording', 'method' and 'failure': compare again")
    return records


def _failures_section(folder: Path, records: list[Record], failures: list[dict[str, str]]) -> Section:
    """What failed, then the outcomes with the fewest objects found, then those with the largest errors."""
    failed = [Text(words=f"{one['method']} failed on {one['recording']}: {one['failure']}") for one in failures]
    scored = sorted((record for record in records if not record["failure"]), key=_badness)
    cards = tuple(_card(folder, record) for record in scored[:_SHOWN])
    heading = f"The worst {len(cards)} of {len(scored)} outcomes"
    return Section(
        key="failures",
        title="Failures first",
        lead="Fewest objects found first, then the largest error of what was hidden. The paths are seen from above, or "
        "in the camera's axes right and forward; dotted where they were completed.",
        blocks=(*failed, Cards(title=heading, items=cards)) if cards else (*failed, Text(words="Nothing was scored.")),
    )


def _badness(record: Record) -> tuple[float, float]:
    found, centre = _value(record, "found_share"), _value(record, "completion.centre_mean_m")
    return 2.0 if found is None else found, 0.0 if centre is None else -centre


def _card(folder: Path, record: Record) -> Card:
    share = _value(record, "found_share")
    shown = {name: _cell(_value(record, column.key), column) for name, column in COLUMNS.items()}
    words = (
        f"Found {shown['found']} of the objects, IDF1 {shown['IDF1']}; of what is hidden: recall {shown['recall']}, "
        f"centre off by {shown['centre cm']} cm, points by {shown['points cm']} cm."
    )
    return Card(
        title=f"{record['method']} on {record['recording']}",
        words=words,
        picture=_picture(folder, record),
        bad=share is not None and share < _BAD_BELOW,
    )


def _picture(folder: Path, record: Record) -> Picture | None:
    """The paths that the method found, from above; none where its motions are not in the folder."""
    name = Path(record["recording"]).name
    found = sorted(folder.glob(f"{name}-*/{record['method']}/motions.parquet"))
    if not found:
        return None
    motions = load_motions(found[-1])
    curves = motions.representatives or mean_places(motions)

    def figure() -> Figure:
        made = Figure(figsize=(6.0, 3.6), layout="constrained")
        axes = made.subplots()
        for curve in curves:
            draw_curve(axes, curve.position[:, :2], curve)
        axes.set(xlabel="x [m]", ylabel="y [m]", title=f"{len(curves)} motions")
        axes.set_aspect("equal", adjustable="datalim")
        return made

    return drawn(figure, alt=f"The paths that {record['method']} found on {record['recording']}.")


def _group_table(title: str, methods: Mapping[str, Mapping[str, Any]]) -> Table:
    rows = tuple(
        (
            method if not one["failed"] else f"{method} ({one['failed']} failed)",
            str(one["recordings"] - one["failed"]),
            *(_interval(one["scores"].get(column.key), column) for column in COLUMNS.values()),
        )
        for method, one in methods.items()
    )
    return Table(caption=title, head=("method", "n", *COLUMNS), rows=rows)


def _hidden_table(spans: list[dict[str, Any]]) -> Table:
    length = Column(key="", scale=100.0, digits=1)
    rows = tuple(
        (
            span["method"],
            f"over {span['begin_s']:g} s" if span["end_s"] is None else f"{span['begin_s']:g} to {span['end_s']:g} s",
            str(span["object_frames"]),
            _interval(span["recall"], Column(key="")),
            _interval(span["centre_m"], length),
            _interval(span["points_m"], length),
        )
        for span in spans
    )
    head = ("method", "hidden for", "object-frames", "recall", "centre [cm]", "points [cm]")
    return Table(caption="By the time hidden", head=head, rows=rows)


def _records_table(records: list[Record]) -> Table:
    rows = tuple(
        (
            record["recording"],
            record["method"],
            *(_cell(_value(record, column.key), column) for column in COLUMNS.values()),
        )
        for record in records
    )
    return Table(caption="Every recording and method", head=("recording", "method", *COLUMNS), rows=rows)


def _meanings_section() -> Section:
    known = {name: column for name, column in COLUMNS.items() if "." in column.key and "seconds" not in column.key}
    rows = tuple((name, meaning_of(column.key).words) for name, column in known.items())
    table = Table(caption="Columns", head=("column", "meaning"), rows=rows, words=frozenset({1}))
    return Section(key="meaning", title="What the scores mean", blocks=(table,))


def _making_section(folder: Path, records: list[Record]) -> Section:
    """Which recordings, versions and settings the outcomes are of, as far as the folder still holds them."""
    rows: list[tuple[str, ...]] = []
    settings: dict[tuple[str, str], dict[str, Any]] = {}
    for record in records:
        name, method = Path(record["recording"]).name, record["method"]
        for place in sorted(folder.glob(f"{name}-*/{method}/outcome.json"))[-1:]:
            made_of = validated(Outcome, json_document(place), source=str(place)).made_of
            digests = (made_of.recording_digest[:_SHOWN_DIGITS], made_of.code[:_SHOWN_DIGITS])
            rows.append((record["recording"], method, made_of.version, *digests))
            settings.setdefault((method, name), made_of.settings)
    head = ("recording", "method", "version", "recording digest", "code digest")
    first = {method: (name, known) for (method, name), known in reversed(settings.items())}
    folds = [
        Fold(
            title=f"Settings of {method} (on {name})",
            blocks=(
                Table(
                    caption=method,
                    head=("setting", "value"),
                    rows=tuple((key, str(value)) for key, value in known.items()),
                    words=frozenset({1}),
                ),
            ),
        )
        for method, (name, known) in reversed(first.items())
    ]
    table = Table(caption="Made of", head=head, rows=tuple(rows), words=frozenset({1}))
    return Section(key="making", title="What was run", blocks=(table, *folds))


def _interval(interval: Mapping[str, Any] | None, column: Column) -> str:
    if interval is None:
        return NOTHING
    half = interval["half_width"]
    width = "" if half is None else f" ±{half * column.scale:.{column.digits}f}"
    return _cell(interval["mean"], column) + width


def _cell(value: float | None, column: Column) -> str:
    return NOTHING if value is None else f"{value * column.scale:.{column.digits}f}"


def _value(record: Record, key: str) -> float | None:
    text = record.get(key) or ""
    try:
        return float(text) if text else None
    except ValueError:
        return None
