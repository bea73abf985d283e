"""The pictures of a scene: each object's alone, and from these the picture of all of them.

What is nearest in a pixel is what is nearest among the objects' own pictures. So the X-ray twin costs nothing
but its storage, and what is seen of an object is to the bit what its X-ray shows.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields

import numpy as np

from recording.camera import Camera
from recording.frame import Frame, Labels
from recording.truth import MeshSequence
from recording.xray import Cutout, CutoutXRay
from simulator.backend import Backend
from simulator.raycast import Hits, RayCaster
from simulator.window import Window

NOTHING_THERE = 1
"""The reason of a pixel whose ray meets nothing (`recording.frame.REASONS`)."""


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

    def every(self, step: int, *, begin: int) -> "Stage":
        """The same with only the frames `begin`, `begin + step` and so on."""
        moving = {
            objectid: MeshSequence(faces=mesh.faces, vertices=mesh.vertices[begin::step]) if mesh.moving else mesh
            for objectid, mesh in self.moving.items()
        }
        frames = len(range(begin, self.frames, step))
        return Stage(camera=self.camera, moving=moving, still=self.still, frames=frames)


def pictures(stage: Stage, backend: Backend) -> Iterator[tuple[Frame, CutoutXRay]]:
    """Each frame, as a sensor without flaws sees it, with its X-ray twin; none is kept."""
    shape = (stage.camera.height, stage.camera.width)
    background = RayCaster(stage.still, stage.camera, backend).cast(0)
    casters = {objectid: RayCaster({objectid: mesh}, stage.camera, backend) for objectid, mesh in stage.moving.items()}
    for number in range(stage.frames):
        windows = {objectid: caster.window(number) for objectid, caster in casters.items()}
        alone = {objectid: caster.cast(number, windows[objectid]) for objectid, caster in casters.items()}
        nearest = _nearest(background, [(windows[objectid], alone[objectid]) for objectid in sorted(alone)])
        xray = {
            objectid: Cutout(row=windows[objectid][0].start, column=windows[objectid][1].start, depth=hits.depth)
            for objectid, hits in alone.items()
        }
        yield _ideal_frame(nearest), CutoutXRay(xray, shape)


def _nearest(background: Hits, layers: list[tuple[Window, Hits]]) -> Hits:
    """What is nearest in each pixel; of equals the one that comes first."""
    picture = Hits(**{field.name: getattr(background, field.name).copy() for field in fields(Hits)})
    for window, hits in layers:
        # A comparison with NaN is false: so what meets nothing hides nothing, and nothing hides before nothing.
        nearer = ~(picture.depth[window] <= hits.depth) & np.isfinite(hits.depth)
        for field in fields(Hits):
            np.copyto(getattr(picture, field.name)[window], getattr(hits, field.name), where=nearer)
    return picture


def _ideal_frame(hits: Hits) -> Frame:
    """The frame as a sensor without flaws sees it."""
    return Frame(
        depth=hits.depth,
        labels=Labels(objectid=hits.objectid, face=hits.face, u=hits.u, v=hits.v),
        clean_depth=hits.depth,
        reason=np.where(hits.objectid > 0, np.uint32(0), np.uint32(NOTHING_THERE)),
    )
