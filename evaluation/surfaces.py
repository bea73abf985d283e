"""What completed points cover of the surfaces of hidden objects: recall and surface coverage."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import cKDTree

from recording.frame import Frame
from recording.motions import NOISE, Motions
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import Visibility, hidden_lengths, surface_points

RECALL_REACH_M = 0.25
"""A completed point this near stands for a part of the surface where recall is asked for."""
RECALLED_FROM = 0.5
"""Share of the surface from which a hidden object-frame is recalled."""
SURFACE_REACH_M = 0.10
"""A completed point this near covers a part of the surface."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HiddenSurfaces:
    """How near a motion's completed points come to its hidden object: an entry a hidden object and frame."""

    objectid: Int64[np.ndarray, "moment"]
    frame: Int64[np.ndarray, "moment"]
    hidden_frames: Int64[np.ndarray, "moment"]
    """Length in frames of the run of hidden frames that the frame lies in."""
    area: Int64[np.ndarray, "moment"]
    """Points of the X-ray twin."""
    unseen: Int64[np.ndarray, "moment"]
    """Those in whose pixel the object is not seen."""
    within_25cm: Int64[np.ndarray, "moment"]
    """Points of the X-ray twin with a completed point of the object's motion within 25 cm."""
    unseen_within_10cm: Int64[np.ndarray, "moment"]
    """Points that are not seen with one within 10 cm."""


def hidden_surfaces(
    recording: Recording, motions: Motions, visibility: Visibility, motion_of: dict[int, int]
) -> HiddenSurfaces | None:
    """What the completed points cover of every hidden object in every hidden frame; None without X-ray.

    `motion_of` says which motion stands for an object; an object without one is covered by nothing. Area is
    counted in pixels of the X-ray twin.
    """
    hidden = visibility.hidden
    if hidden is None or recording.xray is None:
        return None
    frame, number = np.nonzero(hidden.T)
    objectid = np.array(visibility.ids, np.int64)[number]
    completed = _completed_by_motion_and_frame(motions)
    counts = []
    for when in tracked(np.unique(frame).tolist(), "hidden surfaces", total=len(np.unique(frame))):
        sight, xray = recording.frames[when], recording.xray[when]
        for wanted in objectid[frame == when].tolist():
            points = completed.get((motion_of.get(wanted, NOISE), when), np.empty((0, 3)))
            surface = surface_points(recording.camera, xray[wanted])
            counts.append(_covered(surface, ~_seen_of(sight, wanted)[np.isfinite(xray[wanted])], points))
    area, unseen, recalled_area, covered = np.array(counts, np.int64).reshape(-1, 4).T
    return HiddenSurfaces(
        objectid=objectid,
        frame=frame,
        hidden_frames=hidden_lengths(visibility)[number, frame],
        area=area,
        unseen=unseen,
        within_25cm=recalled_area,
        unseen_within_10cm=covered,
    )


def recalled(surfaces: HiddenSurfaces) -> Bool[np.ndarray, "moment"]:
    """Where completed points lie within 25 cm of at least half of the X-ray twin's area."""
    return surfaces.within_25cm >= RECALLED_FROM * surfaces.area


def recall(surfaces: HiddenSurfaces) -> float | None:
    """The share of hidden object-frames that are recalled, in [0, 1]; None where nothing is hidden."""
    return float(recalled(surfaces).mean()) if len(surfaces.area) else None


def surface_coverage(surfaces: HiddenSurfaces) -> float | None:
    """The share of the X-ray twins' points, over all hidden object-frames, with a completed point within 10 cm.

    The few that are seen in a hidden frame are left out, for nobody completes what is observed. In [0, 1].
    """
    unseen = int(surfaces.unseen.sum())
    return float(surfaces.unseen_within_10cm.sum() / unseen) if unseen else None


def _completed_by_motion_and_frame(motions: Motions) -> dict[tuple[int, int], np.ndarray]:
    """The completed points of every motion and frame that has any."""
    rows = np.flatnonzero(~motions.observed & (motions.motion != NOISE))
    rows = rows[np.lexsort((motions.frame[rows], motions.motion[rows]))]
    pairs = np.stack([motions.motion[rows], motions.frame[rows]], axis=1)
    first = np.flatnonzero(np.any(np.diff(pairs, axis=0, prepend=-2), axis=1))
    groups = np.split(rows, first[1:])
    keys = [(int(motion), int(frame)) for motion, frame in pairs[first]]
    return {key: motions.position[group].astype(np.float64) for key, group in zip(keys, groups, strict=False)}


def _seen_of(frame: Frame, objectid: int) -> Bool[np.ndarray, "row column"]:
    """The pixels in which the object is seen."""
    return frame.seen & (frame.labels.objectid == objectid) if frame.labels is not None else np.zeros_like(frame.seen)


def _covered(
    surface: Float64[np.ndarray, "point 3"],
    unseen: Bool[np.ndarray, "point"],
    completed: Float64[np.ndarray, "completed 3"],
) -> tuple[int, int, int, int]:
    """All surface points, the unseen ones, all with a completed point within 25 cm, the unseen ones within 10 cm."""
    distance = np.full(len(surface), np.inf)
    if len(completed):
        distance, _ = cKDTree(completed).query(surface, distance_upper_bound=2 * RECALL_REACH_M)
    covered = unseen & (distance <= SURFACE_REACH_M)
    return len(surface), int(unseen.sum()), int((distance <= RECALL_REACH_M).sum()), int(covered.sum())
