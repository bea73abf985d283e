"""`recording.json`: what is known about a recording beside its frames."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PositiveInt, field_validator, model_validator

from recording.camera import PIXEL_CENTRE, Camera
from recording.checks import Frozen, validated
from recording.occlusion import Occlusion

Side = Annotated[int, Field(ge=1, le=16384)]
"""Of a picture, pixels: a larger one is a mistake, or would fill the memory."""
Focal = Annotated[float, Field(ge=1e-3, le=1e6)]
"""Pixels; outside of this range the picture of anything would be a point, or that of a point fill it."""
Centre = Annotated[float, Field(ge=-1e6, le=1e6)]
Row = tuple[float, float, float, float]
_FARTHEST_M = 1e5
"""From the world's origin: beyond it single precision no longer tells points a centimetre apart."""


class Format(Frozen):
    """Which kind of document this is."""

    name: Literal["unocclude-recording"] = "unocclude-recording"
    version: Literal[1] = 1


class CameraRecord(Frozen):
    """The camera as JSON; `recording.camera.Camera` is the same as a value to compute with."""

    fx: Focal
    fy: Focal
    cx: Centre
    cy: Centre
    world_from_camera: tuple[Row, Row, Row, Row]
    """Rigid 4x4 transform, OpenCV axes, metres."""

    @field_validator("world_from_camera")
    @classmethod
    def _rigid(cls, rows: tuple[Row, Row, Row, Row]) -> tuple[Row, Row, Row, Row]:
        matrix = np.array(rows)
        rotation = matrix[:3, :3]
        small = np.all(np.abs(rotation) < 2)  # So that nothing overflows.
        if not (small and np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-4) and np.linalg.det(rotation) > 0):
            raise ValueError("expected a rotation and a translation, without scale or mirroring")
        if not np.array_equal(matrix[3], [0, 0, 0, 1]):
            raise ValueError("expected (0, 0, 0, 1) as the last row")
        if np.any(np.abs(matrix[:3, 3]) > _FARTHEST_M):
            raise ValueError(f"expected a camera within {_FARTHEST_M:g} m of the world's origin")
        return rows


class DepthRecord(Frozen):
    """How the channel `Z` is to be read."""

    unit: Literal["metre"] = "metre"
    kind: Literal["z"] = "z"
    """Distance along the camera's z axis, not along the ray."""
    no_return: Literal[0] = 0


class ObjectRecord(Frozen):
    """One object of a recording whose truth is known."""

    id: PositiveInt
    name: str
    kind: str
    """person, ball, box, cylinder, cone, ..."""
    moving: bool


class CarriedRecord(Frozen):
    """A stretch of frames in which one object lies in another's hand and moves as a part of it."""

    object: PositiveInt
    by: PositiveInt
    """The id of who carries it."""
    first: int = Field(ge=0)
    """The first frame of it: above 0 it was caught."""
    stop: int = Field(ge=1)
    """The frame after the last: before the recording's end it was let go."""


class RemovedRecord(Frozen):
    """What was left out of the frames on import."""

    what: Literal["ground", "background"]
    """The largest plane and what is below it; or what stands still behind everything."""
    share: float = Field(ge=0, le=1)
    """Of all returns of the source, how many were left out for it."""
    distance_m: float | None = Field(default=None, gt=0)
    """Of the camera from the ground."""


class Metadata(Frozen):
    """The content of `recording.json`. Only what a real recording knows is required."""

    format: Format
    name: str | None = None
    frames: PositiveInt
    fps: Annotated[float, Field(ge=1e-3, le=1e6)]
    width: Side
    height: Side
    camera: CameraRecord
    depth: DepthRecord
    pixel_centre: float = Field(default=PIXEL_CENTRE, ge=PIXEL_CENTRE, le=PIXEL_CENTRE)
    timestamps: tuple[Annotated[float, Field(ge=-1e12, le=1e12)], ...] | None = None
    """Seconds, one a frame."""
    sensor: dict[str, Any] | None = None
    """Preset and parameters of the simulated sensor."""
    seed: int | None = None
    objects: tuple[ObjectRecord, ...] | None = None
    carried: tuple[CarriedRecord, ...] | None = None
    """What lies in whose hand, and when; a recording in which nothing is carried has no such key."""
    scene: dict[str, Any] | None = None
    """The whole scene, resolved."""
    scene_digest: str | None = None
    occlusion: Occlusion | None = None
    """How much is hidden, for how long and by what."""
    removed: tuple[RemovedRecord, ...] | None = None
    """What was left out on import, in that order; a recording that has all its returns has no such key."""
    made_by: str | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Metadata":
        if self.timestamps is not None:
            if len(self.timestamps) != self.frames:
                raise ValueError(f"expected {self.frames} timestamps, one a frame, got {len(self.timestamps)}")
            if np.any(np.diff(self.timestamps) <= 0):
                raise ValueError("expected timestamps that grow from frame to frame")
        ids = [entry.id for entry in self.objects or ()]
        if len(set(ids)) != len(ids):
            raise ValueError("expected every object id once")
        if any({each.object, each.by} - set(ids) or not each.first < each.stop for each in self.carried or ()):
            raise ValueError("expected 'carried' to name two of the objects, and a 'first' frame before 'stop'")
        return self

    def as_camera(self) -> Camera:
        """The camera to compute with."""
        return Camera(
            width=self.width,
            height=self.height,
            fx=self.camera.fx,
            fy=self.camera.fy,
            cx=self.camera.cx,
            cy=self.camera.cy,
            world_from_camera=np.array(self.camera.world_from_camera),
        )


def camera_record(camera: Camera) -> CameraRecord:
    """The camera as it stands in `recording.json`."""
    matrix = [tuple(map(float, row)) for row in camera.world_from_camera]
    known = {"fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy, "world_from_camera": matrix}
    return validated(CameraRecord, known, source="camera")


def metadata_of(camera: Camera, *, frames: int, fps: float, **known: Any) -> Metadata:
    """The metadata of a recording through the camera; `known` are further keys of `Metadata`.

    InputError where a recording may not be so, as a camera's numbers out of bounds.
    """
    document = {
        "format": Format(),
        "frames": frames,
        "fps": fps,
        "width": camera.width,
        "height": camera.height,
        "camera": camera_record(camera),
        "depth": DepthRecord(),
        **known,
    }
    return validated(Metadata, document, source="recording")
