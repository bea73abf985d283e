"""A crossing whose truth is known by construction: two squares, a wall that hides both, a strip of ground.

Everything stands upright at a constant depth, and the squares move by exactly one pixel a frame: a material point that
is a pixel's centre once stays one.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from recording.camera import Camera, pixel_grid
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.motions import INTER, NOISE, OBSERVED, Link, Making, Motions, mean_places
from recording.recording import Recording
from recording.truth import MeshSequence

FRAMES = 36
CAMERA = Camera(width=64, height=30, fx=40.0, fy=40.0, cx=32.0, cy=15.0, world_from_camera=np.eye(4))
LEFT, RIGHT, WALL, GROUND = 1, 2, 7, 9
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def crossing(*, wall: bool = True, lost: float = 0.0) -> Recording:
    """The recording; without the wall nothing is hidden for long; `lost` is the share of returns that fail."""
    meshes = {
        LEFT: _moving(start=-1.35, step=3 / 40, depth=3.0),
        RIGHT: _moving(start=1.8, step=-4 / 40, depth=4.0),
        GROUND: _standing(_corners(0.0, 2.05, 10.0, 1.0, 6.0)),
    }
    if wall:
        meshes[WALL] = _standing(_corners(0.0, 0.0, 0.9, 0.9, 2.0))
    generator = np.random.default_rng(0)
    frames = [
        _frame(meshes, number, generator.random((CAMERA.height, CAMERA.width)) < lost) for number in range(FRAMES)
    ]
    xray = [{key: _seen(meshes[key], number)[0] for key in (LEFT, RIGHT)} for number in range(FRAMES)]
    objects = [
        ObjectRecord(
            id=key, name=f"object {key}", kind="ground" if key == GROUND else "box", moving=key in (LEFT, RIGHT)
        )
        for key in meshes
    ]
    metadata = metadata_of(CAMERA, frames=FRAMES, fps=30.0, name="crossing", objects=tuple(objects))
    return Recording(metadata=metadata, frames=frames, truth=meshes, xray=xray)


def masks_only(recording: Recording) -> Recording:
    """What an imported recording knows: depth and the masks of what moves."""
    frames = []
    for frame in recording.frames:
        assert frame.labels is not None
        moving = np.isin(frame.labels.objectid, recording.moving_ids)
        objectid = np.where(moving, frame.labels.objectid, 0).astype(np.uint32)
        frames.append(Frame(depth=frame.depth, labels=Labels(objectid=objectid)))
    return Recording(metadata=recording.metadata.model_copy(update={"objects": None}), frames=frames)


def perfect(recording: Recording) -> Motions:
    """Every material point of the squares' pixel centres, followed through all frames, in the right motion."""
    parts = [_followed(recording, objectid) for objectid in (LEFT, RIGHT)]
    parts[1]["trajectory"] += parts[0]["trajectory"].max() + 1
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    making = Making(
        settings={"preset": "perfect"},
        recording_digest=recording.digest(),
        seconds={"flow": 1.0, "total": 2.0},
    )
    links = (Link(before=10, after=11, confidence=1.0), Link(before=20, after=21, confidence=1.0))
    motions = Motions(**columns, links=links, making=making)
    return replace(motions, representatives=mean_places(motions))


def empty() -> Motions:
    """A solver that found nothing."""
    return Motions(
        frame=np.zeros(0, np.int32),
        trajectory=np.zeros(0, np.int32),
        position=np.zeros((0, 3), np.float32),
        column_row=np.zeros((0, 2), np.float32),
        segment=np.zeros(0, np.int32),
        motion=np.zeros(0, np.int32),
        source=np.zeros(0, np.uint8),
        confidence=np.zeros(0, np.float32),
    )


def with_rows(motions: Motions, **columns: np.ndarray) -> Motions:
    """The motions with other columns, and with the representatives that follow from them."""
    changed = replace(motions, **columns)
    return replace(changed, representatives=mean_places(changed))


def without_rows(motions: Motions, left_out: np.ndarray) -> Motions:
    """The motions without some rows, and with the representatives that follow from the others."""
    return with_rows(motions.rows(~left_out))


def all_noise(motions: Motions) -> Motions:
    """The observed rows, all of them in no segment and no motion."""
    rows = motions.rows(motions.observed)
    nothing = np.full(len(rows), NOISE, np.int32)
    return replace(rows, segment=nothing, motion=nothing, representatives=(), links=())


def leaves(nested: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """The numbers of nested scores by dotted key; entries of lists are numbered."""
    flat: dict[str, Any] = {}
    for key, value in nested.items():
        inner = {str(number): each for number, each in enumerate(value)} if isinstance(value, list) else value
        flat |= leaves(inner, f"{prefix}{key}.") if isinstance(inner, dict) else {prefix + key: inner}
    return flat


def _corners(x: float, y: float, width: float, height: float, depth: float) -> np.ndarray:
    """A, B, C, D of an upright rectangle round (x, y)."""
    across, down = np.array([-1, 1, 1, -1]) * width / 2, np.array([-1, -1, 1, 1]) * height / 2
    return np.stack([x + across, y + down, np.full(4, depth)], axis=1)


def _standing(corners: np.ndarray) -> MeshSequence:
    return MeshSequence(faces=FACES, vertices=corners[None].astype(np.float32))


def _moving(*, start: float, step: float, depth: float) -> MeshSequence:
    corners = [_corners(start + step * number, 0.0, 1.0, 1.0, depth) for number in range(FRAMES)]
    return MeshSequence(faces=FACES, vertices=np.stack(corners).astype(np.float32))


def _seen(mesh: MeshSequence, number: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Depth (NaN outside), face, u, v of one rectangle at every pixel's centre ray."""
    a, b, _, d = mesh.vertices_at(number).astype(np.float64)
    focal, principal = np.array([CAMERA.fx, CAMERA.fy]), np.array([CAMERA.cx, CAMERA.cy])
    place = (pixel_grid(CAMERA.height, CAMERA.width) - principal) / focal * a[2]
    s, t = (place[..., 0] - a[0]) / (b[0] - a[0]), (place[..., 1] - a[1]) / (d[1] - a[1])
    inside = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    upper = s >= t  # The diagonal A to C parts the faces ABC and ACD.
    depth = np.where(inside, a[2], np.nan).astype(np.float32)
    return depth, np.where(upper, 0, 1), np.where(upper, s - t, s), np.where(upper, t, t - s)


def _frame(meshes: dict[int, MeshSequence], number: int, lost: np.ndarray) -> Frame:
    """What the camera sees: the nearest rectangle at every pixel."""
    ids = list(meshes)
    layers = [_seen(mesh, number) for mesh in meshes.values()]
    depths = np.stack([np.nan_to_num(layer[0], nan=np.inf) for layer in layers])
    nearest = depths.argmin(axis=0)
    depth = depths.min(axis=0)
    face, u, v = (np.choose(nearest, [layer[part] for layer in layers]) for part in (1, 2, 3))
    something = np.isfinite(depth)
    return Frame(
        depth=np.where(something & ~lost, depth, np.nan).astype(np.float32),
        labels=Labels(
            objectid=np.where(something, np.array(ids)[nearest], 0).astype(np.uint32),
            face=face.astype(np.uint32),
            u=u.astype(np.float32),
            v=v.astype(np.float32),
        ),
    )


def _followed(recording: Recording, objectid: int) -> dict[str, np.ndarray]:
    """The rows of one square: observed where its label is seen at the point's pixel, completed elsewhere."""
    assert recording.truth is not None
    mesh = recording.truth[objectid]
    depth, face, u, v = _seen(mesh, 0)
    at_start = np.isfinite(depth)
    points = int(at_start.sum())
    rows: list[dict[str, np.ndarray]] = []
    for number, frame in enumerate(recording.frames):
        assert frame.labels is not None
        place = mesh.material_points(frame=number, face=face[at_start], u=u[at_start], v=v[at_start])
        column_row, _ = CAMERA.pixel_from_world(place)
        column, row = np.floor(column_row).astype(int).T
        seen = (frame.labels.objectid == objectid)[row, column] & frame.seen[row, column]
        after = number > FRAMES // 2
        rows.append(
            {
                "frame": np.full(points, number, np.int32),
                "trajectory": np.arange(points, dtype=np.int32),
                "position": place.astype(np.float32),
                "column_row": np.where(seen[:, None], column_row, np.nan).astype(np.float32),
                "segment": np.full(points, 10 * objectid + after, np.int32),
                "motion": np.full(points, objectid, np.int32),
                "source": np.where(seen, OBSERVED, INTER).astype(np.uint8),
                "confidence": np.ones(points, np.float32),
            }
        )
    columns = {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}
    order = np.lexsort((columns["frame"], columns["trajectory"]))
    return {name: column[order] for name, column in columns.items()}
