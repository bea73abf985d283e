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

NEAR, FAR, POST, WALKER = 1, 2, 3, 4
CAMERA = Camera(width=8, height=6, fx=4.0, fy=4.0, cx=4.0, cy=3.0, world_from_camera=np.eye(4))


def plate(depth: np.ndarray, half_width: float) -> MeshSequence:
    """One big triangle across the view, cut off at half the width, in each frame at a depth."""
    corners = np.array([[-half_width, -20, 0], [half_width, -20, 0], [-half_width, 60, 0]])
    vertices = corners + np.stack([0 * depth, 0 * depth, depth], axis=-1)[:, None]
    return MeshSequence(faces=np.array([[0, 1, 2]], np.int32), vertices=vertices.astype(np.float32))


def plates() -> dict[int, MeshSequence]:
    """A plate that comes nearer before a still one that is wider, and a narrow still one before both."""
    return {
        NEAR: plate(np.array([2.0, 1.8, 1.6]), 1.0),
        FAR: plate(np.array([4.0]), 60.0),
        POST: plate(np.array([1.0]), 0.3),
    }


def exact_recording(meshes: dict[int, MeshSequence] | None = None, drawn: tuple[int, ...] = (FAR, NEAR)) -> Recording:
    """The plates that are drawn, far ones first; worked out by hand, not cast."""
    meshes = meshes or {identity: plates()[identity] for identity in drawn}
    pictures = [picture({identity: meshes[identity] for identity in drawn}, number) for number in range(3)]
    kinds = {NEAR: "plate", FAR: "plate", POST: "plate", WALKER: "person"}
    objects = tuple(
        ObjectRecord(id=identity, name=f"object {identity}", kind=kinds[identity], moving=meshes[identity].moving)
        for identity in meshes
    )
    out_of_view = {identity: np.full((6, 8), np.nan, np.float32) for identity in meshes if identity == WALKER}
    return Recording(
        metadata=metadata_of(CAMERA, frames=3, fps=30.0, objects=objects),
        frames=tuple(frame for frame, _ in pictures),
        truth=meshes,
        xray=tuple({NEAR: depth, **out_of_view} for _, depth in pictures),
    )


def picture(meshes: dict[int, MeshSequence], number: int) -> tuple[Frame, np.ndarray]:
    """The frame, and the near plate's depth alone."""
    depth = np.full((6, 8), np.nan, np.float32)
    objectid = np.zeros((6, 8), np.uint32)
    u, v = np.zeros((6, 8), np.float32), np.zeros((6, 8), np.float32)
    xray = depth.copy()
    for identity, mesh in meshes.items():
        corners = mesh.vertices_at(number).astype(np.float64)
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


def with_walker(*corner: tuple[float, float, float]) -> Recording:
    """The exact recording and somebody beside the picture, with a foot where each frame has it."""
    foot = np.array(corner)[:, None] + np.array([[0, 0, 0], [0.2, 0, 1.7], [-0.2, 0, 1.7]])
    walker = MeshSequence(faces=np.array([[0, 1, 2]], np.int32), vertices=foot.astype(np.float32))
    meshes = {NEAR: plates()[NEAR], FAR: plates()[FAR], WALKER: walker}
    return exact_recording(meshes)


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
    assert [check.name for check in report.checks] == [
        *("point", "projection", "nearest", "unlabelled", "strange labels", "unexplained", "flow", "return"),
        *("x-ray missing", "x-ray seen", "x-ray nearer", "x-ray mesh"),
    ]
    assert all(check.largest < 1e-5 for check in report.checks)


def test_what_stands_before_an_exact_recording_is_no_error() -> None:
    recording = exact_recording(drawn=(FAR, NEAR, POST))
    labels = recording.frames[0].labels
    assert labels is not None
    assert {1, 2, 3} == set(np.unique(labels.objectid).tolist())
    assert not failed(recording)


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

    assert failed(with_last_frame(shifted)) == {"point", "projection", "return"}


def test_a_wrong_depth_is_found() -> None:
    wrong = with_last_frame(lambda frame: {"clean_depth": one_pixel(frame.clean_depth, 1.6 + 0.003)})
    assert failed(wrong) == {"point", "nearest", "x-ray seen", "x-ray nearer"}


def test_a_wrong_camera_is_found_by_all_that_is_measured() -> None:
    exact = exact_recording()
    camera = replace(CAMERA, cx=CAMERA.cx + 1)
    metadata = metadata_of(camera, frames=3, fps=30.0, objects=exact.metadata.objects)
    moved = Recording(metadata=metadata, frames=exact.frames, truth=exact.truth, xray=exact.xray)
    assert failed(moved) == {"point", "projection", "nearest", "flow", "return", "x-ray mesh"}


def test_a_picture_that_forgot_an_object_is_found() -> None:
    meshes = {identity: plates()[identity] for identity in (FAR, NEAR, POST)}
    assert failed(exact_recording(meshes, drawn=(FAR, NEAR))) == {"nearest"}


def test_skin_that_stretches_like_rubber_is_found() -> None:
    wider = plates()[NEAR].vertices.copy()
    wider[2, 1, 0] += 1.0
    meshes = {NEAR: replace(plates()[NEAR], vertices=wider), FAR: plates()[FAR]}
    assert failed(exact_recording(meshes)) == {"return"}


def test_a_foot_that_stands_passes() -> None:
    report = verify(with_walker((90.0, 0, 0), (90.01, 0, 0.001), (90.3, 0, 0.1)))
    assert report.passes
    assert [check.name for check in report.checks[-2:]] == ["feet slide", "feet sink"]
    assert report.checks[-2].largest == pytest.approx(0.01, abs=1e-4)


def test_a_foot_that_slides_is_found() -> None:
    assert failed(with_walker((90.0, 0, 0), (90.03, 0, 0), (90.06, 0, 0))) == {"feet slide"}


def test_a_foot_that_sinks_is_found() -> None:
    assert failed(with_walker((90.0, 0, -0.03), (90.0, 0, -0.03), (90.0, 0, 0))) == {"feet sink"}


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
    ("shift_m", "found"),
    [
        (0.01, {"x-ray seen", "x-ray mesh"}),
        (-0.01, {"x-ray seen", "x-ray nearer", "x-ray mesh"}),
        (np.nan, {"x-ray missing", "x-ray mesh"}),
    ],
)
def test_an_x_ray_that_contradicts_what_is_seen_is_found(shift_m: float, found: set[str]) -> None:
    exact = exact_recording()
    assert exact.xray is not None
    assert failed(with_xray(exact, [depth[NEAR] + np.float32(shift_m) for depth in exact.xray])) == found


def test_an_x_ray_that_is_wrong_where_nobody_sees_it_is_found() -> None:
    exact = exact_recording(drawn=(FAR, NEAR, POST))
    assert exact.xray is not None
    labels = [frame.labels.objectid for frame in exact.frames if frame.labels is not None]
    hidden = [np.where(seen == NEAR, 0, np.float32(0.01)) for seen in labels]
    shifted = [depth[NEAR] + shift for depth, shift in zip(exact.xray, hidden, strict=True)]
    assert failed(with_xray(exact, shifted)) == {"x-ray mesh"}


def test_a_moving_object_without_x_ray_is_found() -> None:
    exact = exact_recording()
    lacking = Recording(metadata=exact.metadata, frames=exact.frames, truth=exact.truth, xray=({}, {}, {}))
    assert failed(lacking) == {"x-ray missing"}


def with_xray(recording: Recording, near: list[np.ndarray]) -> Recording:
    xray = tuple({NEAR: depth} for depth in near)
    return Recording(metadata=recording.metadata, frames=recording.frames, truth=recording.truth, xray=xray)


def test_a_recording_without_truth_cannot_be_verified() -> None:
    with pytest.raises(InputError, match="only simulated ones can be verified"):
        verify(stripped(exact_recording()))


def test_a_mesh_that_is_missing_is_named() -> None:
    exact = exact_recording()
    assert exact.truth is not None
    lacking = Recording(metadata=exact.metadata, frames=exact.frames, truth={NEAR: exact.truth[NEAR]})
    with pytest.raises(InputError, match=r"object 2 \(object 2\) has no mesh"):
        verify(lacking)
