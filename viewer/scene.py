"""The session in three dimensions: which layers there are, and how they follow what changes."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float
from viser import LabelHandle, SceneClickEvent, SceneNodeHandle, ViserServer

from recording.motions import INTER, INTRA, Representative
from recording.palette import rgb_of
from viewer.boxes import Boxes, boxes_of
from viewer.clouds import Cloud, motion_cloud, sensed_cloud
from viewer.colours import Shades, bare_colours, motion_colours, pale
from viewer.highlight import Highlight
from viewer.lines import curve_lines, hole_lines, link_lines, links_of, segment_lines, segment_places
from viewer.session import Session
from viewer.stage import CloudLayer, Layer, LineLayer, NodeLayer, Stage
from viewer.surroundings import camera_nodes, depth_bounds, nearest_to_ray, put_ground, still_nodes

SHOWN = ("still", "observed", "intra", "inter", "representatives", "motions", "camera")
"""The layers that are shown at first, where there are motions; else what was sensed and the camera."""
_OVERLAP = 1.3
"""Size of points at first, in pixels of the camera at the usual distance: they close into a surface."""
_OBSERVED, _INTRA, _INTER = "observed", "intra", "inter"
_SOURCE = {_INTRA: INTRA, _INTER: INTER}


class Scene:
    """The layers by name, and what of them is shown."""

    def __init__(self, server: ViserServer, session: Session) -> None:
        self.server, self.session = server, session
        self.stage = Stage(server, session.space, session.frames)
        self.depth_m = depth_bounds(session.bare)
        self.point_m = _OVERLAP * sum(self.depth_m) / 2 / session.recording.camera.fx
        self._names: dict[int, LabelHandle] = {}
        self._boxes: Boxes | None = None
        self._segment_places: tuple[Representative, ...] = ()
        self.layers: Mapping[str, Sequence[Layer]] = self._made_layers()
        self.shown = dict.fromkeys(self.layers, False)
        put_ground(self.stage)
        self._look()
        self._sensed.put(cloud := sensed_cloud(session.bare, session.space), self._bare(cloud), 0)
        self._highlight = Highlight(self.stage, self.point_m)
        self._answer()
        for name in SHOWN if session.answer else ("sensed", "camera"):
            self.show(name, True)
        session.playback.moved.connect(self._move)
        session.answered.connect(self._answer)
        session.judged.connect(self._rename)
        session.recoloured.connect(self._paint)
        session.jury.truth_known.connect(self._learn)
        session.marks.changed.connect(self._mark)
        server.scene.on_click()(self._clicked)

    @property
    def shades(self) -> Shades:
        """What decides on colours now."""
        session = self.session
        return Shades(
            colouring=session.colouring, depth_m=self.depth_m, picked=session.picked, marked=session.marks.segments
        )

    def show(self, name: str, shown: bool) -> None:
        """Show a layer or not."""
        self.shown[name] = shown
        with self.server.atomic():
            for layer in self.layers[name]:
                layer.show(shown, self.session.frame)
        self._place_names()

    def resize(self, point_m: float) -> None:
        """Another size of points, metres."""
        self.point_m = point_m
        for layer in self._clouds:
            layer.resize(point_m, self.session.frame)

    def pick_along(self, origin: Float[np.ndarray, "3"], direction: Float[np.ndarray, "3"]) -> None:
        """Pick the motion of the first point that a ray through the world meets, or mark its segment.

        Where it meets none, none is picked, and none marked.
        """
        answer, frame = self.session.answer, self.session.frame
        if answer is None:
            return
        points, rows = [np.zeros((0, 3))], [np.zeros(0, int)]
        for layer in (self._observed, self._intra, self._inter):
            if layer.shown and layer.cloud is not None and layer.cloud.row is not None:
                here = layer.cloud.of(frame)
                points.append(layer.cloud.points[here].astype(np.float64))
                rows.append(layer.cloud.row[here])
        nearest = nearest_to_ray(np.concatenate(points), origin - self.session.space.middle, direction)
        self.session.click(None if nearest is None else int(np.concatenate(rows)[nearest]))

    def _made_layers(self) -> dict[str, Sequence[Layer]]:
        stage, size, thick = self.stage, self.session.space.size_m, 0.002 * self.session.space.size_m
        self._sensed, self._xray, self._observed, self._intra, self._inter = (
            CloudLayer(stage=stage, name=name, size_m=self.point_m)
            for name in ("sensed", "xray", _OBSERVED, _INTRA, _INTER)
        )
        self._clouds = (self._sensed, self._xray, self._observed, self._intra, self._inter)
        self._places = CloudLayer(stage=stage, name="places", size_m=0.012 * size)
        self._curves = LineLayer(stage=stage, name="curves", thick_m=thick)
        self._box_lines = LineLayer(stage=stage, name="boxes", thick_m=0.5 * thick)
        self._paths = LineLayer(stage=stage, name="segments", thick_m=0.8 * thick)
        self._numbers = NodeLayer(make=self._number_labels)
        self._holes = LineLayer(stage=stage, name="holes", thick_m=2.5 * thick)
        self._links = LineLayer(stage=stage, name="links", thick_m=2.0 * thick)
        camera = NodeLayer(make=lambda first: camera_nodes(stage, self.session.bare, self.depth_m, first))
        still = NodeLayer(make=lambda _: still_nodes(stage, self.session.bare, self.session.settings, self.point_m))
        return {
            "still": [still],
            "sensed": [self._sensed],
            "truth": [self._xray],
            "observed": [self._observed],
            "intra": [self._intra],
            "inter": [self._inter],
            "representatives": [self._curves, self._places],
            "motions": [self._box_lines],
            "segments": [self._paths, self._numbers],
            "holes": [self._holes],
            "camera": [camera],
        }

    def _look(self) -> None:
        space, view = self.session.space, self.server.initial_camera
        self.server.scene.set_up_direction(space.up)
        view.up, view.position, view.look_at = space.up, space.eye, space.target

    def _move(self) -> None:
        with self.server.atomic():
            self.stage.show(self.session.frame)
            self._place_names()

    def _answer(self) -> None:
        """Put the motions' layers, now of other motions."""
        session, first, shades = self.session, self.session.frame, self.shades
        answer = session.answer
        if answer is None:
            return
        motions = answer.motions
        rows = {_OBSERVED: motions.observed} | {name: motions.source == source for name, source in _SOURCE.items()}
        with self.server.atomic():
            for layer in (self._observed, self._intra, self._inter):
                cloud = motion_cloud(motions, rows[layer.name], session.recording, session.space)
                layer.put(cloud, motion_colours(cloud, answer, shades), first)
            self._boxes = boxes_of(motions)
            self._segment_places = segment_places(motions)
            self._paths.put([segment_lines(self._segment_places)], first)
            self._numbers.clear()
            self._numbers.show(self._numbers.shown, first)
            self._put_curves()
            self._put_holes()
            self._put_marks()
            self._rename()

    def _paint(self) -> None:
        """Other colours for everything."""
        first, shades, answer = self.session.frame, self.shades, self.session.answer
        with self.server.atomic():
            for bare in (self._sensed, self._xray):
                if bare.cloud is not None:
                    bare.paint(bare_colours(bare.cloud, shades, truth=bare is self._xray), first)
            for layer in (self._observed, self._intra, self._inter):
                if answer is not None and layer.cloud is not None:
                    layer.paint(motion_colours(layer.cloud, answer, shades), first)
            self._put_curves()

    def _mark(self) -> None:
        self._paint()
        self._put_marks()

    def _put_marks(self) -> None:
        answer = self.session.answer
        with self.server.atomic():
            self._highlight.put(self.session.marks, answer.motions if answer else None, self._segment_places)

    def _put_curves(self) -> None:
        """The curves, their places now, the boxes and the links: few lines, put anew whenever colours change."""
        session, first = self.session, self.session.frame
        answer = session.answer
        if answer is None or self._boxes is None:
            return
        self._curves.put([curve_lines(answer.curves, session.picked)], first)
        self._box_lines.put(self._boxes.lines(session.picked, session.frames), first)
        frame = np.concatenate([np.zeros(0, int), *(curve.frame for curve in answer.curves)])
        motion = np.repeat([curve.motion for curve in answer.curves], [len(curve.frame) for curve in answer.curves])
        position = np.concatenate([np.zeros((0, 3)), *(curve.position for curve in answer.curves)])
        order = np.argsort(frame, kind="stable")
        cloud = Cloud(
            points=session.space.near(position[order]),
            begin=np.searchsorted(frame[order], np.arange(session.frames + 1)),
            depth_m=np.zeros(len(order), np.float32),
        )
        number = motion[order].astype(int)
        others = np.full(len(number), False) if session.picked is None else number != session.picked
        self._places.put(cloud, pale(rgb_of(number), others), first)
        links = links_of(answer.motions, session.picked) if session.picked is not None else []
        self._links.put([link_lines(links, self._segment_places)], first)
        self._links.show(bool(links), first)

    def _put_holes(self) -> None:
        curves = self.session.answer.curves if self.session.answer else ()
        self._holes.put([hole_lines(self.session.jury.visibility, curves)], self.session.frame)

    def _learn(self) -> None:
        """The truth is known now."""
        if (xray := self.session.jury.xray) is not None:
            self._xray.put(xray, self._bare(xray, truth=True), self.session.frame)
        self._put_holes()

    def _bare(self, cloud: Cloud, *, truth: bool = False) -> np.ndarray:
        return bare_colours(cloud, self.shades, truth=truth)

    def _rename(self) -> None:
        """The motions' names above their boxes."""
        for label in self._names.values():
            label.remove()
        answer, scene = self.session.answer, self.server.scene
        names = {motion: answer.name(motion) for motion in answer.motions.motion_ids} if answer else {}
        self._names = {
            motion: scene.add_label(f"/names/{motion}", name, anchor="bottom-center", visible=False)
            for motion, name in names.items()
        }
        self._place_names()

    def _place_names(self) -> None:
        """Each name above its motion's box; where there is none it is not shown."""
        shown: dict[int, np.ndarray] = {}
        if self._boxes is not None and self.shown["motions"]:
            here = np.flatnonzero(self._boxes.frame == self.session.frame)
            tops = self._boxes.tops(self.session.space.up)[here]
            shown = dict(zip(self._boxes.motion[here].tolist(), tops, strict=True))
        for motion, label in self._names.items():
            label.visible = motion in shown
            if motion in shown:
                label.position = shown[motion]

    def _number_labels(self, first: int) -> list[SceneNodeHandle]:
        """The number of each segment where it begins."""
        return [
            self.server.scene.add_label(
                f"/numbers/{place.motion}", str(place.motion), position=place.position[0], anchor="center-center"
            )
            for place in self._segment_places
        ]

    def _clicked(self, event: SceneClickEvent) -> None:
        origin, direction = np.array(event.ray_origin, float), np.array(event.ray_direction, float)
        self.session.post(lambda: self.pick_along(origin, direction))
