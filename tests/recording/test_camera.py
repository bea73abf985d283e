"""The camera: there and back again, the pixel convention, the axes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recording.camera import Camera, looking_at, pixel_grid, transformed

metres = st.floats(-20, 20)
places = st.tuples(metres, metres, metres)


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    position = draw(places)
    away = draw(places.filter(lambda step: np.linalg.norm(step) > 0.1))
    return Camera(
        width=draw(st.integers(1, 640)),
        height=draw(st.integers(1, 480)),
        fx=draw(st.floats(10, 1000)),
        fy=draw(st.floats(10, 1000)),
        cx=draw(st.floats(-50, 700)),
        cy=draw(st.floats(-50, 500)),
        world_from_camera=looking_at(position, tuple(np.add(position, away))),
    )


@given(
    cameras(), st.lists(st.tuples(st.floats(-10, 700), st.floats(-10, 500)), min_size=1, max_size=8), st.floats(0.1, 50)
)
def test_a_picture_position_returns_from_the_world(camera: Camera, positions, depth: float) -> None:
    column_row = np.array(positions)
    points = camera.world_from_pixel(column_row, np.full(len(column_row), depth))
    again, again_depth = camera.pixel_from_world(points)
    np.testing.assert_allclose(again, column_row, atol=1e-6)
    np.testing.assert_allclose(again_depth, depth, atol=1e-9)


@given(cameras(), places)
def test_a_world_point_before_the_camera_returns_from_the_picture(camera: Camera, place) -> None:
    point = np.array(place)
    column_row, depth = camera.pixel_from_world(point)
    if depth > 0.1:
        np.testing.assert_allclose(camera.world_from_pixel(column_row, depth), point, atol=1e-6)
    elif depth <= 0:
        assert np.isnan(column_row).all()


def plain(width: int = 8, height: int = 6) -> Camera:
    return Camera(width=width, height=height, fx=4.0, fy=5.0, cx=4.0, cy=3.0, world_from_camera=np.eye(4))


def test_the_first_pixel_has_its_centre_at_one_half() -> None:
    grid = pixel_grid(6, 8)
    assert grid.shape == (6, 8, 2)
    np.testing.assert_array_equal(grid[0, 0], [0.5, 0.5])
    np.testing.assert_array_equal(grid[2, 7], [7.5, 2.5])  # Column first.


def test_world_points_are_those_of_the_formula() -> None:
    points = plain().world_points(np.full((6, 8), 2.0, np.float32))
    np.testing.assert_allclose(points[0, 0], [(0.5 - 4) / 4 * 2, (0.5 - 3) / 5 * 2, 2])
    np.testing.assert_allclose(points[5, 7], [(7.5 - 4) / 4 * 2, (5.5 - 3) / 5 * 2, 2])


def test_depth_is_measured_along_the_axis_and_not_along_the_ray() -> None:
    np.testing.assert_allclose(plain().world_points(np.full((6, 8), 3.0, np.float32))[..., 2], 3.0)


def test_no_return_stays_no_return() -> None:
    depth = np.full((6, 8), 2.0, np.float32)
    depth[1, 3] = np.nan
    points = plain().world_points(depth)
    assert np.isnan(points[1, 3]).all()
    assert np.isnan(points).any(axis=-1).sum() == 1


def test_a_point_behind_the_camera_has_no_picture_position() -> None:
    column_row, depth = plain().pixel_from_world(np.array([[0.0, 0.0, -1.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    assert np.isnan(column_row[:2]).all()
    np.testing.assert_array_equal(column_row[2], [4.0, 3.0])
    np.testing.assert_array_equal(depth, [-1.0, 0.0, 1.0])


def test_the_picture_contains_its_border_above_and_not_below() -> None:
    inside = plain().contains(np.array([[0.0, 0.0], [7.99, 5.99], [8.0, 1.0], [1.0, 6.0], [-0.01, 1.0], [np.nan, 1.0]]))
    np.testing.assert_array_equal(inside, [True, True, False, False, False, False])


@given(places, places.filter(lambda step: np.hypot(step[0], step[1]) > 0.5))
def test_a_camera_sees_its_target_in_the_middle_and_the_worlds_up_as_up(position, away) -> None:
    target = np.add(position, away)
    camera = Camera(
        width=64, height=48, fx=50.0, fy=50.0, cx=32.0, cy=24.0, world_from_camera=looking_at(position, tuple(target))
    )
    column_row, depth = camera.pixel_from_world(target + np.array([[0, 0, 0], [0, 0, 0.01]]))
    np.testing.assert_allclose(column_row[0], [32.0, 24.0], atol=1e-6)
    assert depth[0] == pytest.approx(np.linalg.norm(away))
    assert column_row[1, 1] < 24.0  # Rows count downwards.
    assert column_row[1, 0] == pytest.approx(32.0, abs=1e-6)


@given(places, places.filter(lambda step: np.linalg.norm(step) > 0.1))
def test_a_cameras_axes_are_a_right_handed_rotation(position, away) -> None:
    matrix = looking_at(position, tuple(np.add(position, away)))
    np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-9)
    assert np.linalg.det(matrix[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_array_equal(matrix[:3, 3], position)


@pytest.mark.parametrize("height", [-3.0, 3.0])
def test_a_camera_that_looks_straight_up_or_down_has_plus_y_at_the_top(height: float) -> None:
    matrix = looking_at((0.0, 0.0, height), (0.0, 0.0, 0.0))
    np.testing.assert_allclose(matrix[:3, 1], [0.0, -1.0, 0.0], atol=1e-12)


def test_x_is_right_when_looking_along_y() -> None:
    matrix = looking_at((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    np.testing.assert_allclose(matrix[:3, :3], np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]), atol=1e-12)


@given(cameras(), st.integers(1, 900), st.integers(1, 900), st.floats(0, 1), st.floats(0, 1))
def test_another_size_sees_the_same_rays(camera: Camera, width: int, height: int, across: float, down: float) -> None:
    other = camera.resized(width, height)
    assert (other.width, other.height) == (width, height)
    one = camera.world_from_pixel(np.array([across * camera.width, down * camera.height]), np.array(3.0))
    same = other.world_from_pixel(np.array([across * width, down * height]), np.array(3.0))
    np.testing.assert_allclose(same, one, atol=1e-7)


@given(cameras(), places)
def test_a_transform_and_its_inverse_cancel(camera: Camera, place) -> None:
    there = transformed(camera.world_from_camera, np.array(place))
    np.testing.assert_allclose(transformed(np.linalg.inv(camera.world_from_camera), there), place, atol=1e-9)
    np.testing.assert_array_equal(camera.position, camera.world_from_camera[:3, 3])
