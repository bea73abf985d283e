"""What stands in the browser's scene: of each frame a group of nodes of its own, sent once and then shown by turns.

To show another frame takes two small messages, however many points it has; `benchmarks/viewing.py` measures it beside
sending the points anew.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, UInt8
from viser import FrameHandle, LineSegmentsHandle, PointCloudHandle, SceneNodeHandle, ViserServer

from viewer.clouds import Cloud
from viewer.lines import Lines
from viewer.space import Space

Place = Float[np.ndarray, "3"]
Colours = UInt8[np.ndarray, "point 3"]


@runtime_checkable
class Layer(Protocol):
    """A part of the scene that can be shown or not; its nodes are sent when it is first shown."""

    def show(self, shown: bool, first: int) -> None:
        """Show it or not; what is sent for it begins with a frame."""


class Stage:
    """The frames' groups, and the one of them that is shown."""

    def __init__(self, server: ViserServer, space: Space, frames: int) -> None:
        self.server = server
        self.space = space
        self.frame = 0
        middle = tuple(space.middle.tolist())
        self._groups: list[FrameHandle] = [
            server.scene.add_frame(self.name(frame), show_axes=False, position=middle, visible=frame == 0)
            for frame in range(frames)
        ]

    def name(self, frame: int, what: str = "") -> str:
        """The name of a frame's group, or of a node in it."""
        return f"/frames/{frame}" + (f"/{what}" if what else "")

    def show(self, frame: int) -> None:
        """Show a frame in place of the one before."""
        if frame == self.frame:
            return
        with self.server.atomic():
            self._groups[frame].visible = True
            self._groups[self.frame].visible = False
        self.frame = frame

    def from_frame(self, first: int) -> Iterator[int]:
        """All frames, that one first."""
        count = len(self._groups)
        return ((first + number) % count for number in range(count))


@dataclass(kw_only=True, eq=False)
class CloudLayer:
    """Points that change from frame to frame."""

    stage: Stage
    name: str
    size_m: float
    cloud: Cloud | None = None
    colours: Colours | None = None
    shown: bool = False
    _nodes: dict[int, PointCloudHandle] = field(default_factory=dict)

    def put(self, cloud: Cloud | None, colours: Colours | None, first: int) -> None:
        """Other points in place of those before."""
        self._clear()
        self.cloud, self.colours = cloud, colours
        self.show(self.shown, first)

    def paint(self, colours: Colours, first: int) -> None:
        """Other colours for the same points."""
        self.colours = colours
        for frame, node in self._ordered(first):
            if self.cloud is not None:
                node.colors = colours[self.cloud.of(frame)]

    def resize(self, size_m: float, first: int) -> None:
        """Another size of points."""
        self.size_m = size_m
        for _, node in self._ordered(first):
            node.point_size = size_m

    def show(self, shown: bool, first: int) -> None:
        """Show the points or not."""
        self.shown = shown
        if shown and not self._nodes:
            self._send(first)
        for _, node in self._ordered(first):
            node.visible = shown

    def _send(self, first: int) -> None:
        if self.cloud is None or self.colours is None:
            return
        for frame in self.stage.from_frame(first):
            points = self.cloud.of(frame)
            if points.stop > points.start:
                self._nodes[frame] = self.stage.server.scene.add_point_cloud(
                    self.stage.name(frame, self.name),
                    self.cloud.points[points],
                    self.colours[points],
                    point_size=self.size_m,
                    point_shading="gradient",
                    point_shape="circle",
                )

    def _ordered(self, first: int) -> list[tuple[int, PointCloudHandle]]:
        """The nodes, the one of that frame first."""
        return [(frame, self._nodes[frame]) for frame in self.stage.from_frame(first) if frame in self._nodes]

    def _clear(self) -> None:
        for node in self._nodes.values():
            node.remove()
        self._nodes.clear()


@dataclass(kw_only=True, eq=False)
class LineLayer:
    """Lines, the same in all frames or others in each."""

    stage: Stage
    name: str
    thick_m: float
    lines: Sequence[Lines] = ()
    """One entry for all frames, or one a frame."""
    shown: bool = False
    _nodes: list[LineSegmentsHandle] = field(default_factory=list)

    def put(self, lines: Sequence[Lines], first: int) -> None:
        """Other lines in place of those before."""
        for node in self._nodes:
            node.remove()
        self._nodes.clear()
        self.lines = lines
        self.show(self.shown, first)

    def show(self, shown: bool, first: int) -> None:
        """Show the lines or not."""
        self.shown = shown
        if shown and not self._nodes:
            if len(self.lines) == 1:
                self._add(f"/lines/{self.name}", self.lines[0], np.zeros(3))
            elif self.lines:
                for frame in self.stage.from_frame(first):
                    self._add(self.stage.name(frame, self.name), self.lines[frame], self.stage.space.middle)
        for node in self._nodes:
            node.visible = shown

    def _add(self, name: str, lines: Lines, origin: Place) -> None:
        if len(lines):
            colours = np.repeat(linear(lines.colours)[:, None], 2, axis=1)
            ends = (lines.ends - origin).astype(np.float32)
            scene = self.stage.server.scene
            self._nodes.append(scene.add_line_segments(name, ends, colours, thickness=self.thick_m))


@dataclass(kw_only=True, eq=False)
class NodeLayer:
    """Nodes that are made when they are first shown, whatever they are."""

    make: Callable[[int], list[SceneNodeHandle]]
    """Makes them, those of a frame first."""
    shown: bool = False
    _nodes: list[SceneNodeHandle] = field(default_factory=list)

    def show(self, shown: bool, first: int) -> None:
        """Show the nodes or not."""
        self.shown = shown
        if shown and not self._nodes:
            self._nodes = self.make(first)
        for node in self._nodes:
            node.visible = shown

    def clear(self) -> None:
        """Remove the nodes; the next time they are shown they are made anew."""
        for node in self._nodes:
            node.remove()
        self._nodes = []


def linear(colours: Colours) -> Colours:
    """The colours that lines must be given to look like those of points: viser's page takes them as light itself."""
    share = colours / 255.0
    light = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return (255.0 * light).round().astype(np.uint8)
