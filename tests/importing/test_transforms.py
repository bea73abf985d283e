"""The camera stands where a bag's transforms put it, in a frame that is fixed; one that moves is refused."""

from pathlib import Path

import numpy as np
import pytest
from bag_files import KINDS, TOPIC, Bag, images, new_bag
from imports import KNOWN, TIMES, imported, refusal

UNTIMED = KNOWN.model_copy(update={"fps": None})
UNTURNED = (0.0, 0.0, 0.0, 1.0)
LENS = ("camera_link", "depth", (0.0, 0.1, 0.0, -0.5, 0.5, -0.5, 0.5))
"""From x forward, y left, z up to a camera's x right, y down, z forward."""
STAND = ("map", "camera_link", (1.0, 2.0, 3.0, 0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)))
"""A quarter turn to the left."""
WORLD_FROM_CAMERA = [[1, 0, 0, 0.9], [0, 0, 1, 2], [0, -1, 0, 3], [0, 0, 0, 1]]
Move = tuple[str, str, tuple[float, ...]]


def ride(path: Path, kind: str, *still: Move, moving: tuple[tuple[float, Move], ...] = ()) -> Path:
    with new_bag(path / KINDS[kind], kind) as bag:
        _transforms(bag, still, moving)
        bag.add(TOPIC, images(bag))
    return path / KINDS[kind]


def _transforms(bag: Bag, still: tuple[Move, ...], moving: tuple[tuple[float, Move], ...]) -> None:
    if still:
        bag.add("/tf_static", [(TIMES[0], bag.transforms(TIMES[0], *still))])
    if moving:
        bag.add("/tf", [(time, bag.transforms(time, move)) for time, move in moving])


@pytest.mark.parametrize("kind", KINDS)
def test_the_camera_stands_where_the_transforms_put_it(tmp_path: Path, kind: str) -> None:
    recording = imported(ride(tmp_path, kind, LENS, STAND), tmp_path / "rec", known=UNTIMED)
    np.testing.assert_allclose(recording.camera.world_from_camera, WORLD_FROM_CAMERA, atol=1e-6)


def test_a_camera_that_rests_by_moving_transforms_is_taken(tmp_path: Path) -> None:
    parent, child, pose = STAND
    trembling = tuple((time, (parent, child, (pose[0] + 0.002 * (-1) ** n, *pose[1:]))) for n, time in enumerate(TIMES))
    recording = imported(ride(tmp_path, "ros1", LENS, moving=trembling), tmp_path / "rec", known=UNTIMED)
    np.testing.assert_allclose(recording.camera.world_from_camera, WORLD_FROM_CAMERA, atol=1e-6)


def test_a_camera_that_moves_is_refused(tmp_path: Path) -> None:
    parent, child, pose = STAND
    driving = tuple((time, (parent, child, (pose[0] + time - 100, *pose[1:]))) for time in TIMES)
    message = refusal(ride(tmp_path, "mcap", LENS, moving=driving), tmp_path / "rec", known=UNTIMED)
    assert "frame 'depth' in 'map': expected a camera at rest" in message
    known = UNTIMED.model_copy(update={"world_from_camera": ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))})
    assert "expected a camera at rest" in refusal(tmp_path / "ride", tmp_path / "rec", known=known)
    resting = imported(tmp_path / "ride", tmp_path / "rec", known=UNTIMED, world_frame="camera_link")
    np.testing.assert_allclose(resting.camera.position, [0, 0.1, 0], atol=1e-9)


def test_what_moves_before_and_after_the_frames_does_not_matter(tmp_path: Path) -> None:
    parent, child, pose = STAND
    carried = ((90.0, (parent, child, (9.0, *pose[1:]))), (99.0, STAND), (101.0, (parent, child, (8.0, *pose[1:]))))
    recording = imported(ride(tmp_path, "ros1", LENS, moving=carried), tmp_path / "rec", known=UNTIMED)
    np.testing.assert_allclose(recording.camera.world_from_camera, WORLD_FROM_CAMERA, atol=1e-6)


def test_a_frame_that_may_move_is_the_world_only_by_name(tmp_path: Path) -> None:
    path = ride(tmp_path, "sqlite3", LENS, ("base_link", "camera_link", (0.0, 0.0, 1.0, *UNTURNED)))
    unplaced = imported(path, tmp_path / "rec", known=UNTIMED)
    np.testing.assert_array_equal(unplaced.camera.world_from_camera, np.eye(4))
    placed = imported(path, tmp_path / "rec2", known=UNTIMED, world_frame="base_link")
    np.testing.assert_allclose(placed.camera.position, [0, 0.1, 1], atol=1e-9)


def test_the_world_may_be_beside_the_camera(tmp_path: Path) -> None:
    path = ride(tmp_path, "ros1", LENS, STAND, ("/map", "door", (5.0, 2.0, 3.0, *UNTURNED)))
    recording = imported(path, tmp_path / "rec", known=UNTIMED, world_frame="/door")
    np.testing.assert_allclose(recording.camera.position, [-4.1, 0, 0], atol=1e-6)


def test_frames_that_hang_together_in_no_way_are_refused(tmp_path: Path) -> None:
    path = ride(tmp_path, "ros1", LENS, STAND)
    message = refusal(path, tmp_path / "rec", known=UNTIMED, world_frame="moon")
    assert (
        "expected transforms between 'depth', the camera's frame, and 'moon', got the frames camera_link, " in message
    )
    circle = ride(tmp_path, "mcap", LENS, ("depth", "camera_link", LENS[2]))
    assert "got a circle at 'depth'" in refusal(circle, tmp_path / "rec", known=UNTIMED)
    other = ride(tmp_path / "b", "sqlite3", LENS, STAND, ("odom", "camera_link", STAND[2]))
    assert "expected 'camera_link' in one frame" in refusal(other, tmp_path / "rec", known=UNTIMED)
    turn = ride(tmp_path / "c", "sqlite3", LENS, ("map", "camera_link", (0.0,) * 7))
    assert "unit quaternions in the transforms" in refusal(turn, tmp_path / "rec", known=UNTIMED)


def test_a_place_by_option_overrides_the_transforms(tmp_path: Path) -> None:
    rows = ((1.0, 0.0, 0.0, 5.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    known = UNTIMED.model_copy(update={"world_from_camera": rows})
    recording = imported(ride(tmp_path, "ros1", LENS, STAND), tmp_path / "rec", known=known)
    np.testing.assert_array_equal(recording.camera.position, [5, 0, 0])
