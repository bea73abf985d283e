"""What shows the marked segments at all times: their paths, and themselves at the moments that were marked."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float64
from viser import SceneNodeHandle

from recording.motions import Motions, Representative
from recording.palette import rgb
from viewer.colours import MARK_COLOURS
from viewer.lines import Lines, segment_lines
from viewer.marks import Mark, Marks
from viewer.stage import LineLayer, Stage

_WORDS = ("first", "second")
_THICK, _LARGE, _ABOVE = 0.006, 1.2, 0.03
"""Of lines, as a share of the scene's size; of points, as one of theirs; how far the words stand above them."""
Points = Float64[np.ndarray, "point 3"]


class Highlight:
    """The nodes of what is marked, made anew whenever that changes: they are few."""

    def __init__(self, stage: Stage, point_m: float) -> None:
        self._stage, self._point_m = stage, point_m
        self._paths = LineLayer(stage=stage, name="marks", thick_m=_THICK * stage.space.size_m, shown=True)
        self._nodes: list[SceneNodeHandle] = []

    def put(self, marks: Marks, motions: Motions | None, places: Sequence[Representative]) -> None:
        """Show the marked segments of the motions, whose places over time are told."""
        for node in self._nodes:
            node.remove()
        self._nodes = []
        lines = []
        for slot, mark in enumerate(marks.slots):
            if mark is not None and motions is not None:
                path = segment_lines([place for place in places if place.motion == mark.segment])
                lines.append(_painted(path, slot))
                chosen = motions.observed & (motions.segment == mark.segment) & (motions.frame == mark.anchor.frame)
                points = motions.position[chosen].astype(np.float64)
                self._nodes += [self._points(slot, points), self._words(slot, mark, points)]
        self._paths.put([Lines.of(lines)], 0)

    def _points(self, slot: int, points: Points) -> SceneNodeHandle:
        return self._stage.server.scene.add_point_cloud(
            f"/marks/{slot}/points",
            self._stage.space.near(points),
            rgb(MARK_COLOURS[slot]),
            point_size=_LARGE * self._point_m,
            point_shading="gradient",
            point_shape="circle",
            position=self._stage.space.middle,
        )

    def _words(self, slot: int, mark: Mark, points: Points) -> SceneNodeHandle:
        space = self._stage.space
        return self._stage.server.scene.add_label(
            f"/marks/{slot}/words",
            f"{_WORDS[slot]}: segment {mark.segment}, frame {mark.anchor.frame}",
            position=points[(points @ space.up).argmax()] + _ABOVE * space.size_m * space.up,
            anchor="bottom-center",
        )


def _painted(lines: Lines, slot: int) -> Lines:
    return replace(lines, colours=np.tile(rgb(MARK_COLOURS[slot]), (len(lines), 1)))
