"""What must agree in a frame of a simulated recording, and between a frame and the next: one function a check."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64, Int64

from recording.camera import pixel_grid
from recording.correspondence import material_places
from recording.moment import Moment
from recording.sight import DepthRange

TOLERANCE_M = 1e-4
"""Largest distance between two accounts of the same point: a tenth of a millimetre."""
TOLERANCE_PX = 0.05
"""Largest distance between two accounts of the same picture position."""
STRETCH_M = 0.05
"""Largest change, from one frame to the next, of the distance of two points within a pixel and on one face."""

Pixels = tuple[Int64[np.ndarray, "point"], Int64[np.ndarray, "point"]]
"""Rows and columns."""


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """A check of every frame."""

    name: str
    meaning: str
    """What is compared, in a few words."""
    bound: float
    """The largest error that passes."""
    unit: str
    error: Callable[[Moment], float]
    of_xray: bool = False
    """Whether it needs the X-ray twin."""


def _depth_error_m(moment: Moment) -> float:
    labelled = moment.labels.objectid > 0
    return _largest(np.linalg.norm(moment.measured - moment.material, axis=-1)[labelled])


def _projection_error_px(moment: Moment) -> float:
    labelled = moment.labels.objectid > 0
    column_row, _ = moment.camera.pixel_from_world(moment.material)
    centre = pixel_grid(moment.camera.height, moment.camera.width)
    return _largest(np.linalg.norm(column_row - centre, axis=-1)[labelled])


def _nearest_error_m(moment: Moment) -> float:
    least = most = np.full(moment.depth.shape, np.inf)
    for cast in moment.cast.values():
        least, most = np.minimum(least, cast.least), np.minimum(most, cast.most)
    return _outside_m(moment.depth, DepthRange(least=least, most=most))


def _unlabelled_pixels(moment: Moment) -> float:
    return float(np.sum(np.isfinite(moment.depth) != (moment.labels.objectid > 0)))


def _strange_labels(moment: Moment) -> float:
    strange = ~np.isin(moment.labels.objectid, moment.known) | np.isnan(moment.material[..., 0])
    return float(np.sum((moment.labels.objectid > 0) & strange))


def _unexplained_pixels(moment: Moment) -> float:
    if moment.frame.reason is None:
        return 0.0
    return float(np.sum(~moment.frame.seen & (moment.frame.reason == 0)))


def _missing_xray_pixels(moment: Moment) -> float:
    if not set(moment.moving) <= set(moment.xray):
        return float("inf")
    seen = moment.labels.objectid
    return float(sum(np.sum((seen == objectid) & np.isnan(depth)) for objectid, depth in moment.xray.items()))


def _seen_xray_error_m(moment: Moment) -> float:
    errors = [0.0]
    for objectid, depth in moment.xray.items():
        both = (moment.labels.objectid == objectid) & np.isfinite(depth)
        errors.append(_largest(np.abs(moment.depth[both].astype(np.float64) - depth[both])))
    return max(errors)


def _nearer_xray_m(moment: Moment) -> float:
    errors = [0.0]
    for depth in moment.xray.values():
        there = np.isfinite(depth)
        errors.append(_largest(moment.depth[there].astype(np.float64) - depth[there]))
    return max(errors)


def _mesh_xray_error_m(moment: Moment) -> float:
    both = set(moment.xray) & set(moment.cast)
    return max((_outside_m(moment.xray[objectid], moment.cast[objectid]) for objectid in both), default=0.0)


def _flow_error_px(moment: Moment) -> float:
    """The motion in the picture against that in space, which begins where depth and camera have the point."""
    before, camera = moment.before, moment.camera
    if before is None:
        return 0.0
    end = material_places(before.labels, moment.truth, at=moment.number)
    start_px, end_px = (camera.pixel_from_world(places)[0] for places in (before.material, end))
    by_space, _ = camera.pixel_from_world(before.measured + (end - before.material))
    by_picture = pixel_grid(camera.height, camera.width) + (end_px - start_px)
    compared = np.isfinite(before.measured[..., 0]) & np.isfinite(end_px[..., 0])
    return _largest(np.linalg.norm(by_space - by_picture, axis=-1)[compared])


def _return_error_m(moment: Moment) -> float:
    """Forward to a pixel of this frame, and back by the label there: the way there against the way back.

    The pixel's centre is a little off the flow's end. On one face that distance is the same in both frames, as
    far as skin does not stretch.
    """
    before = moment.before
    if before is None:
        return 0.0
    end = material_places(before.labels, moment.truth, at=moment.number)
    origin = material_places(moment.labels, moment.truth, at=before.number)
    start, landing = _landings(before, moment, end)
    there = np.linalg.norm(moment.measured[landing] - end[start], axis=-1)
    back = np.linalg.norm(origin[landing] - before.measured[start], axis=-1)
    return _largest(np.abs(there - back))


def _landings(before: Moment, moment: Moment, end: Float64[np.ndarray, "row column 3"]) -> tuple[Pixels, Pixels]:
    """The pixels before, and those in which this moment shows the same face at the flow's end."""
    column_row, _ = moment.camera.pixel_from_world(end)
    row, column = np.nonzero(moment.camera.contains(column_row) & np.isfinite(before.depth))
    to_column, to_row = np.floor(column_row[row, column]).astype(np.int64).T
    same = np.isfinite(moment.depth[to_row, to_column])
    for name in ("objectid", "face"):
        same &= getattr(before.labels, name)[row, column] == getattr(moment.labels, name)[to_row, to_column]
    return (row[same], column[same]), (to_row[same], to_column[same])


def _outside_m(depth: Float[np.ndarray, "row column"], cast: DepthRange) -> float:
    """How far a depth image lies outside of where the meshes are; infinite where only one of them has anything."""
    there = np.isfinite(depth)
    if np.any(np.isfinite(cast.most[~there])):
        return float("inf")
    known = depth[there].astype(np.float64)
    return _largest(np.maximum(cast.least[there] - known, known - cast.most[there]))


def _largest(errors: Float[np.ndarray, "error"]) -> float:
    """The largest error; infinite where one cannot be computed, 0 where there is nothing to compare."""
    return float(np.max(np.where(np.isnan(errors), np.inf, errors), initial=0.0))


AGREEMENTS = (
    Agreement(
        name="point",
        meaning="point by depth and camera, and by the mesh",
        bound=TOLERANCE_M,
        unit="m",
        error=_depth_error_m,
    ),
    Agreement(
        name="projection",
        meaning="the mesh's point in the picture, and the pixel's centre",
        bound=TOLERANCE_PX,
        unit="px",
        error=_projection_error_px,
    ),
    Agreement(
        name="nearest",
        meaning="depth, and the first mesh on the pixel's ray",
        bound=TOLERANCE_M,
        unit="m",
        error=_nearest_error_m,
    ),
    Agreement(
        name="unlabelled",
        meaning="depth without a label, or a label without depth",
        bound=0.0,
        unit="pixels",
        error=_unlabelled_pixels,
    ),
    Agreement(
        name="strange labels",
        meaning="labels of an object or a face that there is not",
        bound=0.0,
        unit="pixels",
        error=_strange_labels,
    ),
    Agreement(
        name="unexplained",
        meaning="no return, and no reason for it",
        bound=0.0,
        unit="pixels",
        error=_unexplained_pixels,
    ),
    Agreement(
        name="flow",
        meaning="motion in the picture, and in space from the measured point",
        bound=TOLERANCE_PX,
        unit="px",
        error=_flow_error_px,
    ),
    Agreement(
        name="return",
        meaning="the way by the flow to the next frame, and back by the label there",
        bound=STRETCH_M,
        unit="m",
        error=_return_error_m,
    ),
    Agreement(
        name="x-ray missing",
        meaning="a moving object is seen where its X-ray is empty",
        bound=0.0,
        unit="pixels",
        error=_missing_xray_pixels,
        of_xray=True,
    ),
    Agreement(
        name="x-ray seen",
        meaning="depth of a seen object, and in its X-ray",
        bound=TOLERANCE_M,
        unit="m",
        error=_seen_xray_error_m,
        of_xray=True,
    ),
    Agreement(
        name="x-ray nearer",
        meaning="how far an X-ray lies before what is seen",
        bound=TOLERANCE_M,
        unit="m",
        error=_nearer_xray_m,
        of_xray=True,
    ),
    Agreement(
        name="x-ray mesh",
        meaning="depth of an X-ray, and the object's mesh on the pixel's ray",
        bound=TOLERANCE_M,
        unit="m",
        error=_mesh_xray_error_m,
        of_xray=True,
    ),
)
