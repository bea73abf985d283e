"""A world whose truth is easy: a square passes behind another; and the motions of a solver without mistakes."""

import numpy as np

from recording.camera import Camera, looking_at, pixel_grid, transformed
from recording.correspondence import track
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.motions import INTER, OBSERVED, Making, Motions, Representative
from recording.recording import Recording
from recording.truth import MeshSequence

FRAMES, FPS = 12, 30.0
PASSING, BOARD = 1, 2
HALF_M = {PASSING: 0.25, BOARD: 0.4}
DEPTH_M = {PASSING: 2.5, BOARD: 2.0}
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def camera(*, upright: bool) -> Camera:
    place = looking_at((0.0, -3.0, 1.2), (0.0, 0.0, 1.0)) if upright else np.eye(4)
    return Camera(width=60, height=40, fx=50.0, fy=52.0, cx=31.0, cy=19.0, world_from_camera=place)


def squares(*, upright: bool = True, name: str = "two squares") -> Recording:
    """The recording with its truth."""
    view = camera(upright=upright)
    objects = (
        ObjectRecord(id=PASSING, name="square", kind="box", moving=True),
        ObjectRecord(id=BOARD, name="board", kind="box", moving=False),
    )
    return Recording(
        metadata=metadata_of(view, frames=FRAMES, fps=FPS, objects=objects, name=name, seed=4),
        frames=tuple(_frame(view, frame) for frame in range(FRAMES)),
        truth={objectid: _mesh(view, objectid) for objectid in (PASSING, BOARD)},
        xray=tuple({PASSING: _layer(view, PASSING, frame)[0]} for frame in range(FRAMES)),
    )


def true_motions(recording: Recording) -> Motions:
    """What is true of the square's pixels of the first frame, as motion 0."""
    labels = recording.frames[0].labels
    assert labels is not None
    ways = track(recording, 0, np.argwhere(labels.objectid == PASSING))
    count = len(ways.places)
    seen = ways.visible.reshape(-1)
    mean = ways.places.mean(axis=0)
    return Motions(
        frame=np.tile(np.arange(FRAMES, dtype=np.int32), count),
        trajectory=np.repeat(np.arange(count, dtype=np.int32) * 2, FRAMES),
        position=ways.places.reshape(-1, 3).astype(np.float32),
        column_row=np.where(seen[:, None], ways.column_row.reshape(-1, 2), np.nan).astype(np.float32),
        segment=np.zeros(count * FRAMES, np.int32),
        motion=np.zeros(count * FRAMES, np.int32),
        source=np.where(seen, OBSERVED, INTER).astype(np.uint8),
        confidence=np.where(seen, 1.0, 0.75).astype(np.float32),
        representatives=(
            Representative(
                motion=0,
                frame=np.arange(FRAMES, dtype=np.int32),
                position=mean,
                observed=ways.visible.any(axis=0),
            ),
        ),
        making=Making(recording_digest=recording.digest(), version="0.1.0"),
    )


def _centre(objectid: int, frame: int) -> float:
    """How far to the right of the camera a square's middle is, metres."""
    return -0.9 + 1.8 * frame / (FRAMES - 1) if objectid == PASSING else 0.0


def _mesh(view: Camera, objectid: int) -> MeshSequence:
    half = HALF_M[objectid]
    corners = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
    moments = range(FRAMES if objectid == PASSING else 1)
    places = [corners + np.array([_centre(objectid, frame), 0.0, DEPTH_M[objectid]]) for frame in moments]
    return MeshSequence(faces=FACES, vertices=transformed(view.world_from_camera, np.stack(places)).astype(np.float32))


def _layer(view: Camera, objectid: int, frame: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depth, and the place on the square from 0 to 1 across and down; NaN beside it."""
    depth = np.full((view.height, view.width), DEPTH_M[objectid])
    place = view.camera_from_pixel(pixel_grid(view.height, view.width), depth)
    half = HALF_M[objectid]
    across, down = (place[..., 0] - _centre(objectid, frame) + half) / (2 * half), (place[..., 1] + half) / (2 * half)
    inside = (across > 0) & (across < 1) & (down > 0) & (down < 1)
    return np.where(inside, depth, np.nan).astype(np.float32), across, down


def _frame(view: Camera, frame: int) -> Frame:
    depth = np.full((view.height, view.width), np.float32(np.nan))
    objectid, face = np.zeros(depth.shape, np.uint32), np.zeros(depth.shape, np.uint32)
    u, v = np.zeros(depth.shape, np.float32), np.zeros(depth.shape, np.float32)
    for number in (PASSING, BOARD):  # From the far one to the near one.
        own, across, down = _layer(view, number, frame)
        there, second = np.isfinite(own), down > across
        depth[there], objectid[there] = own[there], number
        face[there] = second[there]
        u[there] = np.where(second, across, across - down)[there]
        v[there] = np.where(second, down - across, down)[there]
    return Frame(depth=depth, labels=Labels(objectid=objectid, face=face, u=u, v=v))
