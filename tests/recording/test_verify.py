"""The self-check: an exact recording passes, and each kind of lie is found by its name."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from recording.camera import Camera, pixel_grid
from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.recording import Recording, stripped
from recording.truth import MeshSequence
from recording.verify import verify

NEAR, FAR = 1, 2
CAMERA = Camera(width=8, height=6, fx=4.0, fy=4.0, cx=4.0, cy=3.0, world_from_camera=np.eye(4))


def plate(depth: np.ndarray, half_width: float) -> MeshSequence:
    """One big triangle across the view, cut off at half the width, in each frame at a depth."""
    corners = np.array([[-half_width, -20, 0], [half_width, -20, 0], [-half_width, 60, 0]])
    vertices = corners + np.stack([0 * depth, 0 * depth, depth], axis=-1)[:, None]
    return MeshSequence(faces=np.array([[0, 1, 2]], np.int32), vertices=vertices.astype(np.float32))


def exact_recording() -> Recording:
    """A plate that comes nearer before a still one that is wider; worked out by hand, not cast."""
    meshes = {NEAR: plate(np.array([2.0, 1.8, 1.6]), 1.0), FAR: plate(np.array([4.0]), 60.0)}
    pictures = [picture(meshes, number) for number in range(3)]
    objects = (
        ObjectRecord(id=NEAR, name="near", kind="plate", moving=True),
        ObjectRecord(id=FAR, name="far", kind="plate", moving=False),
    )
    return Recording(
        metadata=metadata_of(CAMERA, frames=3, fps=30.0, objects=objects),
        frames=tuple(frame for frame, _ in pictures),
        truth=meshes,
        xray=tuple({NEAR: depth} for _, depth in pictures),
    )


def picture(meshes: dict[int, MeshSequence], number: int) -> tuple[Frame, np.ndarray]:
    """The frame, and the near plate's depth alone."""
    depth = np.full((6, 8), np.nan, np.float32)
    objectid = np.zeros((6, 8), np.uint32)
    u, v = np.zeros((6, 8), np.float32), np.zeros((6, 8), np.float32)
    xray = depth.copy()
    for identity in (FAR, NEAR):
        corners = meshes[identity].vertices_at(number).astype(np.float64)
        place = CAMERA.camera_from_pixel(pixel_grid(6, 8), np.full((6, 8), corners[0, 2]))
        weight_b = (place[..., 0] - corners[0, 0]) / (corners[1, 0] - corners[0, 0])
        weight_c = (place[..., 1] - corners[0, 1]) / (corners[2, 1] - corners[0, 1])
        inside = (weight_b >= 0) & (weight_c >= 0) & (weight_b + weight_c <= 1)
        depth[inside], objectid[inside] = corners[0, 2], identity
        u[inside], v[inside] = weight_b[inside], weight_c[inside]
        if identity == NEAR:
            xray[inside] = corners[0, 2]
    labels = Labels(objectid=objectid, face=np.zeros((6, 8), np.uint32), u=u, v=v)
    reason = np.where(np.isfinite(depth), 0, 1).astype(np.uint32)
    return Frame(depth=depth, labels=labels, clean_depth=depth, reason=reason), xray


def with_last_frame(change: Callable[[Frame], dict[str, Any]]) -> Recording:
    """The exact recording with its last frame changed."""
    exact = exact_recording()
    last = replace(exact.frames[-1], **change(exact.frames[-1]))
    return replace_frames(exact, (*exact.frames[:-1], last))


def replace_frames(recording: Recording, frames: tuple[Frame, ...]) -> Recording:
    return Recording(metadata=recording.metadata, frames=frames, truth=recording.truth, xray=recording.xray)


def failed(recording: Recording) -> set[str]:
    report = verify(recording)
    assert report.passes == all(check.passes for check in report.checks)
    return {check.name for check in report.checks if not check.passes}


def changed_labels(frame: Frame, **channels: np.ndarray) -> dict[str, Any]:
    assert frame.labels is not None
    return {"labels": replace(frame.labels, **channels)}


def one_pixel(image: np.ndarray | None, change: float) -> np.ndarray:
    assert image is not None
    altered = image.copy()
    altered[3, 3] = change
    return altered


def test_an_exact_recording_passes_with_next_to_no_error() -> None:
    report = verify(exact_recording())
    assert report.passes
    assert {check.name: check.largest < 1e-5 for check in report.checks} == dict.fromkeys(
        ["point", "projection", "unlabelled", "strange labels", "unexplained", "x-ray seen", "x-ray nearer"], True
    )


def test_the_largest_error_is_a_distance_in_metres() -> None:
    off = with_last_frame(lambda frame: {"clean_depth": one_pixel(frame.clean_depth, 1.6 + 0.003)})
    point = verify(off).checks[0]
    assert point.name == "point"
    along_the_ray = np.linalg.norm([0.5 / 4, 0.5 / 4, 1])
    assert point.largest == pytest.approx(0.003 * along_the_ray, rel=1e-3)


def test_noise_of_the_sensor_is_no_error() -> None:
    assert not failed(with_last_frame(lambda frame: {"depth": frame.depth + np.float32(0.01)}))


def test_a_label_on_the_wrong_place_of_the_mesh_is_found() -> None:
    def shifted(frame: Frame) -> dict[str, Any]:
        assert frame.labels is not None
        return changed_labels(frame, u=one_pixel(frame.labels.u, 0.7))

    assert failed(with_last_frame(shifted)) == {"point", "projection"}


def test_depth_without_a_label_is_found() -> None:
    def unlabelled(frame: Frame) -> dict[str, Any]:
        assert frame.labels is not None
        return changed_labels(frame, objectid=one_pixel(frame.labels.objectid, 0))

    assert failed(with_last_frame(unlabelled)) == {"unlabelled"}


@pytest.mark.parametrize(("channel", "value"), [("objectid", 9), ("face", 5)])
def test_labels_of_what_there_is_not_are_found(channel: str, value: int) -> None:
    def strange(frame: Frame) -> dict[str, Any]:
        return changed_labels(frame, **{channel: one_pixel(getattr(frame.labels, channel), value)})

    assert failed(with_last_frame(strange)) == {"strange labels", "point", "projection"}


def test_a_missing_return_needs_a_reason() -> None:
    assert failed(with_last_frame(lambda frame: {"depth": one_pixel(frame.depth, np.nan)})) == {"unexplained"}


@pytest.mark.parametrize(
    ("shift_m", "found"), [(0.01, {"x-ray seen"}), (-0.01, {"x-ray seen", "x-ray nearer"}), (np.nan, {"x-ray seen"})]
)
def test_an_x_ray_that_contradicts_what_is_seen_is_found(shift_m: float, found: set[str]) -> None:
    exact = exact_recording()
    assert exact.xray is not None
    xray = tuple({NEAR: depth[NEAR] + np.float32(shift_m)} for depth in exact.xray)
    assert failed(Recording(metadata=exact.metadata, frames=exact.frames, truth=exact.truth, xray=xray)) == found


def test_a_moving_object_without_x_ray_is_found() -> None:
    exact = exact_recording()
    lacking = Recording(metadata=exact.metadata, frames=exact.frames, truth=exact.truth, xray=({}, {}, {}))
    assert failed(lacking) == {"x-ray seen"}


def test_a_recording_without_truth_cannot_be_verified() -> None:
    with pytest.raises(InputError, match="only simulated ones can be verified"):
        verify(stripped(exact_recording()))


def test_a_mesh_that_is_missing_is_named() -> None:
    exact = exact_recording()
    assert exact.truth is not None
    lacking = Recording(metadata=exact.metadata, frames=exact.frames, truth={NEAR: exact.truth[NEAR]})
    with pytest.raises(InputError, match=r"object 2 \(far\) has no mesh"):
        verify(lacking)
