"""Figures 6 to 9: what representatives are, and how they complete motions."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import linear_sum_assignment

from algorithm.intra import aligned
from algorithm.representative import Curve
from algorithm.trajectories import Trajectories
from evaluation.figures.panels import ELEVATION, Plane, as_metres, on_plane
from evaluation.figures.stages import Pair, Solved
from evaluation.figures.style import COLUMN_INCHES, PAGE_INCHES
from recording.drawing import draw_dots
from recording.motions import INTRA, NOISE, Representative
from recording.palette import COLOURS, FAINT, TRUTH, colour_of

_RED, _BLACK = COLOURS[1], COLOURS[7]
_MATCHINGS = 4
"""Panels of figure 9."""
_CURVES = 8
"""Polynomials in figure 8: the chosen ones, then the cheapest of the others."""
_LONG_ENOUGH = 10
"""Frames of a trajectory that show where it goes."""


def representative_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 6: a segment's representative, and its anchor in the densest frame."""
    case = solved[0]
    figure, axes = _one_column(0.75)
    if not case.curves:
        return _without(figure, axes, "no segment was found")
    number = max(case.curves, key=lambda segment: case.curves[segment].points.sum())
    curve = case.curves[number]
    densest = int(np.argmax(curve.points))
    spread = [int(share * (len(curve.points) - 1)) for share in (1 / 6, 1 / 2, 5 / 6)]
    others = sorted(spread, key=lambda moment: -abs(moment - densest))[:2]
    shown = sorted({densest, *others})
    seen = case.motions.rows((case.motions.segment == number) & case.motions.observed)
    for colour, moment in zip((COLOURS[5], COLOURS[0], COLOURS[2]), shown, strict=False):
        frame = curve.first + moment
        place = on_plane(case.recording, seen.position[seen.frame == frame].astype(float), ELEVATION)
        draw_dots(axes, place, colour, size=2.5, alpha=0.7)
        axes.plot([], [], "o", color=colour, markersize=2.5, label=f"frame {frame}: {len(place)} points")
    path = on_plane(case.recording, curve.position, ELEVATION)
    axes.plot(*path.T, color=_RED, linestyle=":", linewidth=1.6, label="representative")
    anchor = seen.position[seen.frame == curve.first + densest].astype(float).mean(axis=0)
    place = on_plane(case.recording, anchor[None], ELEVATION)[0]
    axes.plot(*place, "s", color=_RED, markersize=6, fillstyle="none", markeredgewidth=1.5, label="anchor")
    return _finished(figure, axes, ELEVATION)


def intra_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 7: two trajectories of a segment, joined along its representative."""
    case = solved[0]
    figure, axes = _one_column(0.75)
    found = _joined_trajectory(case)
    if found is None:
        return _without(figure, axes, "no trajectory was completed within a segment")
    first, last, rows = found
    frame, place = case.motions.frame[rows], case.motions.position[rows].astype(float)
    motion = next(entry for entry in case.representatives if entry.motion == case.motions.motion[rows[0]])
    near = (motion.frame >= frame[0]) & (motion.frame <= frame[-1])
    laid = _laid_on(case, motion, frame[: first + 1], place[: first + 1])
    for name, path, style in (
        ("representative r", motion.position[near], {"color": _BLACK, "linewidth": 1.5}),
        ("r laid on tr1", laid[near], {"color": TRUTH, "linewidth": 1.0, "linestyle": "--"}),
        ("tr1", place[: first + 1], {"color": COLOURS[0], "linewidth": 2.0}),
        ("tr2", place[last:], {"color": COLOURS[2], "linewidth": 2.0}),
        (f"completed, {last - first - 1} frames", place[first : last + 1], {"color": _RED, "linestyle": ":"}),
    ):
        axes.plot(*on_plane(case.recording, path, case.plane).T, label=name, **style)
    return _finished(figure, axes, case.plane)


def candidates_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 8: for each pair of representatives the polynomial between them; the chosen ones are shaded."""
    case = solved[0]
    figure = Figure(figsize=(PAGE_INCHES, 0.5 * PAGE_INCHES), layout="constrained")
    axes = figure.subplots()
    if not case.candidates:
        return _without(figure, axes, "no segment may follow another")
    _draw_representatives(axes, case, case.curves)
    order = sorted(case.candidates.values(), key=lambda entry: (entry.pair not in case.links, entry.polynomial.cost))
    for number, candidate in enumerate(order[:_CURVES]):
        path = on_plane(case.recording, case.path(candidate), case.plane)
        before, after = (case.names[segment] for segment in candidate.pair)
        label = f"{before} to {after}: {candidate.name}" + ("" if candidate.fits else ", too large")
        axes.plot(*path.T, color=colour_of(number + 4), linestyle=":", linewidth=1.5, label=label)
        if candidate.pair in case.links:
            axes.plot(*path.T, color=FAINT, alpha=0.5, linewidth=9, solid_capstyle="butt", zorder=0)
            _draw_hole(axes, on_plane(case.recording, case.path(candidate, hole=True), case.plane))
    axes.plot([], [], color=FAINT, alpha=0.5, linewidth=9, label="chosen; red: the missing motion")
    return _finished(figure, axes, case.plane)


def matchings_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 9: several ways to match the same representatives; the last is the one that was chosen.

    Links that are not among the chosen ones are red.
    """
    case = solved[0]
    figure = Figure(figsize=(PAGE_INCHES, 0.45 * PAGE_INCHES), layout="constrained")
    if not case.links:
        return _without(figure, figure.subplots(), "no segments were matched")
    shown = _matchings_shown(case)
    panels = figure.subplots(2, -(-len(shown) // 2), sharex=True, sharey=True, squeeze=False).ravel()
    for axes in panels[len(shown) :]:
        axes.set_axis_off()
    for axes, links in zip(panels, shown, strict=False):
        _draw_representatives(axes, case, {number for link in case.candidates for number in link}, names=False)
        for pair in links:
            path = on_plane(case.recording, case.path(case.candidates[pair]), case.plane)
            axes.plot(*path.T, color=_BLACK if pair in case.links else _RED, linestyle=":", linewidth=1.5)
        for centre in case.centres:
            axes.plot(*on_plane(case.recording, centre, case.plane).T, color=FAINT, linewidth=4, alpha=0.4, zorder=0)
        as_metres(axes, case.plane, adjustable="box")
        kind = "chosen: " if links == shown[-1] else ""
        axes.set_title(f"{kind}{len(links)} links, cost {_cost(case, links):.2f} m")
        axes.label_outer()
    return figure


def _matchings_shown(case: Solved) -> list[tuple[Pair, ...]]:
    """The chosen matching at the end; before it the best ones without one of its links, the dearest first."""
    chosen = tuple(link for link in case.links if link in case.candidates)
    others = {_best_matching(case, without=link) for link in chosen} - {chosen}
    near = sorted(others, key=lambda links: (-len(links), _cost(case, links), links))[: _MATCHINGS - 1]
    return [*near[::-1], chosen]


def _best_matching(case: Solved, *, without: Pair) -> tuple[Pair, ...]:
    """Of the matchings of most links, without one of them, the cheapest; sorted."""
    pairs = [pair for pair in case.candidates if pair != without]
    befores, afters = (sorted({pair[side] for pair in pairs}) for side in (0, 1))
    never = 1.0 + 2.0 * _cost(case, pairs)
    cost = np.full((len(befores), len(afters)), never)
    for before, after in pairs:
        cost[befores.index(before), afters.index(after)] = _cost(case, [(before, after)])
    found = zip(*linear_sum_assignment(cost), strict=True)
    return tuple(sorted((befores[row], afters[column]) for row, column in found if cost[row, column] < never))


def _cost(case: Solved, links: Iterable[Pair]) -> float:
    """Error times exp(degree) of all links, metres."""
    return sum(case.candidates[pair].polynomial.cost for pair in links)


def _draw_representatives(axes: Axes, case: Solved, numbers: Iterable[int], *, names: bool = True) -> None:
    for number in numbers:
        path = on_plane(case.recording, case.curves[number].position, case.plane)
        axes.plot(*path.T, color=colour_of(number), linewidth=2)
        if names:
            middle = path[len(path) // 2]
            axes.annotate(case.names[number], middle, (0, 4), textcoords="offset points", color=colour_of(number))


def _draw_hole(axes: Axes, path: np.ndarray) -> None:
    """A red rectangle around a path."""
    low, high = path.min(axis=0) - 0.12, path.max(axis=0) + 0.12
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])
    axes.plot(*corners.T, color=_RED, linewidth=0.8)


def _joined_trajectory(case: Solved) -> tuple[int, int, np.ndarray] | None:
    """The rows of a trajectory, and between which two of them it was completed within its segment.

    The one with the longest gap whose both sides are long enough to show where they go; None without any.
    """
    best, found = 0, None
    motions = case.motions
    for rows in np.split(np.arange(len(motions)), np.flatnonzero(np.diff(motions.trajectory)) + 1):
        filled = motions.source[rows] == INTRA
        if not len(rows) or motions.motion[rows[0]] == NOISE or filled[0] or filled[-1] or not filled.any():
            continue
        edges = np.flatnonzero(np.diff(filled.astype(int))).reshape(-1, 2)
        for first, last in zip(edges[:, 0], edges[:, 1] + 1, strict=True):
            sides = min(first + 1, len(rows) - last, _LONG_ENOUGH)
            if sides * (last - first - 1) > best:
                best, found = sides * (last - first - 1), (int(first), int(last), rows)
    return found


def _laid_on(case: Solved, motion: Representative, frame: np.ndarray, place: np.ndarray) -> np.ndarray:
    """The representative of a motion, laid on the trajectory as the solver lays it."""
    one = Trajectories(
        trajectory=np.zeros(len(frame), int), frame=frame.astype(int), position=place, column_row=place[:, :2]
    )
    curve = Curve(first=int(motion.frame[0]), position=motion.position, points=motion.observed.astype(float))
    alignment = aligned(one, curve, method=case.settings.alignment)
    return alignment.extended(np.zeros(len(motion.position), int), motion.position)


def _one_column(shape: float) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(COLUMN_INCHES, shape * COLUMN_INCHES), layout="constrained")
    return figure, figure.subplots()


def _finished(figure: Figure, axes: Axes, plane: Plane) -> Figure:
    as_metres(axes, plane)
    figure.legend(loc="outside lower center", ncols=2)
    return figure


def _without(figure: Figure, axes: Axes, reason: str) -> Figure:
    """The figure of a recording that has nothing to show."""
    axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes)
    axes.set_axis_off()
    return figure
