"""Where the material point behind a pixel is in any other frame, seen or hidden.

Everything here follows from labels and truth meshes: it is exact, works between any two frames, forward and
backward, and asks a simulated recording. A pixel's label belongs to the ray through its centre, whatever the
sensor made of its depth; so a return that was lost has its flow too.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Integer, UInt32

from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.recording import Recording
from recording.sight import covering
from recording.truth import Truth


@dataclass(frozen=True, kw_only=True, eq=False)
class Flow:
    """How the points behind one frame's pixels move to another frame."""

    pixels: Float64[np.ndarray, "row column 2"]
    """Move in the picture (column, row), pixels; NaN without label, or where the point ends behind the camera."""
    metres: Float64[np.ndarray, "row column 3"]
    """Move in world axes, metres; NaN without label."""
    visible: Bool[np.ndarray, "row column"]
    """Whether the point lies in the other frame's picture and nothing covers it there."""
    covered_by: UInt32[np.ndarray, "row column"]
    """Id of the first object that covers the point in the other frame: the point's own where the object hides
    it itself (its far side); 0 where nothing does, and outside the picture."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Track:
    """Where material points are in every frame of a recording."""

    places: Float64[np.ndarray, "pixel frame 3"]
    """World axes, metres; NaN for a pixel without label."""
    column_row: Float64[np.ndarray, "pixel frame 2"]
    """Picture position, pixels, also where the point is hidden; NaN without label or behind the camera."""
    visible: Bool[np.ndarray, "pixel frame"]
    """Whether the point lies in the picture and nothing covers it."""
    covered_by: UInt32[np.ndarray, "pixel frame"]
    """Id of the first object that covers the point, as in `Flow`."""


def places_of(recording: Recording, frame: int, *, at: int) -> Float64[np.ndarray, "row column 3"]:
    """Where the material points behind the pixels of `frame` lie in frame `at`, world axes, metres.

    NaN where a pixel has no label. With `at` the frame itself it is the exact point behind the pixel.
    """
    truth = _truth_of(recording)
    return material_places(_labels_of(recording, frame), truth, at=_existing(recording, at))


def flow_between(recording: Recording, a: int, b: int) -> Flow:
    """The motion of every labelled pixel of frame a to frame b, in the picture and in space, and whether b shows it.

    The frames may be any two, in any order. What stands still has exactly no flow. Visible means a free line of
    sight by the truth meshes, however far between the pixel centres of b the point lands.
    """
    start, end = (places_of(recording, a, at=at) for at in (a, b))
    column_row_a, _ = recording.camera.pixel_from_world(start)
    column_row_b, _ = recording.camera.pixel_from_world(end)
    visible, covered_by = _sighted(recording, end.reshape(-1, 3), b)
    shape = end.shape[:2]
    return Flow(
        pixels=column_row_b - column_row_a,
        metres=end - start,
        visible=visible.reshape(shape),
        covered_by=covered_by.reshape(shape),
    )


def track(recording: Recording, frame: int, pixels: Integer[np.ndarray, "pixel 2"]) -> Track:
    """The material points behind some pixels of a frame, followed through all frames.

    `pixels` are (row, column) as in `image[row, column]`.
    """
    truth, labels = _truth_of(recording), _labels_of(recording, frame)
    pixels = np.asarray(pixels)
    inside = np.all((pixels >= 0) & (pixels < labels.objectid.shape), axis=1)
    if not inside.all():
        came = tuple(pixels[~inside][0].tolist())
        raise InputError(f"expected pixels (row, column) inside the picture of {labels.objectid.shape}, got {came}")
    chosen = _at_pixels(labels, pixels)
    frames = range(recording.metadata.frames)
    places = np.stack([material_places(chosen, truth, at=number)[:, 0] for number in frames], axis=1)
    column_row, _ = recording.camera.pixel_from_world(places)
    sights = [_sighted(recording, places[:, number], number) for number in frames]
    return Track(
        places=places,
        column_row=column_row,
        visible=np.stack([visible for visible, _ in sights], axis=1),
        covered_by=np.stack([covered_by for _, covered_by in sights], axis=1),
    )


def material_places(labels: Labels, truth: Truth, *, at: int) -> Float64[np.ndarray, "row column 3"]:
    """Where the labels' points lie on the meshes of frame `at`; NaN without a label, or with one that no mesh has."""
    points = np.full((*labels.objectid.shape, 3), np.nan)
    if labels.face is None or labels.u is None or labels.v is None:
        return points
    for objectid in np.unique(labels.objectid).tolist():
        mesh = truth.get(objectid)
        if mesh is not None:
            own = (labels.objectid == objectid) & (labels.face < len(mesh.faces))
            points[own] = mesh.material_points(
                frame=at,
                face=labels.face[own].astype(np.int64),
                u=labels.u[own].astype(np.float64),
                v=labels.v[own].astype(np.float64),
            )
    return points


def exact_labels(frame: Frame, number: int) -> Labels:
    """The labels of the frame of that number, which must name material points."""
    if frame.labels is None or not frame.labels.exact:
        raise InputError(f"frame {number}: expected channels objectid, face, bary.u and bary.v: make it again")
    return frame.labels


def _sighted(
    recording: Recording, places: Float64[np.ndarray, "point 3"], frame: int
) -> tuple[Bool[np.ndarray, "point"], UInt32[np.ndarray, "point"]]:
    """Whether each place is in view in the frame, and what covers it there."""
    covered_by = covering(_truth_of(recording), recording.camera, places, frame=frame)
    column_row, _ = recording.camera.pixel_from_world(places)
    return recording.camera.contains(column_row) & (covered_by == 0), covered_by


def _at_pixels(labels: Labels, pixels: Integer[np.ndarray, "pixel 2"]) -> Labels:
    """The labels of some pixels, as an image one pixel wide."""
    row, column = pixels[:, :1], pixels[:, 1:]
    exact = (labels.face, labels.u, labels.v)
    face, u, v = (None if image is None else image[row, column] for image in exact)
    return Labels(objectid=labels.objectid[row, column], face=face, u=u, v=v)


def _truth_of(recording: Recording) -> Truth:
    if recording.truth is None:
        raise InputError("expected a recording with its truth, got one without: only simulated ones know all places")
    return recording.truth


def _labels_of(recording: Recording, frame: int) -> Labels:
    return exact_labels(recording.frames[_existing(recording, frame)], frame)


def _existing(recording: Recording, frame: int) -> int:
    """The frame's number, which must lie in the recording."""
    if not 0 <= frame < recording.metadata.frames:
        raise InputError(f"expected a frame from 0 to {recording.metadata.frames - 1}, got {frame}")
    return frame
