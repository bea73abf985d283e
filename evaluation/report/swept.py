"""The page of a sweep: the folder that `unocclude sweep` leaves."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from evaluation.report.definitions import FAMILIES, NOTHING
from evaluation.report.images import stored
from evaluation.report.page import Bars, Block, Card, Cards, Fold, Page, Section, Table, Text, Tile, Tiles
from evaluation.sweeps.table import Row, read_results
from evaluation.sweeps.worth import less_is_better
from recording.checks import json_document
from recording.errors import InputError

SUMMARY = "summary.json"
_SHOWN = 6
"""The worst points of the sweep by themselves."""
_PLOTS = {
    "curves.svg": "The goal along each parameter: the mean with its interval over seeds, and each scene.",
    "pairs.svg": "The mean of the goal over each pair of parameters.",
}


def sweep_page(folder: Path) -> Page:
    """What failed, the best setting and the worst, how much each parameter matters, the plots, all results."""
    document = json_document(folder / SUMMARY)
    try:
        sweep, standings, failures = document["sweep"], document["standings"], document["failures"]
        goal, rows = sweep["goal"], read_results(folder)
        sections = (
            Section(key="summary", title="Summary", blocks=(_tiles(document, rows),), lead=sweep["description"] or ""),
            _failures_section(standings, failures, rows, goal),
            _sensitivity_section(document["sensitivity"], goal),
            Section(key="plots", title="Curves", blocks=_plots(folder)),
            Section(key="standings", title="All points", blocks=(_standings_table(standings, goal),)),
            Section(key="making", title="What was run", blocks=_making(sweep, document)),
        )
    except (KeyError, TypeError, OSError):
        raise InputError(f"{folder / SUMMARY}: expected what 'unocclude sweep' writes: sweep again") from None
    points = f"{len(standings)} points ({sweep['design']}, preset {sweep['preset']})"
    return Page(title=f"Sweep: {sweep['name']}", subtitle=f"{points}, {len(rows)} results", sections=sections)


def _tiles(document: Mapping[str, Any], rows: list[Row]) -> Tiles:
    best, goal = document["best"], document["sweep"]["goal"]
    failed = len(document["failures"])
    return Tiles(
        items=(
            Tile(name=f"best {goal}", value=_interval(best["goal"]), note=_values(best["values"])),
            Tile(name="points", value=str(len(document["standings"]))),
            Tile(name="results", value=str(len(rows))),
            Tile(name="failed", value=str(failed), bad=failed > 0),
        )
    )


def _failures_section(standings: list[dict[str, Any]], failures: list[str], rows: list[Row], goal: str) -> Section:
    """What failed, the worst points with what they do on each recording."""
    words = [Text(words=failure) for failure in failures]
    cards = tuple(
        Card(
            title=f"Point {one['point']}: {_values(one['values'])}",
            words=f"{goal} {_interval(one['goal'])}. Worst on {_worst_recording(rows, one['point'], goal)}.",
            bad=one["failed"] > 0,
        )
        for one in reversed(standings[-_SHOWN:])
    )
    return Section(
        key="failures",
        title="Failures first",
        lead="What failed, and the settings that one had better not choose, worst first.",
        blocks=(*words, Cards(title=f"The worst {len(cards)} of {len(standings)} points", items=cards)),
    )


def _worst_recording(rows: list[Row], point: int, goal: str) -> str:
    scored = [row for row in rows if row["point"] == point and row.get(goal) is not None]
    if not scored:
        return "all: none has a score"
    worst = (max if less_is_better(goal) else min)(scored, key=lambda row: row[goal])
    return f"{worst['recording']} with {worst[goal]:.3f}"


def _sensitivity_section(sensitivity: list[dict[str, Any]], goal: str) -> Section:
    longest = max((one["effect"] or 0.0 for one in sensitivity), default=0.0) or 1.0
    bars = Bars(
        caption=f"How much each parameter matters: the difference that it makes to the mean of {goal}",
        items=tuple((one["axis"], _number(one["effect"]), (one["effect"] or 0.0) / longest) for one in sensitivity),
    )
    shares = tuple((one["axis"], _number(one["share"])) for one in sensitivity if one["share"] is not None)
    caption = "Share of the variance over all points that a parameter alone explains (first-order Sobol index)"
    table = Table(caption=caption, head=("parameter", "share"), rows=shares)
    return Section(key="sensitivity", title="What matters", blocks=(bars, table) if shares else (bars,))


def _plots(folder: Path) -> tuple[Block, ...]:
    found = {folder / name: words for name, words in _PLOTS.items() if (folder / name).is_file()}
    return tuple(stored(path, alt=words, caption=words) for path, words in found.items()) or (Text(words="No plots."),)


def _standings_table(standings: list[dict[str, Any]], goal: str) -> Table:
    rows = tuple(
        (str(one["point"]), _values(one["values"]), _interval(one["goal"]), str(one["failed"])) for one in standings
    )
    caption = "From the best to the worst; ±: 95 % confidence interval over seeds, Student's t"
    return Table(caption=caption, head=("point", "settings", goal, "failed"), rows=rows, words=frozenset({1}))


def _making(sweep: Mapping[str, Any], document: Mapping[str, Any]) -> tuple[Block, ...]:
    known = {name: value for name, value in sweep.items() if value not in (None, [], {}, "") and name != "axes"}
    rows = tuple((name, _words(value)) for name, value in {**known, "version": document["version"]}.items())
    axes = tuple(
        (name, _words({key: each for key, each in axis.items() if each})) for name, axis in sweep["axes"].items()
    )
    meanings = tuple((one.name, one.words) for family in FAMILIES.values() for one in family.values())
    second = frozenset({1})
    return (
        Table(caption="The sweep", head=("key", "value"), rows=rows, words=second),
        Table(caption="Its parameters", head=("parameter", "values"), rows=axes, words=second),
        Fold(
            title="What the scores mean",
            blocks=(Table(caption="Scores", head=("score", "meaning"), rows=meanings, words=second),),
        ),
    )


def _words(value: object) -> str:
    if isinstance(value, dict):
        return "; ".join(f"{name}: {_words(each)}" for name, each in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _values(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in values.items()) or "the preset's values"


def _interval(interval: Mapping[str, Any] | None) -> str:
    if interval is None:
        return NOTHING
    return _number(interval["mean"]) + (f" ±{interval['half_width']:.3f}" if interval["half_width"] is not None else "")


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"
