"""Parts of depth images with what a solver says of them: the pictures of holes, of segments, of links."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithm.depth_image import depth_range
from evaluation.figures.panels import as_metres, draw_curve, on_plane
from evaluation.figures.stages import Solved
from recording.camera import PIXEL_CENTRE
from recording.motions import Representative
from recording.palette import COLOURS, TRUTH, colour_of

PANEL_INCHES = 2.5
_ROOM = 0.35
"""Rim around what is shown, as a share of its larger side."""
_LEAST = 0.4
"""Share of the picture's height: a smaller part of it is not shown by itself."""
_SEEN, _COMPLETED = 3.0, 9.0
"""Areas of dots, square points."""
_MOST = 1500
"""Dots of one kind in a panel at the most."""
RIGHT, WRONG = COLOURS[0], COLOURS[1]


@dataclass(frozen=True, kw_only=True)
class Dots:
    """Points in a panel."""

    column_row: Float[np.ndarray, "point 2"]
    colour: str
    completed: bool = False
    """Rings in place of dots."""


@dataclass(frozen=True, kw_only=True)
class Panel:
    """A frame with what is to be shown upon it."""

    frame: int
    title: str
    dots: tuple[Dots, ...]
    outline: int | None = None
    """The object whose true outline is drawn."""


def draw_panels(case: Solved, panels: Sequence[Panel], axes: Sequence[Axes]) -> None:
    """The same part of the picture in all panels: that which shows their points and outlines."""
    left, right, top, bottom = _window(case, panels)
    within = depth_range([case.recording.frames[panel.frame].depth for panel in panels])
    for one, panel in zip(axes, panels, strict=True):
        depth = case.recording.frames[panel.frame].depth
        extent = (0, depth.shape[1], depth.shape[0], 0)
        one.imshow(depth, cmap="gray", vmin=within[0] - 0.5, vmax=within[1] + 0.1, extent=extent, alpha=0.75)
        for dots in panel.dots:
            _draw(one, dots)
        mask = _true_mask(case, panel)
        if mask is not None and mask.any():
            columns, rows = (np.arange(size) + PIXEL_CENTRE for size in mask.shape[::-1])
            one.contour(columns, rows, mask.astype(float), levels=[0.5], colors="black", linewidths=1.0)
        one.set(xlim=(left, right), ylim=(bottom, top), aspect="equal", xticks=[], yticks=[], title=panel.title)
        for side in one.spines.values():
            side.set(visible=True, color=TRUTH)


def motion_dots(case: Solved, motion: int, frame: int) -> tuple[Dots, ...]:
    """The points of a motion in a frame: dots where they were observed, rings where they were completed."""
    motions = case.motions
    parts = []
    for completed in (True, False):
        rows = (motions.motion == motion) & (motions.frame == frame) & (motions.observed != completed)
        picture, depth = case.recording.camera.pixel_from_world(motions.position[rows].astype(np.float64))
        parts.append(Dots(column_row=picture[depth > 0], colour=colour_of(motion), completed=completed))
    return tuple(parts)


def strip(*widths: int) -> tuple[Figure, list[Axes]]:
    """A figure of panels in a row, each so many panels wide."""
    figure = Figure(figsize=(PANEL_INCHES * sum(widths), PANEL_INCHES * 1.12), layout="constrained")
    return figure, list(figure.subplots(1, len(widths), squeeze=False, width_ratios=widths)[0])


def draw_plan(axes: Axes, case: Solved, motions: Sequence[int], objects: Sequence[int] = ()) -> None:
    """The paths of motions from above, or from the front where balls fly; the truth of objects beneath them."""
    for centre in _true_paths(case, objects):
        axes.plot(*on_plane(case.recording, centre, case.plane).T, color=TRUTH, linewidth=4, alpha=0.5, zorder=0)
    for curve in _curves(case, motions):
        draw_curve(axes, on_plane(case.recording, curve.position, case.plane), curve)
    as_metres(axes, case.plane)


def _curves(case: Solved, motions: Sequence[int]) -> list[Representative]:
    return [curve for curve in case.representatives if curve.motion in motions]


def _true_paths(case: Solved, objects: Sequence[int]) -> list[np.ndarray]:
    ids = sorted(case.recording.moving_ids)
    return [case.centres[ids.index(one)] for one in objects if one in ids and len(case.centres) == len(ids)]


def _draw(axes: Axes, dots: Dots) -> None:
    place = dots.column_row[:: max(1, -(-len(dots.column_row) // _MOST))]
    if dots.completed:
        axes.scatter(
            place[:, 0], place[:, 1], s=_COMPLETED, facecolors="none", edgecolors=dots.colour, linewidths=0.5, alpha=0.7
        )
    else:
        axes.scatter(place[:, 0], place[:, 1], s=_SEEN, c=dots.colour, linewidths=0, alpha=0.9)


def _true_mask(case: Solved, panel: Panel) -> np.ndarray | None:
    if panel.outline is None or case.recording.xray is None:
        return None
    depth = case.recording.xray[panel.frame].get(panel.outline)
    return None if depth is None else np.isfinite(depth)


def _window(case: Solved, panels: Sequence[Panel]) -> tuple[float, float, float, float]:
    """Left, right, top, bottom of a square part of the picture around what the panels show."""
    places = [dots.column_row for panel in panels for dots in panel.dots]
    for panel in panels:
        mask = _true_mask(case, panel)
        if mask is not None:
            places.append(np.argwhere(mask)[:, ::-1] + PIXEL_CENTRE)
    width, height = case.recording.camera.width, case.recording.camera.height
    shown = np.concatenate(places) if places else np.zeros((0, 2))
    shown = shown[((shown >= 0) & (shown <= (width, height))).all(axis=1)]
    if not len(shown):
        return 0.0, float(width), 0.0, float(height)
    low, high = shown.min(axis=0), shown.max(axis=0)
    side = max(float((high - low).max()) * (1 + _ROOM), _LEAST * height)
    middle = (low + high) / 2
    return middle[0] - side / 2, middle[0] + side / 2, middle[1] - side / 2, middle[1] + side / 2
