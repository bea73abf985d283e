"""Small scenes with known answers for sensors: walls of one depth, before one camera."""

import numpy as np

from recording.camera import Camera
from recording.frame import Frame
from recording.truth import MeshSequence
from simulator.backend import find_backend
from simulator.pictures import Stage, pictures
from simulator.sensor import SensorModel

CAMERA = Camera(width=160, height=120, fx=140.0, fy=140.0, cx=80.0, cy=60.0, world_from_camera=np.eye(4))


def wall(depth: float, left: float = -50.0, right: float = 50.0, *, slope: float = 0.0) -> MeshSequence:
    """An upright wall between two x, metres, at a depth that grows with x by the slope."""
    corners = [(x, y, depth + slope * x) for x in (left, right) for y in (-50.0, 50.0)]
    return MeshSequence(
        faces=np.array([[0, 1, 2], [1, 3, 2]], np.int32), vertices=np.array([corners], dtype=np.float32)
    )


def sensed(sensor: SensorModel, *walls: MeshSequence, camera: Camera = CAMERA, frames: int = 1) -> list[Frame]:
    """Frames of the walls, which have the ids 1, 2, ..."""
    still = dict(enumerate(walls, start=1))
    stage = Stage(camera=camera, moving={}, still=still, frames=frames, sensor=sensor)
    return [frame for frame, _ in pictures(stage, find_backend("auto"))]


def errors(sensor: SensorModel, *walls: MeshSequence, frames: int = 4, camera: Camera = CAMERA) -> np.ndarray:
    """Sensed less exact depth, (frame, row, column), metres; NaN without return."""
    return np.stack([frame.depth - frame.clean_depth for frame in sensed(sensor, *walls, frames=frames, camera=camera)])
