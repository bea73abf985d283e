"""The pictures of the stages, by the figures of the paper."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evaluation.figures.curves import candidates_figure, matchings_figure, representative_figure
from evaluation.figures.pipeline import pipeline_figure
from evaluation.figures.scenes import draw_completed, draw_curves, draw_fragments, draw_input, draw_plane
from evaluation.figures.stages import Solved
from evaluation.report.images import drawn
from evaluation.report.page import Picture, Section

_WIDTH = 5.0
"""Inches of a panel."""
_ROOM = 0.9
"""Inches above and below it, for its title and a colour bar."""
_DOT = 1.4
_PRINTED = 7.0
"""Points: the letters that figures for print have room for."""


def stages_section(case: Solved) -> Section:
    """Depth, flow, trajectories, segments, representatives, candidates, matching, completed motion.

    What there is not, the truth or links, has no picture and no word.
    """
    beneath = "; beneath it the truth" if case.centres else ""
    return Section(
        key="stages",
        title="Stage by stage",
        lead="What the solver has in its hands on the way, from depth to completed motion.",
        blocks=(
            _of_figure(
                case,
                pipeline_figure,
                "Point clouds, depth images, the optical flow between two frames with its lift to 3D, and the "
                "trajectories that follow from it.",
            ),
            _of_panels(
                case,
                (lambda axes: draw_input(axes, case, size=_DOT), lambda axes: draw_fragments(axes, case, size=_DOT)),
                "Left: what the sensor saw at some moments. Right: the segments, trajectories that move together.",
            ),
            _of_figure(
                case,
                representative_figure,
                "The largest segment: its points in three frames, and the curve that stands for it.",
            ),
            _of_panels(
                case,
                (lambda axes: draw_curves(axes, case), lambda axes: draw_plane(axes, case)),
                f"The one curve that stands for each motion, dotted where it was completed{beneath}.",
            ),
            *_link_pictures(case),
            _of_panels(
                case,
                (lambda axes: draw_completed(axes, case, size=_DOT),),
                "The motions with what was hidden of them.",
            ),
        ),
    )


def _link_pictures(case: Solved) -> list[Picture]:
    pictures = []
    if case.candidates:
        caption = "Polynomials that could have joined two segments; those that were joined are shaded."
        pictures.append(_of_figure(case, candidates_figure, caption))
    if case.links:
        caption = "The links that were chosen, and what else might have been."
        pictures.append(_of_figure(case, matchings_figure, caption))
    return pictures


def _of_figure(case: Solved, draw: Callable[[Sequence[Solved]], Figure], caption: str) -> Picture:
    return drawn(lambda: draw([case]), alt=caption, caption=caption, letters=_PRINTED)


def _of_panels(case: Solved, draw: Sequence[Callable[[Axes], None]], caption: str) -> Picture:
    """Panels side by side."""

    def figure() -> Figure:
        height = _WIDTH * float(np.clip(case.view.shape, 0.4, 1.0)) + _ROOM
        made = Figure(figsize=(_WIDTH * max(len(draw), 1.4), height), layout="constrained")
        for axes, one in zip(made.subplots(1, len(draw), squeeze=False)[0], draw, strict=True):
            one(axes)
            axes.set_anchor("N")
        return made

    return drawn(figure, alt=caption, caption=caption)
