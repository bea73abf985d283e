"""What a solver observed, joined with the truth behind the pixels that it observed it in."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int64

from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import Visibility

BACKGROUND = 0
"""The object of everything that does not move: walls, ground, pixels without label."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MaterialPoints:
    """Points of the objects' surfaces, as `recording.frame.Labels` names them."""

    face: Int64[np.ndarray, "point"]
    u: Float32[np.ndarray, "point"]
    v: Float32[np.ndarray, "point"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Observations:
    """The observed rows that lie in a labelled frame, sorted by trajectory, then frame."""

    frame: Int64[np.ndarray, "point"]
    trajectory: Int64[np.ndarray, "point"]
    segment: Int64[np.ndarray, "point"]
    motion: Int64[np.ndarray, "point"]
    pixel: Int64[np.ndarray, "point"]
    """Number of the pixel that the row falls into, counted row by row through all frames."""
    returned: Bool[np.ndarray, "point"]
    """Whether the sensor has a return in that pixel."""
    objectid: Int64[np.ndarray, "point"]
    """The moving object at the pixel, `BACKGROUND` where there is none."""
    material: MaterialPoints | None
    """The material points at the pixels' centres (half a pixel's diagonal off, at the most, from where a
    sub-pixel row says it is); None where only the objects' masks are known."""


def observations_of(recording: Recording, motions: Motions, visibility: Visibility) -> Observations:
    """The observed rows with the truth at their pixels, from one pass over the recording's frames.

    A row belongs to the pixel that its picture position falls into. Rows of frames without labels are left out.
    """
    observed = np.flatnonzero(motions.observed)
    observed = observed[np.lexsort((motions.frame[observed], motions.trajectory[observed]))]
    frame = motions.frame[observed].astype(np.int64)
    column, row = np.floor(motions.column_row[observed]).astype(np.int64).T
    looked_up = _looked_up(recording, frame, row, column)
    kept = looked_up.labelled
    moving = np.isin(looked_up.objectid, visibility.ids)
    camera = recording.camera
    return Observations(
        frame=frame[kept],
        trajectory=motions.trajectory[observed][kept].astype(np.int64),
        segment=motions.segment[observed][kept].astype(np.int64),
        motion=motions.motion[observed][kept].astype(np.int64),
        pixel=((frame * camera.height + row) * camera.width + column)[kept],
        returned=looked_up.returned[kept],
        objectid=np.where(moving, looked_up.objectid, BACKGROUND)[kept],
        material=looked_up.material(kept),
    )


def require_fitting(recording: Recording, motions: Motions) -> None:
    """Refuse motions that cannot be of the recording: InputError where a row lies outside frames or picture.

    An observed row needs its picture position, and a trajectory has one row a frame.
    """
    frames, camera = recording.metadata.frames, recording.camera
    _require_frames(motions.frame, frames, "rows")
    outside = motions.observed & ~camera.contains(motions.column_row)
    if outside.any():
        column, row = motions.column_row[np.flatnonzero(outside)[0]]
        raise InputError(
            f"expected every observed row inside the picture of {camera.width}x{camera.height}, got row {row}, column "
            f"{column}: give 'row' and 'column' of observed points, or take the recording that the motions are made of"
        )
    keys = motions.trajectory.astype(np.int64) * frames + motions.frame
    if len(np.unique(keys)) < len(keys):
        raise InputError("expected one row a trajectory and frame, got several: number the trajectories apart")
    _require_frames(np.array([event.frame for event in motions.events], int), frames, "events")
    for entry in motions.representatives:
        _require_frames(entry.frame, frames, f"the representative of motion {entry.motion}")
        if not np.isfinite(entry.position).all():
            raise InputError(f"expected finite places, got NaN in the representative of motion {entry.motion}")


def _require_frames(frame: np.ndarray, frames: int, what: str) -> None:
    wrong = frame[(frame < 0) | (frame >= frames)]
    if len(wrong):
        raise InputError(
            f"expected {what} in the recording's frames 0 to {frames - 1}, got frame {wrong[0]}: "
            "take the recording that the motions are made of"
        )


class _LookedUp:
    """The labels of every observed row; filled frame by frame."""

    def __init__(self, count: int) -> None:
        self.labelled = np.zeros(count, bool)
        self.returned = np.zeros(count, bool)
        self.objectid = np.zeros(count, np.int64)
        self._exact = np.zeros(count, bool)
        self._face = np.zeros(count, np.int64)
        self._u = np.zeros(count, np.float32)
        self._v = np.zeros(count, np.float32)

    def fill(self, rows: np.ndarray, frame: Frame, pixels: tuple[np.ndarray, np.ndarray]) -> None:
        """Note what the frame says at the pixels of the rows."""
        labels: Labels | None = frame.labels
        self.returned[rows] = frame.seen[pixels]
        if labels is None:
            return
        self.labelled[rows] = True
        self.objectid[rows] = labels.objectid[pixels]
        if labels.face is not None and labels.u is not None and labels.v is not None:
            self._exact[rows] = True
            self._face[rows] = labels.face[pixels]
            self._u[rows] = labels.u[pixels]
            self._v[rows] = labels.v[pixels]

    def material(self, kept: np.ndarray) -> MaterialPoints | None:
        """The material points of the kept rows, if all of them are known."""
        if not self._exact[kept].all():
            return None
        return MaterialPoints(face=self._face[kept], u=self._u[kept], v=self._v[kept])


def _looked_up(recording: Recording, frame: np.ndarray, row: np.ndarray, column: np.ndarray) -> _LookedUp:
    found = _LookedUp(len(frame))
    by_frame = np.argsort(frame, kind="stable")
    numbers, starts = np.unique(frame[by_frame], return_index=True)
    groups = np.split(by_frame, starts[1:])
    pairs = zip(numbers.tolist(), groups, strict=False)  # Without rows there is one empty group and no number.
    for number, rows in tracked(pairs, "truth of the observed points", total=len(numbers)):
        found.fill(rows, recording.frames[number], (row[rows], column[rows]))
    return found
