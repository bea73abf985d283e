"""What can be seen of every moving object in every frame, what is hidden, and for how long.

A pixel is *seen* when it has a return and carries the object's label; a return that the sensor lost is not seen.
An object's *unoccluded* pixels are those of its X-ray twin, the object rendered alone.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float64, Int64

from recording.camera import PIXEL_CENTRE, Camera
from recording.frame import Frame
from recording.progress import tracked
from recording.recording import Recording

HIDDEN_BELOW = 0.2
"""An object is hidden where less than this share of its unoccluded pixels is seen."""
GROUND = "ground"
"""Objects of this kind do not count as points."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Visibility:
    """Pixel counts and true places of the moving objects, an entry an object and frame."""

    ids: tuple[int, ...]
    """The moving objects, ascending. Where only masks are known: every id but 0 that occurs."""
    labelled: bool
    """Whether any frame says which object stands behind a pixel."""
    returns: Int64[np.ndarray, "frame"]
    """Returns of the sensor, occluders included, ground excluded."""
    seen: Int64[np.ndarray, "object frame"]
    """Pixels with a return and the object's label."""
    unoccluded: Int64[np.ndarray, "object frame"] | None
    """Pixels of the X-ray twin; None where there is no X-ray."""
    centre: Float64[np.ndarray, "object frame 3"] | None
    """Centroid of the X-ray twin's points: the object's whole front side, hidden or not, so that the place
    is not biased by what is seen. World axes, metres; NaN where the object is out of view; None without X-ray."""

    @property
    def in_view(self) -> Bool[np.ndarray, "object frame"] | None:
        """Where the object has an unoccluded pixel; elsewhere it is out of view, which is not hidden."""
        return None if self.unoccluded is None else self.unoccluded > 0

    @property
    def hidden(self) -> Bool[np.ndarray, "object frame"] | None:
        """Where the object is in view and under 20 % of its unoccluded pixels are seen."""
        return None if self.unoccluded is None else self.seen < HIDDEN_BELOW * self.unoccluded

    @property
    def points_per_frame(self) -> float:
        """Pts: the mean number of returns a frame, occluders included, ground excluded."""
        return float(self.returns.mean())


@dataclass(frozen=True, kw_only=True)
class HiddenRun:
    """A maximal run of frames in which one object is hidden."""

    objectid: int
    first: int
    """Its first frame."""
    stop: int
    """The frame after its last."""
    hole: bool
    """Whether the object is seen in the frame before and in the frame after."""

    @property
    def frames(self) -> int:
        """Its length in frames."""
        return self.stop - self.first


def visibility_of(recording: Recording) -> Visibility:
    """The visibility of the recording's moving objects, from one pass over its frames and X-rays."""
    count = recording.metadata.frames
    glances = [_glance(recording, number) for number in tracked(range(count), "visibility", total=count)]
    known = recording.metadata.objects is not None
    ids = tuple(sorted(recording.moving_ids)) if known else _occurring(glance.seen for glance in glances)
    xrayed = recording.xray is not None
    return Visibility(
        ids=ids,
        labelled=any(glance.labelled for glance in glances),
        returns=np.array([glance.returns for glance in glances], np.int64),
        seen=_by_object(ids, [glance.seen for glance in glances]),
        unoccluded=_by_object(ids, [glance.unoccluded for glance in glances]) if xrayed else None,
        centre=_centres(ids, [glance.centre for glance in glances]) if xrayed else None,
    )


def hidden_runs(visibility: Visibility) -> list[HiddenRun]:
    """All runs of hidden frames, by object, then frame; none where there is no X-ray."""
    hidden, in_view = visibility.hidden, visibility.in_view
    return [] if hidden is None or in_view is None else runs_of(visibility.ids, hidden=hidden, in_view=in_view)


def runs_of(
    ids: tuple[int, ...], *, hidden: Bool[np.ndarray, "object frame"], in_view: Bool[np.ndarray, "object frame"]
) -> list[HiddenRun]:
    """The maximal runs of frames in which an object is hidden, by object, then frame."""
    runs = []
    for objectid, dark, present in zip(ids, hidden, in_view, strict=True):
        clear = np.concatenate([[False], present & ~dark, [False]])  # Beyond the recording nothing is seen.
        edges = np.flatnonzero(np.diff(np.concatenate([[0], dark, [0]])))
        runs += [
            HiddenRun(objectid=objectid, first=first, stop=stop, hole=bool(clear[first] and clear[stop + 1]))
            for first, stop in edges.reshape(-1, 2).tolist()
        ]
    return runs


def holes(visibility: Visibility) -> list[HiddenRun] | None:
    """The runs of hidden frames between two frames in which the object is seen; None without X-ray.

    A run that begins or ends with the recording, or where the object enters or leaves the picture, is none.
    """
    return None if visibility.unoccluded is None else [run for run in hidden_runs(visibility) if run.hole]


def longest_hole(visibility: Visibility) -> int | None:
    """Max Occ: the length of the longest hole of any moving object, in frames; None where there is none."""
    return max((hole.frames for hole in holes(visibility) or []), default=None)


def hidden_lengths(visibility: Visibility) -> Int64[np.ndarray, "object frame"]:
    """The length of the run of hidden frames around every object and frame; 0 where it is not hidden."""
    lengths = np.zeros(visibility.seen.shape, np.int64)
    for run in hidden_runs(visibility):
        lengths[visibility.ids.index(run.objectid), run.first : run.stop] = run.frames
    return lengths


def surface_points(camera: Camera, depth: Float[np.ndarray, "row column"]) -> Float64[np.ndarray, "point 3"]:
    """The points of a depth image's returns, world axes, metres."""
    row, column = np.nonzero(np.isfinite(depth))
    column_row = np.stack([column, row], axis=-1) + PIXEL_CENTRE
    return camera.world_from_pixel(column_row, depth[row, column].astype(np.float64))


def seen_pixels(frame: Frame) -> dict[int, int]:
    """The number of seen pixels by object id; empty for a frame without labels."""
    if frame.labels is None:
        return {}
    ids, counts = np.unique(frame.labels.objectid[frame.seen], return_counts=True)
    return dict(zip(ids.tolist(), counts.tolist(), strict=True))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Glance:
    """One frame, by object id."""

    labelled: bool
    returns: int
    seen: dict[int, int]
    unoccluded: dict[int, int]
    centre: dict[int, np.ndarray]


def _glance(recording: Recording, number: int) -> _Glance:
    frame = recording.frames[number]
    seen = seen_pixels(frame)
    ground = [entry.id for entry in recording.metadata.objects or () if entry.kind == GROUND]
    xray = recording.xray[number] if recording.xray is not None else {}
    points = {objectid: surface_points(recording.camera, depth) for objectid, depth in xray.items()}
    return _Glance(
        labelled=frame.labels is not None,
        returns=int(frame.seen.sum()) - sum(seen.get(objectid, 0) for objectid in ground),
        seen=seen,
        unoccluded={objectid: len(surface) for objectid, surface in points.items()},
        centre={objectid: surface.mean(axis=0) for objectid, surface in points.items() if len(surface)},
    )


def _occurring(seen: Iterable[dict[int, int]]) -> tuple[int, ...]:
    return tuple(sorted({objectid for counts in seen for objectid in counts if objectid != 0}))


def _by_object(ids: tuple[int, ...], counts: list[dict[int, int]]) -> Int64[np.ndarray, "object frame"]:
    table = [[count.get(objectid, 0) for count in counts] for objectid in ids]
    return np.array(table, np.int64).reshape(len(ids), len(counts))


def _centres(ids: tuple[int, ...], centres: list[dict[int, np.ndarray]]) -> Float64[np.ndarray, "object frame 3"]:
    nowhere = np.full(3, np.nan)
    table = [[centre.get(objectid, nowhere) for centre in centres] for objectid in ids]
    return np.array(table, np.float64).reshape(len(ids), len(centres), 3)
