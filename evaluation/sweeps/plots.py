"""A sweep in pictures: one curve an axis, a heat map for each pair of axes, the paper's values marked."""

from collections.abc import Sequence
from itertools import combinations
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithm.settings import preset_settings
from evaluation.figures.style import styled, write_figure
from evaluation.paper_rows import PAPER
from evaluation.sweeps.levels import Level, by, interval_of, levels_of
from evaluation.sweeps.plan import Sweep, Value
from evaluation.sweeps.table import Row
from recording.palette import COLOURS

_IN_A_ROW = 3
_PANEL = (4.4, 3.3)
"""Width and height, inches."""
_WIDE = 10.0
"""Values that span this factor stand on a logarithmic axis."""
_MARGIN, _LEAST_HEIGHT = 0.25, 0.02
"""Room above and below the means, as a share of their range, and the least that counts as range."""
_MOST_NUMBERS = 36
"""A heat map of more cells bears no numbers."""


def draw_curves(sweep: Sweep, rows: Sequence[Row], path: Path) -> None:
    """The goal along each axis: the mean with its interval over seeds, and each scene by itself."""
    with styled(letters=9.0):
        figure, panels = _panels(len(sweep.axes))
        for panel, axis in zip(panels, sweep.axes, strict=True):
            _draw_curve(panel, sweep, rows, axis)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(handles), 5))
        write_figure(figure, path, overwrite=True, dpi=110.0)


def draw_pairs(sweep: Sweep, rows: Sequence[Row], path: Path) -> None:
    """The mean of the goal over each pair of axes."""
    pairs = list(combinations(sweep.axes, 2))
    with styled(letters=9.0):
        figure, panels = _panels(len(pairs))
        for panel, pair in zip(panels, pairs, strict=True):
            _draw_pair(panel, sweep, rows, pair)
        write_figure(figure, path, overwrite=True, dpi=110.0)


def has_pairs(sweep: Sweep) -> bool:
    """Whether there are combinations of values to draw."""
    return len(sweep.axes) > 1 and sweep.design != "one_at_a_time"


def paper_values(sweep: Sweep, axis: str, scenes: Sequence[str]) -> list[Value]:
    """The paper's values of a setting: Table 1's for these scenes, else the preset's."""
    number = {f"eps{number}": number - 1 for number in range(1, 6)}.get(axis)
    stated = [row.epsilons[number] for row in PAPER if row.scene in scenes] if number is not None else []
    return sorted(set(stated)) or [getattr(preset_settings("paper"), axis)]


def _panels(count: int) -> tuple[Figure, list[Axes]]:
    columns = min(count, _IN_A_ROW)
    lines = ceil(count / columns)
    size = (_PANEL[0] * columns, _PANEL[1] * lines + 0.4)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(lines, columns, squeeze=False).ravel().tolist()
    for idle in panels[count:]:
        idle.set_axis_off()
    return figure, panels[:count]


def _draw_curve(panel: Axes, sweep: Sweep, rows: Sequence[Row], axis: str) -> None:
    """One axis; its height is that of the means, and intervals may run out of it."""
    levels = levels_of(sweep, rows, axis)
    places, line = _places(levels), "-" if _numeric(levels) else "none"
    scenes = by(rows, "scene")
    intervals = [interval_of(level.rows, sweep.goal) for level in levels]
    means = [np.nan if one is None else one.mean for one in intervals]
    heights = [*means]
    for number, scene in enumerate(scenes if len(scenes) > 1 else ()):
        own = [_mean([row for row in level.rows if row["scene"] == scene], sweep.goal) for level in levels]
        colour = COLOURS[number % len(COLOURS)]
        panel.plot(places, own, color=colour, linestyle=line, linewidth=0.9, marker=".", alpha=0.8, label=scene)
        heights += own
    widths = [0.0 if one is None else one.half_width or 0.0 for one in intervals]
    panel.errorbar(
        places, means, yerr=widths, color="black", linestyle=line, marker="o", elinewidth=0.8, capsize=3, label="mean"
    )
    if np.isfinite(heights).any():
        room = max(np.nanmax(heights) - np.nanmin(heights), _LEAST_HEIGHT) * _MARGIN
        panel.set_ylim(np.nanmin(heights) - room, np.nanmax(heights) + room)
    _mark_paper(panel, levels, paper_values(sweep, axis, list(scenes)))
    _name_places(panel, levels)
    panel.set(xlabel=axis, ylabel=sweep.goal)
    panel.grid(alpha=0.3)


def _draw_pair(panel: Axes, sweep: Sweep, rows: Sequence[Row], pair: tuple[str, str]) -> None:
    across, up = (levels_of(sweep, rows, axis) for axis in pair)
    mean = np.full((len(up), len(across)), np.nan)
    for row, column in np.ndindex(mean.shape):
        both = {id(one) for one in up[row].rows}
        mean[row, column] = _mean([one for one in across[column].rows if id(one) in both], sweep.goal)
    picture = panel.imshow(mean, origin="lower", aspect="auto", cmap="viridis")
    panel.figure.colorbar(picture, ax=panel, label=sweep.goal)
    scenes = list(by(rows, "scene"))
    for x in _nearest(across, paper_values(sweep, pair[0], scenes)):
        for y in _nearest(up, paper_values(sweep, pair[1], scenes)):
            panel.plot(x, y, marker="s", markersize=26, fillstyle="none", color=COLOURS[1], markeredgewidth=2)
    if mean.size <= _MOST_NUMBERS and np.isfinite(mean).any():
        _write_numbers(panel, mean)
    panel.set_xticks(range(len(across)), [_name(level.value) for level in across])
    panel.set_yticks(range(len(up)), [_name(level.value) for level in up])
    panel.set(xlabel=pair[0], ylabel=pair[1])


def _write_numbers(panel: Axes, mean: np.ndarray) -> None:
    """The number of each cell, dark on bright and bright on dark."""
    middle = (np.nanmin(mean) + np.nanmax(mean)) / 2
    for row, column in np.argwhere(np.isfinite(mean)):
        value = mean[row, column]
        colour = "black" if value > middle else "white"
        panel.text(column, row, f"{value:.3f}", ha="center", va="center", color=colour, fontsize=7)


def _mean(rows: Sequence[Row], score: str) -> float:
    interval = interval_of(rows, score)
    return np.nan if interval is None else interval.mean


def _places(levels: Sequence[Level]) -> list[float]:
    """Where the levels stand along their axis: numbers where they are, names one after the other."""
    return [float(level.value) for level in levels] if _numeric(levels) else list(map(float, range(len(levels))))


def _name_places(panel: Axes, levels: Sequence[Level]) -> None:
    """Names stand below their places; numbers of several orders on a logarithmic axis, each as it is."""
    names, places = [_name(level.value) for level in levels], _places(levels)
    if not _numeric(levels):
        panel.set_xticks(places, names, rotation=30)
    elif min(places) > 0 and max(places) / min(places) >= _WIDE:
        panel.set_xscale("log")
        panel.set_xticks(places, names)
        panel.minorticks_off()


def _mark_paper(panel: Axes, levels: Sequence[Level], values: Sequence[Value]) -> None:
    names = [level.value for level in levels]
    places = [float(value) for value in values] if _numeric(levels) else [names.index(v) for v in values if v in names]
    for number, place in enumerate(places):
        label = "paper" if number == 0 else None
        panel.axvline(place, color=COLOURS[5], linestyle=":", linewidth=1.6, label=label)


def _nearest(levels: Sequence[Level], values: Sequence[Value]) -> set[int]:
    """The numbers of the levels nearest to the values."""
    if _numeric(levels):
        known = np.array([float(level.value) for level in levels])
        return {int(np.abs(known - float(value)).argmin()) for value in values}
    return {number for number, level in enumerate(levels) if level.value in values}


def _numeric(levels: Sequence[Level]) -> bool:
    return all(isinstance(level.value, int | float) and not isinstance(level.value, bool) for level in levels)


def _name(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)
