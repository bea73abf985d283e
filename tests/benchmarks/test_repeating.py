"""Trajectories repeated in space and in time, for measuring how cost grows."""

import numpy as np
import pytest

from algorithm.followed import Followed
from algorithm.patches import Patches
from algorithm.trajectories import Trajectories
from benchmarks.repeating import APART_M, Arm, chosen, repeated
from recording.camera import Camera, looking_at

CAMERA = Camera(
    width=64,
    height=48,
    fx=60.0,
    fy=60.0,
    cx=32.0,
    cy=24.0,
    world_from_camera=looking_at((1.0, -4.0, 2.0), (0.0, 0.0, 1.0)),
)


def few() -> Followed:
    """Three points over five frames, not all as long."""
    trajectory = np.repeat([0, 1, 2], [5, 3, 4])
    position = np.random.default_rng(0).uniform(-1, 1, (len(trajectory), 3))
    column_row, _ = CAMERA.pixel_from_world(position)
    return Followed(
        trajectories=Trajectories(
            trajectory=trajectory,
            frame=np.array([0, 1, 2, 3, 4, 1, 2, 3, 0, 1, 2, 3]),
            position=position,
            column_row=column_row,
        ),
        patches=Patches(pixels=np.arange(12.0), centre=position + 0.01),
        spacing_m=0.02,
        camera=CAMERA,
        fps=30.0,
        frames=5,
    )


@pytest.mark.parametrize("arm", ["space", "time"])
def test_each_copy_is_the_same_crowd_elsewhere(arm: Arm) -> None:
    one, many = few(), repeated(few(), 3, arm, pause_frames=7)
    assert many.trajectories.count == 9
    for number in range(3):
        own = chosen(many, np.arange(9) // 3 == number)
        np.testing.assert_array_equal(own.trajectories.trajectory, one.trajectories.trajectory)
        np.testing.assert_array_equal(own.patches.pixels, one.patches.pixels)
        np.testing.assert_allclose(own.patches.centre - own.trajectories.position, 0.01, atol=1e-9)
        away = own.trajectories.position - one.trajectories.position
        np.testing.assert_allclose(away, np.broadcast_to(away[0], away.shape), atol=1e-9)
        assert np.linalg.norm(away[0]) == pytest.approx(APART_M * number if arm == "space" else 0)
        later = own.trajectories.frame - one.trajectories.frame
        assert set(later.tolist()) == {12 * number if arm == "time" else 0}
    assert many.frames == (36 if arm == "time" else 5)
    assert repeated(one, 1, arm, pause_frames=7).trajectories.count == 3


def test_copies_in_space_lie_where_the_camera_would_see_them() -> None:
    many = repeated(few(), 4, "space", pause_frames=0).trajectories
    column_row, _ = CAMERA.pixel_from_world(many.position)
    np.testing.assert_allclose(column_row, many.column_row, atol=1e-6)


def test_what_is_repeated_stays_as_it_was() -> None:
    given = few()
    before = given.trajectories.position.copy(), given.trajectories.frame.copy(), given.trajectories.column_row.copy()
    repeated(given, 3, "space", pause_frames=0)
    repeated(given, 3, "time", pause_frames=0)
    after = given.trajectories.position, given.trajectories.frame, given.trajectories.column_row
    for old, new in zip(before, after, strict=True):
        np.testing.assert_array_equal(old, new)
