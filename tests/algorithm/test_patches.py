"""What part of the picture each point stands for."""

import numpy as np
import pytest
from made import trajectories_of

from algorithm.patches import Patches, patches
from recording.camera import Camera

CAMERA = Camera(width=20, height=10, fx=10.0, fy=10.0, cx=10.0, cy=5.0, world_from_camera=np.eye(4))
DEPTH_M = 2.0


def around(points: list[tuple[int, tuple[float, float, float]]], moving: list[np.ndarray], reach_m: float) -> Patches:
    made = trajectories_of([(frame, np.array([place])) for frame, place in points])
    return patches(made, moving, camera=CAMERA, reach_m=reach_m)


def wall() -> np.ndarray:
    return np.full((10, 20), DEPTH_M, np.float32)


def test_all_pixels_are_shared_out_to_the_nearest_points() -> None:
    found = around([(0, (-1.0, 0.0, DEPTH_M)), (0, (1.0, 0.0, DEPTH_M))], [wall()], reach_m=10.0)
    assert found.pixels.tolist() == [100, 100]
    np.testing.assert_allclose(found.centre, [[-1.0, 0.0, DEPTH_M], [1.0, 0.0, DEPTH_M]], atol=1e-12)


def test_a_few_points_on_one_half_do_not_draw_the_centre_there() -> None:
    places = [(-1.9, 0.0, DEPTH_M), (-1.7, 0.0, DEPTH_M), (-1.5, 0.0, DEPTH_M), (1.0, 0.0, DEPTH_M)]
    found = around([(0, place) for place in places], [wall()], reach_m=10.0)
    np.testing.assert_allclose(np.average(found.centre, axis=0, weights=found.pixels), [0.0, 0.0, DEPTH_M], atol=1e-12)


def test_pixels_far_from_every_point_count_nowhere() -> None:
    found = around([(0, (0.0, 0.0, DEPTH_M))], [wall()], reach_m=0.25)
    assert found.pixels.tolist() == [4]  # Pixels are 0.2 m apart here, the point lies between four of them.


def test_a_point_without_a_pixel_is_its_own_centre() -> None:
    still = np.full((10, 20), np.nan, np.float32)
    found = around([(0, (0.5, 0.1, DEPTH_M)), (1, (0.3, 0.1, 7.0))], [still, wall()], reach_m=0.25)
    assert found.pixels.tolist() == [0, 0]
    np.testing.assert_allclose(found.centre, [[0.5, 0.1, DEPTH_M], [0.3, 0.1, 7.0]])


@pytest.mark.parametrize("frames", [0, 2])
def test_no_points_have_no_patches(frames: int) -> None:
    found = around([], [wall()] * frames, reach_m=1.0)
    assert (len(found.pixels), found.centre.shape) == (0, (0, 3))


def test_each_frame_is_shared_out_by_itself() -> None:
    half = np.where(np.arange(20) < 10, wall(), np.float32(np.nan))
    found = around([(1, (0.0, 0.0, DEPTH_M)), (0, (0.0, 0.0, DEPTH_M))], [wall(), half], reach_m=10.0)
    assert found.pixels.tolist() == [100, 200]
