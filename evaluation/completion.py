"""How well the motion of hidden objects is completed: on hidden frames only.

An error without its recall is worth nothing: who completes only what is easy has small errors.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from evaluation.observations import BACKGROUND, MaterialPoints, Observations
from evaluation.surfaces import HiddenSurfaces, recalled
from recording.motions import NOISE, Motions
from recording.recording import Recording
from recording.truth import MeshSequence
from recording.visibility import Visibility, hidden_lengths


@dataclass(frozen=True, kw_only=True, eq=False)
class PointErrors:
    """The completed points of hidden objects: an entry a point."""

    objectid: Int64[np.ndarray, "point"]
    """The object of the point's material point."""
    trajectory: Int64[np.ndarray, "point"]
    frame: Int64[np.ndarray, "point"]
    hidden_frames: Int64[np.ndarray, "point"]
    """Length in frames of the run of hidden frames that the frame lies in."""
    error_m: Float64[np.ndarray, "point"]
    """Distance from the true place, metres."""
    confidence: Float64[np.ndarray, "point"]
    """What the solver says of the point, 0 to 1."""


@dataclass(frozen=True, kw_only=True)
class LengthRow:
    """The completion of all runs of hidden frames of one length."""

    hidden_frames: int
    """Length of the runs, frames."""
    object_frames: int
    recall: float
    points: int
    """Completed points with a known true place."""
    median_m: float | None
    mean_m: float | None
    p95_m: float | None
    centres: int
    """Object-frames with a place of the object's motion."""
    centre_mean_m: float | None


@dataclass(frozen=True, kw_only=True, eq=False)
class CentreErrors:
    """Hidden objects whose motion says where they are: an entry an object and frame."""

    hidden_frames: Int64[np.ndarray, "moment"]
    """Length in frames of the run of hidden frames that the frame lies in."""
    error_m: Float64[np.ndarray, "moment"]
    """Distance of the motion's place from the object's centre, metres."""


def point_errors(
    recording: Recording, motions: Motions, observations: Observations, visibility: Visibility
) -> PointErrors | None:
    """The distance of every completed point of a hidden object from its true place; None without meshes.

    A completed row stands for the material point last seen on its trajectory before the row's frame; where there
    is none (the motion was extended backwards) for the first seen after it. It counts in frames in which that
    point's object is hidden. Noise is not counted, nor rows whose material point is the background's.
    """
    hidden = visibility.hidden
    if recording.truth is None or hidden is None or observations.material is None:
        return None
    if not len(observations.frame):
        return _joined([])
    completed = np.flatnonzero(~motions.observed & (motions.motion != NOISE))
    frame = motions.frame[completed].astype(np.int64)
    seen, known = _last_seen(observations, motions.trajectory[completed].astype(np.int64), frame)
    objectid = np.where(known, observations.objectid[seen], BACKGROUND)
    lengths = hidden_lengths(visibility)
    parts = []
    for number, wanted in enumerate(visibility.ids):
        rows = np.flatnonzero((objectid == wanted) & hidden[number, frame])
        if wanted not in recording.truth:
            continue
        true_place = _places(recording.truth[wanted], observations.material, seen[rows], frame[rows])
        parts.append(
            PointErrors(
                objectid=objectid[rows],
                trajectory=motions.trajectory[completed[rows]].astype(np.int64),
                frame=frame[rows],
                hidden_frames=lengths[number, frame[rows]],
                error_m=np.linalg.norm(motions.position[completed[rows]] - true_place, axis=1),
                confidence=motions.confidence[completed[rows]].astype(np.float64),
            )
        )
    return _joined(parts)


def centre_errors(
    visibility: Visibility, places: dict[int, Float64[np.ndarray, "frame 3"]], motion_of: dict[int, int]
) -> CentreErrors:
    """Distance of a motion's place from its object's centre in every hidden frame.

    Hidden object-frames for which the object has no motion, or the motion no place, are left out.
    """
    if visibility.centre is None or visibility.hidden is None:
        return CentreErrors(hidden_frames=np.empty(0, np.int64), error_m=np.empty(0))
    error = np.full(visibility.hidden.shape, np.nan)
    for number, objectid in enumerate(visibility.ids):
        if motion_of.get(objectid) in places:
            error[number] = np.linalg.norm(places[motion_of[objectid]] - visibility.centre[number], axis=1)
    known = visibility.hidden & np.isfinite(error)
    return CentreErrors(hidden_frames=hidden_lengths(visibility)[known], error_m=error[known])


def by_hidden_length(surfaces: HiddenSurfaces, errors: PointErrors | None, centres: CentreErrors) -> list[LengthRow]:
    """Recall and errors by the length of the run of hidden frames, shortest first; lengths that occur only."""
    rows = []
    for length in np.unique(surfaces.hidden_frames).tolist():
        moments = surfaces.hidden_frames == length
        error = errors.error_m[errors.hidden_frames == length] if errors is not None else np.empty(0)
        centre = centres.error_m[centres.hidden_frames == length]
        rows.append(
            LengthRow(
                hidden_frames=length,
                object_frames=int(moments.sum()),
                recall=float(recalled(surfaces)[moments].mean()),
                points=len(error),
                median_m=float(np.median(error)) if len(error) else None,
                mean_m=float(error.mean()) if len(error) else None,
                p95_m=float(np.percentile(error, 95)) if len(error) else None,
                centres=len(centre),
                centre_mean_m=float(centre.mean()) if len(centre) else None,
            )
        )
    return rows


def _places(
    mesh: MeshSequence, material: MaterialPoints, chosen: Int64[np.ndarray, "row"], frame: Int64[np.ndarray, "row"]
) -> Float64[np.ndarray, "row 3"]:
    """Where the chosen material points lie in the frames, world axes, metres."""
    return mesh.material_points(frame=frame, face=material.face[chosen], u=material.u[chosen], v=material.v[chosen])


def _joined(parts: list[PointErrors]) -> PointErrors:
    nothing = np.empty(0, np.int64)
    return PointErrors(
        objectid=np.concatenate([nothing, *(part.objectid for part in parts)]),
        trajectory=np.concatenate([nothing, *(part.trajectory for part in parts)]),
        frame=np.concatenate([nothing, *(part.frame for part in parts)]),
        hidden_frames=np.concatenate([nothing, *(part.hidden_frames for part in parts)]),
        error_m=np.concatenate([np.empty(0), *(part.error_m for part in parts)]),
        confidence=np.concatenate([np.empty(0), *(part.confidence for part in parts)]),
    )


def _last_seen(
    observations: Observations, trajectory: Int64[np.ndarray, "row"], frame: Int64[np.ndarray, "row"]
) -> tuple[Int64[np.ndarray, "row"], Bool[np.ndarray, "row"]]:
    """The observation last seen on each row's trajectory before its frame, else the first after; and whether any."""
    stride = int(max(observations.frame.max(), frame.max(initial=0))) + 1
    key = observations.trajectory * stride + observations.frame  # Ascending, for observations are sorted so.
    after = np.searchsorted(key, trajectory * stride + frame)
    before = np.maximum(after - 1, 0)
    after = np.minimum(after, len(key) - 1)
    seen_before = (observations.trajectory[before] == trajectory) & (observations.frame[before] < frame)
    chosen = np.where(seen_before, before, after)
    return chosen, observations.trajectory[chosen] == trajectory
