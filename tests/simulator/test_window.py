"""Which faces a ray can meet: all that a caster meets when it is given every face, and few others."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recording.camera import Camera, looking_at, pixel_grid
from simulator.window import NOWHERE, camera_points, reachable_faces, shared_window, window_around

WIDTH, HEIGHT = 24, 18


def camera() -> Camera:
    view = looking_at((0.3, -5.5, 1.5), (0.0, 0.0, 1.0))
    return Camera(width=WIDTH, height=HEIGHT, fx=20.0, fy=21.0, cx=12.3, cy=8.8, world_from_camera=view)


def met_by_some_ray(points: np.ndarray, face: np.ndarray) -> bool:
    """Whether any pixel's ray meets the triangle, by solving ray t = a A + b B + c C for each."""
    view = camera()
    rays = view.camera_from_pixel(pixel_grid(HEIGHT, WIDTH), np.ones((HEIGHT, WIDTH))).reshape(-1, 3)
    weights = np.linalg.solve(points[:, face], rays.T)
    return bool((weights >= 0).all(axis=0).any())


@given(st.integers(0, 10**6), st.sampled_from([0.02, 0.3, 2.0, 20.0]))
def test_every_face_that_a_ray_meets_is_among_them(seed: int, size_m: float) -> None:
    generator = np.random.default_rng(seed)
    middle = generator.uniform([-4, -8, -1], [4, 4, 3], (20, 1, 3))
    vertices = (middle + generator.normal(0, size_m, (20, 3, 3))).reshape(-1, 3)
    faces = np.arange(60, dtype=np.int32).reshape(20, 3)
    points = camera_points(camera(), vertices)
    reachable = set(reachable_faces(camera(), points, faces).tolist())
    assert {number for number in range(20) if met_by_some_ray(points, faces[number])} <= reachable


def test_few_small_faces_are_reachable() -> None:
    generator = np.random.default_rng(0)
    middle = generator.uniform([-1, -1, 0.5], [1, 1, 1.5], (1000, 1, 3))
    vertices = (middle + generator.normal(0, 0.02, (1000, 3, 3))).reshape(-1, 3)
    faces = np.arange(3000, dtype=np.int32).reshape(1000, 3)
    assert 0 < len(reachable_faces(camera(), camera_points(camera(), vertices), faces)) < 100


@pytest.mark.parametrize("beside", [(30.0, 0.0, 1.0), (0.0, -9.0, 1.0), (0.0, 0.0, 20.0)])
def test_what_is_out_of_view_has_no_window_and_no_faces(beside: tuple[float, float, float]) -> None:
    points = camera_points(camera(), np.array(beside) + np.eye(3) / 10)
    assert window_around(camera(), points) == NOWHERE
    assert len(reachable_faces(camera(), points, np.array([[0, 1, 2]]))) == 0


def test_what_reaches_through_the_cameras_plane_may_be_anywhere() -> None:
    points = camera_points(camera(), np.array([[0.0, -9.0, 0.0], [0.1, -9.0, 0.0], [0.0, 9.0, 0.0]]))
    assert window_around(camera(), points) == (slice(0, HEIGHT), slice(0, WIDTH))
    assert reachable_faces(camera(), points, np.array([[0, 1, 2]])).tolist() == [0]


def test_windows_share_what_both_have() -> None:
    one, other = (slice(2, 9), slice(0, 5)), (slice(4, 20), slice(3, 8))
    assert shared_window(one, other) == shared_window(other, one) == (slice(4, 9), slice(3, 5))
    assert shared_window(one, (slice(9, 12), slice(0, 5))) == NOWHERE
