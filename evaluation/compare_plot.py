"""Errors and recall of compared methods by how long somebody was hidden, as a picture."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from evaluation.figures.style import styled, write_figure
from evaluation.hidden_time import Span
from evaluation.interval import Interval
from recording.palette import COLOURS

Value = Callable[[Span], Interval | None]
_PALETTE = (*COLOURS[:6], COLOURS[7])
"""Without yellow, which is faint as a line."""
_MARKERS = "os^Dvp*X"
_ROOM = 0.6
"""Share of a span's width that the methods stand side by side in."""
_MARGIN = 1.6
"""How far the axes of errors reach beyond the least and the greatest mean, as a factor."""
_NO_SHARE = 0.02
"""How far the axis of recall reaches beyond 0 and 1."""


def draw_hidden_time(spans: Sequence[Span], path: Path, *, overwrite: bool = False) -> None:
    """Recall, centre error and point error of every method by the time hidden, as PNG or SVG by the ending.

    Means over recordings, of one group with their 95 % confidence intervals, which may run out of the picture; the
    methods stand side by side in each span of time, those with a stage that knows the truth dashed. Errors on a
    logarithmic axis.
    """
    with styled(letters=9.0):
        figure = Figure(figsize=(14, 4.6), layout="constrained")
        recall, centre, points = figure.subplots(1, 3)
        _draw_panel(recall, spans, lambda span: span.recall, scale=1.0)
        recall.set(title="recall of hidden object-frames", ylim=(-_NO_SHARE, 1 + _NO_SHARE))
        _draw_errors(centre, spans, lambda span: span.centre_m)
        centre.set_title("error of the centre, cm")
        _draw_errors(points, spans, lambda span: span.points_m)
        points.set_title("error of completed points, cm")
        handles, labels = recall.get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside lower center", ncols=len(handles))
        write_figure(figure, path, overwrite=overwrite, dpi=110.0)


def _draw_panel(axes: Axes, spans: Sequence[Span], value: Value, *, scale: float) -> None:
    methods = list(dict.fromkeys(span.method for span in spans))
    begins = sorted({span.begin_s for span in spans})
    for number, method in enumerate(methods):
        own = [(span, found) for span in spans if span.method == method and (found := value(span)) is not None]
        shift = _ROOM * ((number + 0.5) / len(methods) - 0.5)
        axes.errorbar(
            [begins.index(span.begin_s) + shift for span, _ in own],
            [scale * found.mean for _, found in own],
            yerr=[scale * (found.half_width or 0.0) for _, found in own],
            color=_PALETTE[number % len(_PALETTE)],
            marker=_MARKERS[number % len(_MARKERS)],
            markersize=5,
            linestyle="--" if method.startswith("true_") else "-",
            linewidth=1.2,
            elinewidth=0.7,
            capsize=2,
            label=method,
        )
    names = {span.begin_s: span.name for span in spans}
    axes.set_xticks(np.arange(len(begins)), [names[begin] for begin in begins])
    axes.set_xlabel("time hidden")
    axes.set_xlim(-0.6, max(len(begins) - 0.4, 0.6))
    axes.grid(axis="y", alpha=0.3)


def _draw_errors(axes: Axes, spans: Sequence[Span], value: Value) -> None:
    """Errors in centimetres, on a logarithmic axis that holds the means, labelled with plain numbers."""
    _draw_panel(axes, spans, value, scale=100.0)
    above = [100 * found.mean for span in spans if (found := value(span)) is not None and found.mean > 0]
    if not above:
        return
    axes.set_yscale("log")
    axes.set_ylim(min(above) / _MARGIN, max(above) * _MARGIN)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(ScalarFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())
