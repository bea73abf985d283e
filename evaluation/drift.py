"""How good trajectories are: whether each goes with the material point that it began on.

A trajectory's point is the one behind the pixel in which it began. Its drift in a frame is its distance from where
that point truly is; its age is the number of frames since it began.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int, Int64

from algorithm.trajectories import Trajectories
from recording.correspondence import exact_labels
from recording.errors import InputError
from recording.frame import Labels
from recording.recording import Recording

SHORTEST_FRAMES = 5
"""A shorter trajectory covers nothing."""
AGES = (1, 5, 10, 20, 40)
_NEAR_PX = 0.75
"""A pixel is on a trajectory that passes its centre this near."""
_SURFACE_M = 0.15


@dataclass(frozen=True, kw_only=True, eq=False)
class Drift:
    """The trajectories of at least 5 frames that began on a moving object, and how they drift."""

    length: Int64[np.ndarray, "trajectory"]
    """Frames."""
    age: Int[np.ndarray, "observation"]
    metres: Float64[np.ndarray, "observation"]
    """Distance from the true place."""
    two_objects: Bool[np.ndarray, "trajectory"]
    """Whether it touches another moving object than the one it began on."""
    ends_astray: Bool[np.ndarray, "trajectory"]
    """Whether it ends on another moving object, more than 10 cm from the true place."""
    nearest_m: Float64[np.ndarray, "pixel"]
    """For every moving pixel of every frame, the drift of the nearest trajectory on it; infinite without one."""

    @property
    def coverage(self) -> float:
        """Share of the moving pixels on a trajectory, whatever its drift."""
        return float(np.isfinite(self.nearest_m).mean())

    def covered_within(self, metres: float) -> float:
        """Share of the moving pixels on a trajectory that is off by less."""
        return float((self.nearest_m < metres).mean())

    def median_at(self, age: int) -> float:
        """The median drift of the trajectories of that age, metres; NaN without any."""
        at = self.metres[self.age == age]
        return float(np.median(at)) if len(at) else float("nan")


def drift_of(recording: Recording, trajectories: Trajectories) -> Drift:
    """The drift of the trajectories of a simulated recording; InputError without its truth."""
    if recording.truth is None:
        raise InputError("expected a recording with its truth, got one without: only simulated ones know all places")
    labels = [exact_labels(frame, number) for number, frame in enumerate(recording.frames)]
    number = _pixel_of(recording, trajectories)
    begun = trajectories.first_row
    moving = np.isin(_behind(labels, trajectories.frame[begun], number[begun]), recording.moving_ids)
    chosen = moving & (trajectories.length >= SHORTEST_FRAMES)
    number, kept = number[chosen[trajectories.trajectory]], trajectories.chosen(chosen)
    objectid = _behind(labels, kept.frame, number)
    off = np.linalg.norm(kept.position - _true_places(recording, labels, kept, number), axis=1)
    begun, last = kept.first_row, kept.first_row + kept.length - 1
    strange = np.isin(objectid, recording.moving_ids) & (objectid != objectid[begun][kept.trajectory])
    return Drift(
        length=kept.length,
        age=kept.frame - kept.first_frame[kept.trajectory],
        metres=off,
        two_objects=np.bincount(kept.trajectory[strange], minlength=kept.count) > 0,
        ends_astray=strange[last] & (off[last] > 0.1),
        nearest_m=_nearest_drift(recording, labels, kept, off),
    )


def _pixel_of(recording: Recording, trajectories: Trajectories) -> Int64[np.ndarray, "observation"]:
    """The flat number of the pixel that each observation lies in."""
    column, row = np.floor(trajectories.column_row).astype(np.int64).T
    return row * recording.camera.width + column


def _behind(labels: Sequence[Labels], frame: np.ndarray, pixel: np.ndarray) -> Int64[np.ndarray, "observation"]:
    """The object behind each pixel."""
    objectid = np.zeros(len(frame), np.int64)
    for number, one in enumerate(labels):
        here = frame == number
        objectid[here] = one.objectid.ravel()[pixel[here]]
    return objectid


def _true_places(
    recording: Recording, labels: Sequence[Labels], trajectories: Trajectories, pixel: np.ndarray
) -> Float64[np.ndarray, "observation 3"]:
    """Where the point that each trajectory began on is in each of its frames, metres."""
    begun = trajectories.first_row
    first, start = trajectories.frame[begun], pixel[begun]
    objectid = _behind(labels, first, start)
    face, u, v = (np.zeros(trajectories.count, kind) for kind in (np.int64, np.float64, np.float64))
    for number, one in enumerate(labels):
        here = first == number
        for values, image in ((face, one.face), (u, one.u), (v, one.v)):
            if image is not None:
                values[here] = image.ravel()[start[here]]
    places = np.full((len(trajectories.frame), 3), np.nan)
    for one in np.unique(objectid):
        mesh = (recording.truth or {})[int(one)]
        own = objectid[trajectories.trajectory] == one
        for number in np.unique(trajectories.frame[own]):
            rows = np.flatnonzero(own & (trajectories.frame == number))
            which = trajectories.trajectory[rows]
            places[rows] = mesh.material_points(frame=int(number), face=face[which], u=u[which], v=v[which])
    return places


def _nearest_drift(
    recording: Recording, labels: Sequence[Labels], trajectories: Trajectories, off: np.ndarray
) -> Float64[np.ndarray, "pixel"]:
    """The drift of the trajectory that passes nearest to each moving pixel's centre, frame after frame."""
    camera, found = recording.camera, []
    _, depth = camera.pixel_from_world(trajectories.position)
    for number, (frame, one) in enumerate(zip(recording.frames, labels, strict=True)):
        here = np.flatnonzero(trajectories.frame == number)
        moving = np.isin(one.objectid, recording.moving_ids) & frame.seen
        nearest, drift = np.full(moving.shape, np.inf), np.full(moving.shape, np.inf)
        corner = np.floor(trajectories.column_row[here] - 0.5).astype(np.int64)
        for beside in np.array([(0, 0), (1, 0), (0, 1), (1, 1)]):
            column, row = (corner + beside).T
            distance = np.linalg.norm(trajectories.column_row[here] - (corner + beside + 0.5), axis=1)
            fits = (distance <= _NEAR_PX) & (row >= 0) & (column >= 0) & (row < camera.height) & (column < camera.width)
            fits[fits] = np.abs(frame.depth[row[fits], column[fits]] - depth[here[fits]]) <= _SURFACE_M
            order = np.flatnonzero(fits)[np.argsort(-distance[fits], kind="stable")]  # The nearest is written last.
            better = order[distance[order] < nearest[row[order], column[order]]]
            nearest[row[better], column[better]] = distance[better]
            drift[row[better], column[better]] = off[here[better]]
        found.append(drift[moving])
    return np.concatenate(found)
