"""A simulated recording held against itself: depth, labels, meshes and X-rays must tell one story."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from recording.camera import Camera, pixel_grid
from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.progress import tracked
from recording.recording import Recording, XRay
from recording.truth import Truth

TOLERANCE_M = 1e-4
"""Largest distance between two accounts of the same point: a tenth of a millimetre."""
TOLERANCE_PX = 0.05
"""Largest distance between a pixel's centre and its material point in the picture."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """The largest error of one kind in a whole recording."""

    name: str
    meaning: str
    """What was compared, in a few words."""
    largest: float
    """Infinite where one account says something and the other nothing."""
    bound: float
    """The largest error that passes."""
    unit: str

    @property
    def passes(self) -> bool:
        """Whether the error stays within its bound."""
        return self.largest <= self.bound


@dataclass(frozen=True, kw_only=True)
class Report:
    """What `verify` found."""

    checks: tuple[Check, ...]

    @property
    def passes(self) -> bool:
        """Whether every check passes."""
        return all(check.passes for check in self.checks)

    @property
    def text(self) -> str:
        """A line for each check: its largest error and its bound."""
        return "\n".join(
            f"{'ok  ' if check.passes else 'FAIL'} {check.name}: {check.largest:.3g} {check.unit}"
            f" (at most {check.bound:g}): {check.meaning}"
            for check in self.checks
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Moment:
    """One frame with all that is said about it."""

    camera: Camera
    frame: Frame
    depth: Float[np.ndarray, "row column"]
    """Before the sensor."""
    labels: Labels
    material: Float[np.ndarray, "row column 3"]
    """The labels' material points by the truth, world axes, metres; NaN where there is none."""
    xray: XRay | None
    known: tuple[int, ...]
    """The ids of `recording.json`."""
    moving: tuple[int, ...]
    """Those of them that move."""


@dataclass(frozen=True, kw_only=True)
class _Test:
    name: str
    meaning: str
    bound: float
    unit: str
    error: Callable[[_Moment], float]
    of_xray: bool = False


def verify(recording: Recording) -> Report:
    """The largest error of each kind, with its bound.

    Holds depth and camera against the labels' material points on the truth meshes (metres, and pixels in
    the picture), labels against depth and against the objects of `recording.json`, reasons against missing
    returns, and the X-ray twin against what is seen. Frames are read one by one. A recording without exact
    truth, as every real one, cannot be verified: an `InputError`.
    """
    truth = _checked_truth(recording)
    tests = [test for test in _TESTS if recording.xray is not None or not test.of_xray]
    largest = {test.name: 0.0 for test in tests}
    frames = tracked(recording.frames, "verifying", total=recording.metadata.frames)
    for number, frame in enumerate(frames):
        moment = _moment(recording, truth, frame, number)
        for test in tests:
            largest[test.name] = max(largest[test.name], test.error(moment))
    return Report(
        checks=tuple(
            Check(name=t.name, meaning=t.meaning, largest=largest[t.name], bound=t.bound, unit=t.unit) for t in tests
        )
    )


def _checked_truth(recording: Recording) -> Truth:
    """The meshes of a recording that has them, one for every object, as many frames as the recording."""
    if recording.truth is None or recording.metadata.objects is None:
        raise InputError("expected a recording with its truth, got one without: only simulated ones can be verified")
    for entry in recording.metadata.objects:
        mesh = recording.truth.get(entry.id)
        if mesh is None:
            raise InputError(f"object {entry.id} ({entry.name}) has no mesh in the truth: make the recording again")
        expected = recording.metadata.frames if entry.moving else 1
        if len(mesh.vertices) not in (expected, 1):
            came = f"got {len(mesh.vertices)}: make the recording again"
            raise InputError(f"object {entry.id} ({entry.name}): expected its mesh in {expected} frames, {came}")
    return recording.truth


def _moment(recording: Recording, truth: Truth, frame: Frame, number: int) -> _Moment:
    if frame.labels is None or not frame.labels.exact:
        raise InputError(f"frame {number}: expected channels objectid, face, bary.u and bary.v: make it again")
    return _Moment(
        camera=recording.camera,
        frame=frame,
        depth=frame.depth if frame.clean_depth is None else frame.clean_depth,
        labels=frame.labels,
        material=_material_points(frame.labels, truth, number),
        xray=None if recording.xray is None else recording.xray[number],
        known=tuple(entry.id for entry in recording.metadata.objects or ()),
        moving=recording.moving_ids,
    )


def _material_points(labels: Labels, truth: Truth, number: int) -> Float[np.ndarray, "row column 3"]:
    """The labels' points on the meshes; NaN where there is no label, or one that no mesh has."""
    points = np.full((*labels.objectid.shape, 3), np.nan)
    if labels.face is None or labels.u is None or labels.v is None:
        return points
    for objectid in np.unique(labels.objectid).tolist():
        mesh = truth.get(objectid)
        if mesh is not None:
            own = (labels.objectid == objectid) & (labels.face < len(mesh.faces))
            points[own] = mesh.material_points(
                frame=number,
                face=labels.face[own].astype(np.int64),
                u=labels.u[own].astype(np.float64),
                v=labels.v[own].astype(np.float64),
            )
    return points


def _depth_error_m(moment: _Moment) -> float:
    labelled = moment.labels.objectid > 0
    seen = moment.camera.world_points(moment.depth)
    return _largest(np.linalg.norm(seen - moment.material, axis=-1)[labelled])


def _projection_error_px(moment: _Moment) -> float:
    labelled = moment.labels.objectid > 0
    column_row, _ = moment.camera.pixel_from_world(moment.material)
    centre = pixel_grid(moment.camera.height, moment.camera.width)
    return _largest(np.linalg.norm(column_row - centre, axis=-1)[labelled])


def _unlabelled_pixels(moment: _Moment) -> float:
    return float(np.sum(np.isfinite(moment.depth) != (moment.labels.objectid > 0)))


def _strange_labels(moment: _Moment) -> float:
    strange = ~np.isin(moment.labels.objectid, moment.known) | np.isnan(moment.material[..., 0])
    return float(np.sum((moment.labels.objectid > 0) & strange))


def _unexplained_pixels(moment: _Moment) -> float:
    if moment.frame.reason is None:
        return 0.0
    return float(np.sum(~moment.frame.seen & (moment.frame.reason == 0)))


def _seen_xray_error_m(moment: _Moment) -> float:
    errors = [0.0 if set(moment.moving) <= set(moment.xray or {}) else np.inf]
    for objectid, depth in (moment.xray or {}).items():
        own = moment.labels.objectid == objectid
        errors.append(_largest(np.abs(moment.depth[own].astype(np.float64) - depth[own])))
    return max(errors)


def _nearer_xray_m(moment: _Moment) -> float:
    errors = [0.0]
    for depth in (moment.xray or {}).values():
        there = np.isfinite(depth)
        errors.append(_largest(moment.depth[there].astype(np.float64) - depth[there]))
    return max(errors)


def _largest(errors: Float[np.ndarray, "error"]) -> float:
    """The largest error; infinite where one cannot be computed, 0 where there is nothing to compare."""
    return float(np.max(np.where(np.isnan(errors), np.inf, errors), initial=0.0))


_TESTS = (
    _Test(
        name="point",
        meaning="point by depth and camera, and by the mesh",
        bound=TOLERANCE_M,
        unit="m",
        error=_depth_error_m,
    ),
    _Test(
        name="projection",
        meaning="the mesh's point in the picture, and the pixel's centre",
        bound=TOLERANCE_PX,
        unit="px",
        error=_projection_error_px,
    ),
    _Test(
        name="unlabelled",
        meaning="depth without a label, or a label without depth",
        bound=0.0,
        unit="pixels",
        error=_unlabelled_pixels,
    ),
    _Test(
        name="strange labels",
        meaning="labels of an object or a face that there is not",
        bound=0.0,
        unit="pixels",
        error=_strange_labels,
    ),
    _Test(
        name="unexplained",
        meaning="no return, and no reason for it",
        bound=0.0,
        unit="pixels",
        error=_unexplained_pixels,
    ),
    _Test(
        name="x-ray seen",
        meaning="depth of a seen object, and in its X-ray",
        bound=TOLERANCE_M,
        unit="m",
        error=_seen_xray_error_m,
        of_xray=True,
    ),
    _Test(
        name="x-ray nearer",
        meaning="how far an X-ray lies before what is seen",
        bound=TOLERANCE_M,
        unit="m",
        error=_nearer_xray_m,
        of_xray=True,
    ),
)
