"""Each hole with its frames, and the error against its length."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

from evaluation.figures.stages import Solved
from evaluation.holes import HoleRow
from evaluation.report.definitions import NOTHING
from evaluation.report.failures import count_words, frames_words, hole_picture
from evaluation.report.images import drawn
from evaluation.report.page import Block, Card, Cards, Fold, Section, Table, Text
from evaluation.report.worst import worst_holes
from evaluation.scores import Evidence
from recording.motions import Representative
from recording.palette import COLOURS, FAINT

_MOST = 60
"""Holes with pictures; the table has all of them."""
_BAD_M = 0.25
"""A mean error of the centre from which on a hole counts as a failure."""


def error_section(case: Solved, rows: Sequence[HoleRow]) -> Section | None:
    """The error against the length of the holes, beside that of a straight line; None without holes."""
    if not rows:
        return None
    fps = case.recording.fps
    caption = (
        "Each hole by its length: how far the motion's place is from the object's centre, on average over the hole's "
        "frames, beside a straight line at even speed between the true places before and after, which no solver knows."
    )

    def figure() -> Figure:
        made = Figure(figsize=(8.0, 4.2), layout="constrained")
        axes = made.subplots()
        length = np.array([row.frames for row in rows])
        ours = np.array([np.nan if row.centre_mean_m is None else 100 * row.centre_mean_m for row in rows])
        straight = np.array([100 * row.straight_mean_m for row in rows])
        axes.plot(length, straight, "s", color=FAINT, markersize=6, label="straight line between the true ends")
        axes.plot(length, ours, "o", color=COLOURS[0], markersize=7, alpha=0.85, label="this solution")
        axes.set(
            xlabel=f"length of the hole [frames of {1000 / fps:.0f} ms]",
            ylabel="mean error of the centre [cm]",
            ylim=(0, None),
        )
        axes.set_xlim(0, length.max() + 1)
        axes.grid(alpha=0.3)
        axes.legend(loc="upper left")
        return made

    picture = drawn(figure, alt=f"Errors of {len(rows)} holes against their length.", caption=caption, kind="svg")
    return Section(key="errors", title="Error against hole length", blocks=(picture,))


def holes_section(case: Solved, evidence: Evidence, rows: Sequence[HoleRow]) -> Section:
    """Each hole before, within and after; of a recording without truth, each stretch that was completed."""
    if not rows:
        return _completed_section(case)
    cards = tuple(_card(case, evidence, row) for row in worst_holes(rows)[:_MOST])
    rest = "" if len(rows) <= _MOST else f" The worst {_MOST} of {len(rows)} are shown; the table has all."
    blocks: tuple[Block, ...] = (Cards(items=cards), Fold(title="All holes", blocks=(_table(rows),)))
    return Section(
        key="holes",
        title="Each hole",
        lead="Before, hidden, after; the largest error first. Dots: observed; rings: completed; black line: the true "
        f"outline.{rest}",
        blocks=blocks,
    )


def _card(case: Solved, evidence: Evidence, row: HoleRow) -> Card:
    motion = evidence.motion_of_object.get(row.objectid)
    run = (row.first, row.first + row.frames)
    return Card(
        title=f"{row.name}, {frames_words(*run)}",
        words=f"Hidden by {row.hidden_by} for {count_words(row.frames)} ({row.frames / case.recording.fps:.2f} s). "
        f"Centre off by {_cm(row.centre_mean_m)} on average, {_cm(row.centre_max_m)} at most; "
        f"points off by {_cm(row.points_mean_m)}; "
        f"recall {row.recall:.2f}.",
        picture=hole_picture(case, row.name, motion, run, outline=row.objectid),
        frame=(run[0] + run[1] - 1) // 2,
        bad=row.centre_mean_m is None or row.centre_mean_m > _BAD_M,
    )


def _table(rows: Sequence[HoleRow]) -> Table:
    head = (
        *("object", "first frame", "frames", "hidden by", "recall", "centre, mean [cm]", "centre, largest [cm]"),
        *("straight line [cm]", "points, mean [cm]"),
    )
    cells = tuple(
        (
            *(row.name, str(row.first), str(row.frames), row.hidden_by, f"{row.recall:.2f}"),
            *(
                _number(value)
                for value in (row.centre_mean_m, row.centre_max_m, row.straight_mean_m, row.points_mean_m)
            ),
        )
        for row in rows
    )
    return Table(caption="All holes", head=head, rows=cells)


def _completed_section(case: Solved) -> Section:
    stretches = [(curve, run) for curve in case.representatives for run in _unseen_runs(curve)]
    stretches.sort(key=lambda one: one[1][0] - one[1][1])
    if not stretches:
        return Section(
            key="holes", title="Each hole", blocks=(Text(words="Nothing was hidden, or nothing completed."),)
        )
    cards = tuple(
        Card(
            title=f"Motion {curve.motion}, {frames_words(first, stop)}",
            words=f"Not seen for {count_words(stop - first)} ({(stop - first) / case.recording.fps:.2f} s).",
            picture=hole_picture(case, f"Motion {curve.motion}", curve.motion, (first, stop)),
            frame=(first + stop - 1) // 2,
        )
        for curve, (first, stop) in stretches[:_MOST]
    )
    lead = "Where a motion was completed, the longest first: before, hidden, after. Dots: observed; rings: completed."
    return Section(key="holes", title="Each hole", lead=lead, blocks=(Cards(items=cards),))


def _unseen_runs(curve: Representative) -> list[tuple[int, int]]:
    """The first frame and the frame after the last of each stretch between two observed ones."""
    seen = curve.frame[curve.observed].tolist()
    return [(last + 1, following) for last, following in pairwise(seen) if following > last + 1]


def _cm(metres: float | None) -> str:
    return "(not said)" if metres is None else f"{100 * metres:.1f} cm"


def _number(metres: float | None) -> str:
    return NOTHING if metres is None else f"{100 * metres:.1f}"
