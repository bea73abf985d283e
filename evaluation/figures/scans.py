"""Figures 11 to 15: the scenes in the manner of the paper's real scans."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from algorithm.depth_image import depth_range
from evaluation.figures.panels import COMPLETED, OBSERVED, draw_places, draw_points, moments_of
from evaluation.figures.stages import Solved
from evaluation.figures.style import COLUMN_INCHES, PAGE_INCHES
from evaluation.figures.views import View, front_view
from recording.motions import INTER, INTRA, NOISE, Motions
from recording.palette import COLOURS, DEPTH, FAINT, colour_of, colours_of

_COLUMNS = 4
_SIZE = 1.0


def scan_figure(solved: Sequence[Solved]) -> Figure:
    """Figures 11, 12 and 14: frames of a scan (top) and the motions found in them (bottom)."""
    case = solved[0]
    frames = moments_of(case.recording.metadata.frames, _COLUMNS)
    view = front_view(case.recording, case.shown)
    height = 2 * view.shape * 0.9 * PAGE_INCHES / len(frames) + 0.4
    figure = Figure(figsize=(PAGE_INCHES, min(height, PAGE_INCHES)), layout="constrained")
    rows = figure.subplots(2, len(frames), squeeze=False)
    scale = Normalize(*depth_range([case.recording.frames[frame].depth for frame in frames]))
    for above, below, frame in zip(rows[0], rows[1], frames, strict=True):
        place, depth = case.returns(frame), case.recording.frames[frame].depth
        column, row = view.picture(place).T
        seen = depth[np.isfinite(depth)]
        dots = above.scatter(column, row, s=_SIZE, c=seen, cmap=DEPTH, norm=scale, linewidths=0, rasterized=True)
        draw_places(below, view.camera, place, np.full(len(place), FAINT), size=_SIZE, alpha=0.4)
        rest = case.motions.rows((case.motions.frame == frame) & case.motions.observed)
        draw_points(below, view.camera, rest, size=_SIZE)
        for axes in (above, below):
            view.frame(axes)
        above.set_title(f"frame {frame}, {frame / case.recording.fps:.2f} s")
    rows[0, 0].set_ylabel("scan")
    rows[1, 0].set_ylabel(f"{len(case.representatives)} motions")
    figure.colorbar(dots, ax=list(rows[0]), shrink=0.8, aspect=30, pad=0.01).set_label("depth [m]")
    return figure


def person_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 13: the person who was hidden: what was scanned, the segments of it, the completed motion."""
    case = solved[0]
    motion = _most(case, INTER)
    if motion is None:
        return _without("no motion was completed across a hole")
    rows = _around_hole(case, motion)
    seen, view = rows.rows(rows.observed), _close_view(case, rows)
    height = min(view.shape * PAGE_INCHES / 3 + 0.3, 0.4 * PAGE_INCHES)
    figure = Figure(figsize=(PAGE_INCHES, height), layout="constrained")
    panels = figure.subplots(1, 3)
    _draw(panels[0], view, seen, np.full(len(seen), COLOURS[7]))
    _draw(panels[1], view, seen, colours_of(seen.segment))
    _draw_completion(panels[2], view, rows, colour_of(motion))
    for axes, name in zip(panels, ("(a) scanned", _segments(seen, "(b)"), "(c) completed (pale)"), strict=True):
        axes.set_title(name)
    return figure


def completion_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 15: a motion completed within its segments (top), and one across a hole between two (bottom)."""
    case = solved[0]
    across = _most(case, INTER)
    within = _most(case, INTRA, but=across)
    if within is None or across is None:
        return _without("no motion was completed within a segment, or none across a hole")
    figure = Figure(figsize=(0.7 * PAGE_INCHES, 0.7 * PAGE_INCHES), layout="constrained")
    above, below = figure.subplots(2, 2)
    best = _fullest_frame(case, within, INTRA)
    _draw_before_and_after(list(above), case, _of_motion(case, within, [best]), f"frame {best}:")
    above[1].set_title("intra-segment completion (pale)")
    _draw_before_and_after(list(below), case, _around_hole(case, across), "before and after a hole:")
    below[1].set_title("inter-segment completion (pale)")
    return figure


def _draw_before_and_after(panels: Sequence[Axes], case: Solved, rows: Motions, name: str) -> None:
    """Points as they were seen, in the colours of their segments, and with those that were completed."""
    view, seen = _close_view(case, rows), rows.rows(rows.observed)
    _draw(panels[0], view, seen, colours_of(seen.segment))
    panels[0].set_title(_segments(seen, name))
    _draw_completion(panels[1], view, rows, colour_of(int(rows.motion[0])))


def _around_hole(case: Solved, motion: int) -> Motions:
    """The points of a motion in the frame in which most of it is hidden, and well before and after."""
    frames = case.recording.metadata.frames
    middle, apart = _fullest_frame(case, motion, INTER), max(2, frames // 3)
    return _of_motion(case, motion, [middle - apart, middle, middle + apart])


def _fullest_frame(case: Solved, motion: int, source: int) -> int:
    """The frame with most of a motion's rows of a source."""
    return int(
        np.bincount(case.motions.frame[(case.motions.motion == motion) & (case.motions.source == source)]).argmax()
    )


def _draw(axes: Axes, view: View, rows: Motions, colours: np.ndarray) -> None:
    draw_places(axes, view.camera, rows.position, colours, size=2 * _SIZE, alpha=OBSERVED)
    view.frame(axes)


def _draw_completion(axes: Axes, view: View, rows: Motions, colour: str) -> None:
    for observed, alpha in ((False, 1.5 * COMPLETED), (True, OBSERVED)):
        part = rows.rows(rows.observed == observed)
        draw_places(axes, view.camera, part.position, np.full(len(part), colour), size=2 * _SIZE, alpha=alpha)
    view.frame(axes)


def _of_motion(case: Solved, motion: int, frames: Sequence[int]) -> Motions:
    return case.motions.rows((case.motions.motion == motion) & np.isin(case.motions.frame, frames))


def _most(case: Solved, source: int, *, but: int | None = None) -> int | None:
    """The motion that was completed most for what was seen of it, if any was; another than `but` where that can be."""
    counted = case.motions.motion != NOISE
    numbers = case.motions.motion[counted]
    filled = np.bincount(numbers[case.motions.source[counted] == source], minlength=1 + max(numbers, default=0))
    share = filled / np.maximum(np.bincount(numbers, minlength=len(filled)), 1)
    order = [int(number) for number in np.argsort(-share, kind="stable") if filled[number]]
    return next((number for number in order if number != but), order[0] if order else None)


def _segments(seen: Motions, name: str) -> str:
    count = len(np.unique(seen.segment))
    return f"{name} {count} segment{'s' if count != 1 else ''}"


def _close_view(case: Solved, rows: Motions) -> View:
    """The sensor's picture of some points and no more."""
    return front_view(case.recording, rows.position.astype(np.float64))


def _without(reason: str) -> Figure:
    """The figure of a recording that has nothing to show."""
    figure = Figure(figsize=(COLUMN_INCHES, 0.5 * COLUMN_INCHES))
    figure.text(0.5, 0.5, reason, ha="center")
    return figure
