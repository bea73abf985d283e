"""Figures 1, 3 and 10: scenes from their depth to their completed motions."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colorizer import ColorizingArtist
from matplotlib.figure import Figure

from evaluation.figures.panels import (
    as_metres,
    draw_curve,
    draw_points,
    draw_segments,
    on_plane,
)
from evaluation.figures.stages import Solved
from evaluation.figures.style import PAGE_INCHES
from evaluation.figures.views import View
from recording.drawing import draw_dots
from recording.motions import NOISE, Motions
from recording.palette import DEPTH, FAINT, TRUTH

_LINES = 1500
"""Trajectories drawn at the most."""


def crowd_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 1: input frames, motion fragments, representatives, completed motion."""
    case = solved[0]
    figure = Figure(figsize=(PAGE_INCHES, 0.86 * PAGE_INCHES), layout="constrained")
    panels = list(figure.subplots(2, 2).ravel())
    draw_input(panels[0], case, size=1.2)
    draw_fragments(panels[1], case, size=1.2)
    draw_curves(panels[2], case)
    draw_completed(panels[3], case, size=1.2)
    _name(panels)
    return figure


def wall_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 3: input frames, trajectories, clusters, matched representatives, completed motion."""
    case = solved[0]
    figure = Figure(figsize=(PAGE_INCHES, 0.58 * PAGE_INCHES), layout="constrained")
    above, below = np.asarray(figure.subfigures(2, 1, height_ratios=(1.25, 1)))
    panels = [*above.subplots(1, 3), *below.subplots(1, 2, width_ratios=(1, 1))]
    draw_input(panels[0], case, size=0.8)
    draw_trajectories(panels[1], case, case.view)
    draw_fragments(panels[2], case, size=0.8)
    draw_plane(panels[3], case)
    draw_completed(panels[4], case, size=0.8)
    _name(panels)
    return figure


def gallery_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 10: a row a scene: input frames, segments, representatives, completed motion."""
    figure = Figure(figsize=(PAGE_INCHES, 1.25 * len(solved)), layout="constrained")
    rows = figure.subplots(len(solved), 4, squeeze=False)
    for case, row in zip(solved, rows, strict=True):
        draw_input(row[0], case, size=0.5, bar=False)
        draw_fragments(row[1], case, size=0.5)
        draw_curves(row[2], case)
        draw_completed(row[3], case, size=0.5)
        segments, motions = len(case.curves), len(case.representatives)
        for axes, note in zip(row, ("", f"{segments} segments", f"{motions} motions", ""), strict=True):
            axes.set_title(note, loc="right")
            axes.set_title("")
        row[0].set_ylabel(case.recording.metadata.name or "")
    for axes, name in zip(rows[0], ("input frames", "segments", "representatives", "completed"), strict=True):
        axes.set_title(name)
    _name(list(rows[0]))
    return figure


def draw_input(axes: Axes, case: Solved, *, size: float, bar: bool = True) -> None:
    """The returns of some frames, near ones upon far ones, in the colour of their depth."""
    camera = case.recording.camera
    place = np.concatenate([case.returns(frame) for frame in case.moments])
    order = np.argsort(-case.view.camera.pixel_from_world(place)[1], kind="stable")
    picture, depth = case.view.picture(place)[order], camera.pixel_from_world(place)[1][order]
    dots = axes.scatter(picture[:, 0], picture[:, 1], s=size, c=depth, cmap=DEPTH, linewidths=0, rasterized=True)
    case.view.frame(axes)
    if bar:
        add_bar(axes, dots, "depth [m]")
    axes.set_title("input frames" + (" (grid: 1 m)" if len(case.view.ground) else ""))


def draw_trajectories(axes: Axes, case: Solved, view: View) -> None:
    """The trajectories as they were followed, coloured by the frame in which they begin."""
    found = case.trajectories
    step = -(-found.count // _LINES) or 1
    chosen = np.arange(0, found.count, step)
    place = view.picture(found.position)
    ends = found.first_row + found.length
    parts = [place[found.first_row[number] : ends[number]] for number in chosen]
    lines = LineCollection(parts, linewidths=0.4, rasterized=True)
    lines.set(array=found.first_frame[chosen], cmap="cividis", alpha=0.7)
    _draw_still(axes, case, view)
    axes.add_collection(lines)
    view.frame(axes)
    add_bar(axes, lines, "first frame")
    axes.set_title(f"{found.count} trajectories")


def draw_fragments(axes: Axes, case: Solved, *, size: float) -> None:
    """The points of some frames in the colours of their segments."""
    _draw_still(axes, case, case.view)
    draw_segments(axes, case.view.camera, _at_moments(case), size=size)
    case.view.frame(axes)
    count = len(np.unique(case.motions.segment[case.motions.segment != NOISE]))
    axes.set_title(f"{count} segments (grey: noise)")


def draw_curves(axes: Axes, case: Solved) -> None:
    """The curves of the motions, dotted where they were completed; the truth beneath them."""
    _draw_still(axes, case, case.above)
    for centre in case.centres:
        axes.plot(*case.above.picture(centre).T, color=TRUTH, linewidth=3, alpha=0.4, zorder=1)
    for curve in case.representatives:
        draw_curve(axes, case.above.picture(curve.position), curve)
    case.above.frame(axes)
    axes.set_title(_curves_title(case))


def draw_plane(axes: Axes, case: Solved) -> None:
    """The same in metres, from above, or from the front where balls fly."""
    for centre in case.centres:
        axes.plot(*on_plane(case.recording, centre, case.plane).T, color=TRUTH, linewidth=3, alpha=0.4, zorder=0)
    for curve in case.representatives:
        draw_curve(axes, on_plane(case.recording, curve.position, case.plane), curve)
    as_metres(axes, case.plane)
    axes.set_title(_curves_title(case))


def _curves_title(case: Solved) -> str:
    grey = "; grey: truth" if case.centres else ""
    return f"curves of {len(case.representatives)} motions (dotted: completed{grey})"


def draw_completed(axes: Axes, case: Solved, *, size: float) -> None:
    """The points of some frames in the colours of their motions, completed ones paler."""
    _draw_still(axes, case, case.view)
    draw_points(axes, case.view.camera, _at_moments(case), size=size)
    case.view.frame(axes)
    axes.set_title("completed motion (pale: completed)")


def _draw_still(axes: Axes, case: Solved, view: View) -> None:
    """What stands still, faint."""
    draw_dots(axes, view.picture(case.still), FAINT, size=0.4, alpha=0.5)


def _at_moments(case: Solved) -> Motions:
    return case.motions.rows(np.isin(case.motions.frame, case.moments))


def add_bar(axes: Axes, coloured: ColorizingArtist, label: str) -> None:
    """A colour bar below the axes."""
    bar = axes.figure.colorbar(coloured, ax=axes, location="bottom", shrink=0.6, aspect=30, pad=0.02)
    bar.set_label(label, labelpad=0)


def _name(panels: Sequence[Axes]) -> None:
    """Put (a), (b), ... before the titles."""
    for letter, axes in zip("abcdefgh", panels, strict=False):
        axes.set_anchor("N")
        axes.set_title(f"({letter}) {axes.get_title(loc='left')}")
