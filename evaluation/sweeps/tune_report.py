"""What a search for settings has found: a table, a settings file, a picture."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from tabulate import tabulate

from evaluation.figures.style import styled, write_figure
from evaluation.sweeps.plan import Sweep
from evaluation.sweeps.tune import Attempt
from recording.atomic import whole_file
from recording.palette import COLOURS, FAINT
from recording.version import VERSION

_LISTED = 10


def tuning_text(sweep: Sweep, attempts: Sequence[Attempt]) -> str:
    """The best attempts and the front, as a table."""
    listed = [one for number, one in enumerate(attempts) if one.front or number < _LISTED]
    rows = [
        [str(one.number), f"{one.error:.4f}", f"{one.seconds:.2f}", "*" * one.front, *map(_cell, one.values.values())]
        for one in listed
    ]
    headers = ["trial", "error", "seconds", "front", *sweep.axes]
    table = tabulate(rows, headers=headers, tablefmt="plain", disable_numparse=True, stralign="right")
    return (
        f"{sweep.name}: {len(attempts)} trials, trial 0 has the values of preset {sweep.preset}\n\n{table}\n\n"
        "error: 1 - (HOTA + recall) / 2, mean over the recordings. seconds: of one recording. front: no trial has a "
        "smaller error and fewer seconds."
    )


def tuning_document(sweep: Sweep, attempts: Sequence[Attempt]) -> dict[str, Any]:
    """All attempts as one JSON object."""
    return {
        "version": VERSION,
        "sweep": sweep.model_dump(mode="json", by_alias=True),
        "trials": [asdict(one) for one in attempts],
    }


def write_tuning(sweep: Sweep, attempts: Sequence[Attempt], folder: Path) -> None:
    """Write `trials.json`, `best.toml` for `unocclude solve --settings`, and `front.png`, `front.svg`."""
    texts = {
        "trials.json": json.dumps(tuning_document(sweep, attempts), indent=1, allow_nan=False) + "\n",
        "best.toml": _settings_file(sweep, attempts[0]),
    }
    for name, text in texts.items():
        with whole_file(folder / name, overwrite=True) as partial:
            partial.write_text(text, encoding="utf-8")
    for ending in ("png", "svg"):
        draw_front(attempts, folder / f"front.{ending}")


def draw_front(attempts: Sequence[Attempt], path: Path) -> None:
    """Error against seconds, the front joined, the preset's own values marked."""
    with styled(letters=9.0):
        figure = Figure(figsize=(5.6, 4.0), layout="constrained")
        axes = figure.subplots()
        axes.scatter(
            [one.seconds for one in attempts], [one.error for one in attempts], color=FAINT, s=16, label="trial"
        )
        front = sorted((one for one in attempts if one.front), key=lambda one: one.seconds)
        axes.step(
            [one.seconds for one in front],
            [one.error for one in front],
            where="post",
            color=COLOURS[0],
            marker="o",
            label="front",
        )
        preset = [one for one in attempts if one.number == 0]
        axes.plot(
            [one.seconds for one in preset],
            [one.error for one in preset],
            color=COLOURS[1],
            marker="D",
            linestyle="none",
            label="preset",
        )
        axes.set(xlabel="seconds a recording", ylabel="error, 1 - (HOTA + recall) / 2")
        axes.grid(alpha=0.3)
        axes.legend()
        write_figure(figure, path, overwrite=True, dpi=110.0)


def _settings_file(sweep: Sweep, best: Attempt) -> str:
    """The settings of an attempt that are not the preset's, as TOML."""
    lines = [f"{name} = {json.dumps(value)}" for name, value in {**sweep.settings, **best.values}.items()]
    return "\n".join([f"# unocclude tune {sweep.name}: trial {best.number}, error {best.error:.4f}", *lines]) + "\n"


def _cell(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)
