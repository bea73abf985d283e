"""Material points between any two frames: known motion, no motion, what covers them, what cannot be asked."""

import numpy as np
import pytest
from known import CAMERA, FRAMES, GROUND, LEFT, RIGHT, WALL, crossing, masks_only

from recording.camera import pixel_grid
from recording.correspondence import flow_between, places_of, track
from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.recording import Recording, stripped
from recording.truth import MeshSequence

STEP_PX = {LEFT: 1.0, RIGHT: -1.0, WALL: 0.0, GROUND: 0.0}
DEPTH = {LEFT: 3.0, RIGHT: 4.0, WALL: 2.0, GROUND: 6.0}


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


def labels_of(recording: Recording, frame: int) -> np.ndarray:
    labels = recording.frames[frame].labels
    assert labels is not None
    return labels.objectid


def turned_plates() -> Recording:
    """Two plates back to back, one object, that turn half round from the first frame to the second."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    front, back = (np.column_stack([square, np.full(4, depth)]) for depth in (3.0, 3.2))
    first = np.concatenate([front, back])
    second = (first - [0, 0, 3.1]) * [-1, 1, -1] + [0, 0, 3.1]
    quad = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    mesh = MeshSequence(faces=np.concatenate([quad, quad + 4]), vertices=np.stack([first, second]).astype(np.float32))
    place = CAMERA.world_from_pixel(
        pixel_grid(CAMERA.height, CAMERA.width), np.full((CAMERA.height, CAMERA.width), 3.0)
    )
    s, t = (place[..., 0] + 1) / 2, (place[..., 1] + 1) / 2
    inside = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    labels = Labels(
        objectid=np.where(inside, 5, 0).astype(np.uint32),
        face=np.where(s >= t, 0, 1).astype(np.uint32),
        u=np.where(s >= t, s - t, s).astype(np.float32),
        v=np.where(s >= t, t, t - s).astype(np.float32),
    )
    frame = Frame(depth=np.where(inside, 3.0, np.nan).astype(np.float32), labels=labels)
    objects = (ObjectRecord(id=5, name="plates", kind="box", moving=True),)
    metadata = metadata_of(CAMERA, frames=2, fps=30.0, objects=objects)
    return Recording(metadata=metadata, frames=[frame, frame], truth={5: mesh})


def test_a_points_place_in_its_own_frame_is_what_the_depth_says(recording: Recording) -> None:
    for frame in (0, 17):
        by_depth = CAMERA.world_points(recording.frames[frame].depth)
        np.testing.assert_allclose(places_of(recording, frame, at=frame), by_depth, atol=1e-6)


@pytest.mark.parametrize(("a", "b"), [(3, 4), (4, 3), (0, 30), (30, 0), (12, 12)])
def test_the_flow_of_a_known_motion_is_found_forward_and_backward(recording: Recording, a: int, b: int) -> None:
    flow = flow_between(recording, a, b)
    labels = labels_of(recording, a)
    for objectid in (LEFT, RIGHT):
        own = labels == objectid
        if not own.any():
            continue
        way_px = STEP_PX[objectid] * (b - a)
        np.testing.assert_allclose(flow.pixels[own], np.broadcast_to([way_px, 0], (own.sum(), 2)), atol=2e-5)
        way_m = way_px * DEPTH[objectid] / CAMERA.fx
        np.testing.assert_allclose(flow.metres[own], np.broadcast_to([way_m, 0, 0], (own.sum(), 3)), atol=1e-6)


def test_what_stands_still_has_exactly_no_flow_and_what_is_no_object_none(recording: Recording) -> None:
    flow = flow_between(recording, 2, 25)
    still = np.isin(labels_of(recording, 2), [WALL, GROUND])
    nothing = labels_of(recording, 2) == 0
    assert not flow.pixels[still].any()
    assert not flow.metres[still].any()
    assert np.isnan(flow.pixels[nothing]).all()
    assert np.isnan(flow.metres[nothing]).all()
    assert not flow.visible[nothing].any()


def test_a_frame_shows_all_of_itself(recording: Recording) -> None:
    for frame in (0, 10, 18):
        flow = flow_between(recording, frame, frame)
        np.testing.assert_array_equal(flow.visible, labels_of(recording, frame) > 0)
        assert not flow.covered_by.any()
        assert np.nanmax(np.abs(flow.pixels)) == 0


@pytest.mark.parametrize("b", [0, 9, 14, 18, 22, 35])
def test_what_covers_a_point_is_known(recording: Recording, b: int) -> None:
    """Behind the wall's rectangle it is the wall, behind the near square the near square."""
    flow, labels = flow_between(recording, 0, b), labels_of(recording, 0)
    column, row = np.moveaxis(pixel_grid(CAMERA.height, CAMERA.width) + flow.pixels, -1, 0)
    near_column = 32 + 40 * (-1.35 + b * 3 / 40) / 3
    by_wall = (abs(column - 32) <= 9) & (abs(row - 15) <= 9)
    by_near = (abs(column - near_column) <= 20 / 3) & (abs(row - 15) <= 20 / 3)
    expected = {LEFT: np.where(by_wall, WALL, 0), RIGHT: np.where(by_wall, WALL, np.where(by_near, LEFT, 0))}
    for objectid, cover in expected.items():
        own = labels == objectid
        np.testing.assert_array_equal(flow.covered_by[own], cover[own])
        np.testing.assert_array_equal(flow.visible[own], cover[own] == 0)


def test_the_near_square_covers_the_far_one() -> None:
    bare = crossing(wall=False)
    assert set(np.unique(flow_between(bare, 0, 18).covered_by).tolist()) == {0, LEFT}


def test_an_object_that_turns_covers_its_own_far_side() -> None:
    plates = turned_plates()
    flow, labelled = flow_between(plates, 0, 1), labels_of(plates, 0) == 5
    assert (flow.covered_by[labelled] == 5).all()
    assert not flow.visible.any()


def test_what_leaves_the_picture_is_covered_by_nothing_but_not_visible() -> None:
    bare = crossing(wall=False)
    truth = {**bare.truth, LEFT: away(bare.truth[LEFT])}
    leaving = Recording(metadata=bare.metadata, frames=bare.frames, truth=truth)
    flow, own = flow_between(leaving, 0, 1), labels_of(bare, 0) == LEFT
    assert np.isfinite(flow.pixels[own]).all()
    assert not flow.visible[own].any()
    assert not flow.covered_by[own].any()


def away(mesh: MeshSequence) -> MeshSequence:
    """The mesh, from the second frame on ten metres aside."""
    vertices = mesh.vertices.copy()
    vertices[1:, :, 0] += 10
    return MeshSequence(faces=mesh.faces, vertices=vertices)


def test_a_return_that_the_sensor_lost_has_its_flow() -> None:
    whole, lossy = (flow_between(crossing(lost=share), 0, 5) for share in (0.0, 0.5))
    np.testing.assert_array_equal(whole.pixels, lossy.pixels)
    np.testing.assert_array_equal(whole.visible, lossy.visible)


def test_a_track_is_the_flow_to_every_frame(recording: Recording) -> None:
    labels = labels_of(recording, 3)
    pixels = np.concatenate([np.argwhere(labels == LEFT)[:4], np.argwhere(labels == RIGHT)[:4], [[0, 0]]])
    found = track(recording, 3, pixels)
    row, column = pixels.T
    assert found.places.shape == (9, FRAMES, 3)
    assert np.isnan(found.places[-1]).all()
    for frame in (0, 3, 15, 20, 35):
        flow = flow_between(recording, 3, frame)
        np.testing.assert_array_equal(found.places[:, frame], places_of(recording, 3, at=frame)[row, column])
        np.testing.assert_allclose(
            found.column_row[:, frame], pixels[:, ::-1] + 0.5 + flow.pixels[row, column], atol=1e-5
        )
        np.testing.assert_array_equal(found.visible[:, frame], flow.visible[row, column])
        np.testing.assert_array_equal(found.covered_by[:, frame], flow.covered_by[row, column])


def test_what_cannot_be_asked_is_refused(recording: Recording) -> None:
    with pytest.raises(InputError, match="only simulated ones know all places"):
        flow_between(stripped(recording), 0, 1)
    with pytest.raises(InputError, match="frame 0: expected channels objectid, face"):
        flow_between(Recording(metadata=recording.metadata, frames=masks_only(recording).frames, truth={}), 0, 1)
    for a, b in [(-1, 0), (0, FRAMES)]:
        with pytest.raises(InputError, match=f"expected a frame from 0 to {FRAMES - 1}, got {a if a < 0 else b}"):
            flow_between(recording, a, b)
    with pytest.raises(InputError, match=r"inside the picture of \(30, 64\), got \(30, 0\)"):
        track(recording, 0, np.array([[2, 2], [30, 0]]))
