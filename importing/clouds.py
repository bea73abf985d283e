"""Sequences of point clouds, one file a frame."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float

from importing.calibration import INTRINSICS, Calibration
from importing.cloud_files import SUFFIXES, cloud
from importing.images import series, usual_depth
from importing.scanner_plane import depth_of, scanner_camera
from importing.source import DepthSource, Wanted
from recording.camera import Camera, transformed
from recording.errors import InputError
from recording.frame import Frame
from recording.progress import tracked

AXES: dict[str, list[list[float]]] = {
    "opencv": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
    "opengl": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]],
    "ros": [[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]],
}
"""`world_from_camera` of a scanner at the origin, by how the points' axes are meant: x right, y down, z forward; or
x right, y up, z backward; or x forward, y left, z up."""


def cloud_folder(source: Path, wanted: Wanted) -> DepthSource:
    """The clouds in a folder, projected on the scanner's plane.

    The points' axes are the world's. The pixels are the scanner's own where the user says them, else as large as they
    can be without two points in one. A point's unit is a metre unless `scale` says otherwise.
    """
    paths = series(source, wanted.pattern, SUFFIXES, "point clouds")
    wrong = next((path for path in paths if path.suffix.lower() not in SUFFIXES), None)
    if wrong is not None:
        raise InputError(f"{wrong}: expected point clouds that end in {', '.join(SUFFIXES)}: pass another pattern")
    known = wanted.known
    world_from_camera = np.array(known.world_from_camera or AXES[wanted.axes], dtype=np.float64)
    read = partial(_clouds, paths, np.linalg.inv(world_from_camera), known.scale or 1.0)
    if any(getattr(known, name) is not None for name in INTRINSICS):
        camera = _own_camera(known, world_from_camera, source)
    else:
        seen = tracked(read(), "looking for the smallest distance", total=len(paths))
        camera = scanner_camera(seen, world_from_camera, source=str(source))
    return DepthSource(
        kind="point clouds",
        height=camera.height,
        width=camera.width,
        count=len(paths),
        frames=partial(_frames, read, camera),
        camera=camera,
    )


def _own_camera(known: Calibration, world_from_camera: Float[np.ndarray, "4 4"], source: Path) -> Camera:
    if known.width is None or known.height is None:
        raise InputError(f"{source}: expected the picture's size beside the scanner's fx and fy: pass --size WxH")
    if any(known.distortion or ()):
        raise InputError(f"{source}: expected a scanner without distortion, as points have none: leave it out")
    placed = known.model_copy(update={"world_from_camera": tuple(map(tuple, world_from_camera.tolist()))})
    return placed.camera(known.width, known.height, source=str(source))


def _clouds(
    paths: list[Path], camera_from_world: Float[np.ndarray, "4 4"], scale: float
) -> Iterator[Float[np.ndarray, "point 3"]]:
    """The points in the camera's axes, metres."""
    for path in paths:
        yield transformed(camera_from_world, scale * cloud(path))


def _frames(read: "partial[Iterator[np.ndarray]]", camera: Camera) -> Iterator[Frame]:
    for number, points in enumerate(read()):
        yield Frame(depth=usual_depth(depth_of(points, camera), source=f"point cloud {number}"))
