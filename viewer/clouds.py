"""Points by frame, packed as the browser wants them before anybody plays."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float16, Float32, Int

from recording.camera import Camera, transformed
from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import surface_points
from viewer.space import Space

MOST_POINTS = 3_000_000
"""Points of one layer in all frames at the most; of more, every so-manieth of a frame is shown."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cloud:
    """The points of one layer, sorted by frame."""

    points: Float16[np.ndarray, "point 3"]
    """World axes, metres from the space's middle."""
    begin: Int[np.ndarray, "bound"]
    """Where the points of each frame begin, and at last their number."""
    depth_m: Float32[np.ndarray, "point"]
    """Distance along the camera's z axis."""
    row: Int[np.ndarray, "point"] | None = None
    """Of each point its row in the motions, where it comes from one."""
    step: int = 1
    """Every so-manieth point is shown in the fullest frame."""

    def of(self, frame: int) -> slice:
        """The points of a frame."""
        return slice(int(self.begin[frame]), int(self.begin[frame + 1]))


def sensed_cloud(recording: Recording, space: Space, *, most: int = MOST_POINTS) -> Cloud:
    """What the sensor saw."""
    camera = recording.camera
    frames = (surface_points(camera, frame.depth) for frame in recording.frames)
    return _packed(frames, recording, space, "sensed points", most)


def xray_cloud(recording: Recording, space: Space, *, most: int = MOST_POINTS) -> Cloud:
    """The front sides of all moving objects, hidden or not; without X-ray there are no points."""
    camera, nothing = recording.camera, np.zeros((0, 3))
    if recording.xray is None:
        return _packed((nothing for _ in range(recording.metadata.frames)), recording, space, "X-rays", most)
    frames = (
        np.concatenate([nothing, *(surface_points(camera, depth) for depth in xray.values())])
        for xray in recording.xray
    )
    return _packed(frames, recording, space, "X-rays", most)


def motion_cloud(
    motions: Motions, chosen: Bool[np.ndarray, "observation"], recording: Recording, space: Space
) -> Cloud:
    """The chosen rows of the motions."""
    row = np.flatnonzero(chosen)
    row = row[np.argsort(motions.frame[row], kind="stable")]
    frame = motions.frame[row]
    share = -(-len(row) // MOST_POINTS) or 1
    row, frame = row[::share], frame[::share]
    position = motions.position[row].astype(np.float64)
    return Cloud(
        points=space.near(position),
        begin=np.searchsorted(frame, np.arange(recording.metadata.frames + 1)),
        depth_m=_depth(recording.camera, position),
        row=row,
        step=share,
    )


def _packed(
    frames: Iterable[Float[np.ndarray, "point 3"]], recording: Recording, space: Space, words: str, most: int
) -> Cloud:
    count = recording.metadata.frames
    room = max(most // count, 1)
    points, depths, largest = [], [], 1
    for places in tracked(frames, words, total=count):
        step = -(-len(places) // room) or 1
        largest = max(largest, step)
        points.append(space.near(places[::step]))
        depths.append(_depth(recording.camera, places[::step]))
    return Cloud(
        points=np.concatenate(points),
        begin=np.concatenate([[0], np.cumsum([len(each) for each in points])]),
        depth_m=np.concatenate(depths),
        step=largest,
    )


def _depth(camera: Camera, places: Float[np.ndarray, "point 3"]) -> Float32[np.ndarray, "point"]:
    return transformed(np.linalg.inv(camera.world_from_camera), places)[:, 2].astype(np.float32)
