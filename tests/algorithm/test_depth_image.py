"""Depth as an image: grey, shading, smoothing, and what lies behind an edge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from worlds import depths_of, plane, small_camera, sphere

from algorithm.depth_image import (
    continued_behind,
    depth_range,
    grey_image,
    nearness_image,
    shading_image,
    smoothed_depth,
)

NAN = np.float32(np.nan)


def test_grey_reaches_from_1_to_255_over_the_whole_recording() -> None:
    depths = [np.array([[2.0, NAN]], np.float32), np.array([[5.0, 3.0]], np.float32)]
    within = depth_range(depths)
    assert within == (2.0, 5.0)
    np.testing.assert_array_equal(grey_image(depths[0], within=within), [[1, 0]])
    np.testing.assert_array_equal(grey_image(depths[1], within=within), [[255, 86]])  # 1 + 254 / 3, rounded.


def test_grey_does_not_change_with_who_enters() -> None:
    alone = np.array([[3.0, NAN]], np.float32)
    entered = np.array([[3.0, 9.0]], np.float32)
    within = depth_range([alone, entered])
    assert grey_image(alone, within=within)[0, 0] == grey_image(entered, within=within)[0, 0]


@given(st.lists(st.floats(0.125, 50, width=32), min_size=1, max_size=20))
def test_grey_is_never_empty_where_there_is_depth_and_grows_with_it(values: list[float]) -> None:
    depth = np.array([sorted(values)], np.float32)
    grey = grey_image(depth, within=depth_range([depth]))
    assert grey.dtype == np.uint8
    assert grey.min() >= 1
    assert (np.diff(grey.astype(int)) >= 0).all()


def test_what_is_near_is_bright_and_the_farthest_stands_out_from_emptiness() -> None:
    image = nearness_image(np.array([[2.0, 3.0, 4.0, NAN]], np.float32), within=(2.0, 4.0))
    np.testing.assert_array_equal(image, [[255, 166, 76, 0]])


def test_the_range_of_nothing_is_harmless() -> None:
    empty = np.full((2, 3), NAN)
    assert depth_range([empty]) == (0.0, 1.0)
    assert not grey_image(empty, within=depth_range([empty])).any()


@given(st.integers(0, 2**32))
def test_a_flat_plane_is_smoothed_into_itself(seed: int) -> None:
    depth = np.full((7, 9), 3.25, np.float32)
    depth[np.random.default_rng(seed).random(depth.shape) < 0.3] = NAN
    np.testing.assert_allclose(smoothed_depth(depth, similar_depth_m=0.1), depth, rtol=1e-6)


def test_a_sloping_plane_is_smoothed_into_itself_away_from_its_border() -> None:
    row, column = np.mgrid[:9, :11]
    depth = (2.0 + 0.01 * row - 0.02 * column).astype(np.float32)
    smooth = smoothed_depth(depth, similar_depth_m=0.2)
    np.testing.assert_allclose(smooth[2:-2, 2:-2], depth[2:-2, 2:-2], rtol=1e-6)


def test_smoothing_does_not_cross_a_depth_step() -> None:
    depth = np.full((7, 9), 2.0, np.float32)
    depth[:, 5:] = 2.5
    np.testing.assert_allclose(smoothed_depth(depth, similar_depth_m=0.1), depth, rtol=1e-6)


def test_smoothing_halves_the_noise_at_least() -> None:
    depth = (3.0 + np.random.default_rng(0).normal(0, 0.01, (40, 40))).astype(np.float32)
    smooth = smoothed_depth(depth, similar_depth_m=0.2)
    assert np.std(smooth[3:-3, 3:-3]) < 0.5 * np.std(depth)


def test_smoothing_neither_fills_nor_makes_holes() -> None:
    depth = np.full((5, 5), 2.0, np.float32)
    depth[2, 2] = NAN
    depth[0, 0] = 7.0
    np.testing.assert_array_equal(np.isnan(smoothed_depth(depth, similar_depth_m=0.1)), np.isnan(depth))
    assert smoothed_depth(depth, similar_depth_m=0.1)[0, 0] == pytest.approx(7.0)
    empty = np.full((5, 5), NAN)
    assert np.isnan(smoothed_depth(empty, similar_depth_m=0.1)).all()


def test_a_ball_is_brightest_where_it_faces_the_camera() -> None:
    camera = small_camera()
    (depth,), _ = depths_of([sphere(lambda _: (0.0, 0.0, 2.0), 0.5)], camera, 1)
    shading = shading_image(depth, camera=camera, similar_depth_m=0.1)
    assert shading[30, 40] >= 245  # 60 + 190 cos(0).
    ring = np.flatnonzero(shading[30])
    assert (np.diff(shading[30, ring[2:-2]].astype(int))[: len(ring) // 2 - 3] >= 0).all()
    assert shading[30, ring[2]] < 200
    assert (shading[np.isfinite(depth)] >= 60).all()
    assert not shading[np.isnan(depth)].any()


def test_shading_is_the_angle_to_the_ray() -> None:
    camera = small_camera()
    (depth,), _ = depths_of([plane(lambda _: 3.0)], camera, 1)
    shading = shading_image(depth, camera=camera, similar_depth_m=0.5)
    rays = camera.world_points(np.ones_like(depth))
    np.testing.assert_allclose(shading, 60 + 190 / np.linalg.norm(rays, axis=-1), atol=0.6)


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1), (2, 2)])
def test_tiny_images_are_shaded_too(shape: tuple[int, int]) -> None:
    camera = small_camera(shape[1], shape[0])
    image = shading_image(np.full(shape, 2.0, np.float32), camera=camera, similar_depth_m=0.1)
    assert image.shape == shape
    assert (image >= 60).all()


def test_a_body_goes_on_behind_what_stands_before_it() -> None:
    sensed = np.full((1, 90), 4.0, np.float32)
    sensed[0, 10:] = 2.0  # A wall, before the body.
    sensed[0, :5] = 9.0  # The background, behind it.
    depth = np.full((1, 90), NAN)
    depth[0, 5:10] = 4.0
    image = np.zeros((1, 90), np.uint8)
    image[0, 5:10] = [50, 60, 70, 80, 90]
    again = continued_behind(image, depth, sensed)
    np.testing.assert_array_equal(again[0, :10], image[0, :10])
    assert (again[0, 10:70] == 90).all()
    assert not again[0, 70:].any()


def test_nothing_goes_on_where_nothing_moves() -> None:
    image = np.zeros((3, 4), np.uint8)
    np.testing.assert_array_equal(
        continued_behind(image, np.full((3, 4), NAN), np.full((3, 4), np.float32(2.0))), image
    )
