"""The pictures of a scene: each object's alone, and from these the picture of all of them.

What is nearest in a pixel is what is nearest among the objects' own pictures. So the X-ray twin costs nothing
but its storage, and what is seen of an object is to the bit what its X-ray shows.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np

from recording.camera import Camera
from recording.frame import Frame, Labels, Reason
from recording.truth import MeshSequence
from recording.xray import Cutout, CutoutXRay
from simulator.backend import Backend
from simulator.raycast import Hits, RayCaster
from simulator.sensor import Ideal, SensorModel, sensed_frame
from simulator.view import View
from simulator.window import Window


@dataclass(frozen=True, kw_only=True, eq=False)
class Stage:
    """All that is before the camera, in a row of frames."""

    camera: Camera
    moving: Mapping[int, MeshSequence]
    """By object id: what has an X-ray picture."""
    still: Mapping[int, MeshSequence]
    """By object id: what stands in all frames where it stands in the first."""
    frames: int
    """How many frames there are."""
    restless: Mapping[int, MeshSequence] = field(default_factory=dict)
    """By object id: what stands but has parts that move, as a juggler's arms; it has no X-ray picture."""
    sensor: SensorModel = field(default_factory=Ideal)
    first: int = 0
    """The number of the first frame in the recording: a sensor's noise goes by it."""
    step: int = 1
    """How much further the number of the next frame is."""

    def every(self, step: int, *, begin: int) -> "Stage":
        """The same with only the frames `begin`, `begin + step` and so on."""
        moving, restless = (
            {
                objectid: MeshSequence(faces=mesh.faces, vertices=mesh.vertices[begin::step]) if mesh.moving else mesh
                for objectid, mesh in meshes.items()
            }
            for meshes in (self.moving, self.restless)
        )
        frames = len(range(begin, self.frames, step))
        first, step = self.first + begin * self.step, self.step * step
        return replace(self, moving=moving, restless=restless, frames=frames, first=first, step=step)


def pictures(stage: Stage, backend: Backend) -> Iterator[tuple[Frame, CutoutXRay]]:
    """Each frame, as the sensor sees it, with its X-ray twin, which is exact; none is kept."""
    shape = (stage.camera.height, stage.camera.width)
    background = RayCaster(stage.still, stage.camera, backend).cast(0)
    changing = {**stage.moving, **stage.restless}
    casters = {objectid: RayCaster({objectid: mesh}, stage.camera, backend) for objectid, mesh in changing.items()}
    for number in range(stage.frames):
        windows = {objectid: caster.window(number) for objectid, caster in casters.items()}
        alone = {objectid: caster.cast(number, windows[objectid]) for objectid, caster in casters.items()}
        nearest = _nearest(background, [(windows[objectid], alone[objectid]) for objectid in sorted(alone)])
        xray = {
            objectid: Cutout(row=windows[objectid][0].start, column=windows[objectid][1].start, depth=hits.depth)
            for objectid, hits in alone.items()
            if objectid in stage.moving
        }
        exact, place = _exact_frame(nearest), stage.first + number * stage.step
        view = View(camera=stage.camera, meshes={**stage.still, **changing}, frame=number)
        yield sensed_frame(exact, view, stage.sensor, number=place), CutoutXRay(xray, shape)


def _nearest(background: Hits, layers: list[tuple[Window, Hits]]) -> Hits:
    """What is nearest in each pixel; of equals the one that comes first."""
    picture = Hits(**{each.name: getattr(background, each.name).copy() for each in fields(Hits)})
    for window, hits in layers:
        # A comparison with NaN is false: so what meets nothing hides nothing, and nothing hides before nothing.
        nearer = ~(picture.depth[window] <= hits.depth) & np.isfinite(hits.depth)
        for each in fields(Hits):
            np.copyto(getattr(picture, each.name)[window], getattr(hits, each.name), where=nearer)
    return picture


def _exact_frame(hits: Hits) -> Frame:
    """The frame before any sensor."""
    return Frame(
        depth=hits.depth,
        labels=Labels(objectid=hits.objectid, face=hits.face, u=hits.u, v=hits.v),
        clean_depth=hits.depth,
        reason=np.where(hits.objectid > 0, np.uint32(Reason.RETURN), np.uint32(Reason.NOTHING_THERE)),
    )
