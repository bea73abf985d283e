"""Optical flow: a known motion, no motion, sizes and kinds."""

from typing import get_args

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, map_coordinates, shift

from algorithm.flow import flow_b_from_a, photograph_flow_b_from_a
from algorithm.settings import PixelFlowName

METHODS = get_args(PixelFlowName)


def texture(height: int = 80, width: int = 100) -> np.ndarray:
    """A smooth random patch on an empty ground."""
    noise = gaussian_filter(np.random.default_rng(0).normal(size=(height, width)), 2.0)
    image = np.zeros((height, width))
    image[15:-15, 15:-15] = 130 + 50 * (noise / noise.std())[15:-15, 15:-15]
    return image.clip(0, 255)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("columns", "rows"), [(3, 0), (0, -2), (-2, 1)])
def test_a_texture_that_moves_is_followed(method: PixelFlowName, columns: int, rows: int) -> None:
    image = texture()
    moved = np.roll(image, (rows, columns), axis=(0, 1))
    flow = flow_b_from_a(image.astype(np.uint8), moved.astype(np.uint8), method=method)
    error = np.linalg.norm(flow - np.array([columns, rows]), axis=-1)
    assert np.median(error[20:-20, 20:-20]) < 0.1
    assert np.percentile(error[20:-20, 20:-20], 95) < 0.5


@pytest.mark.parametrize("method", METHODS)
def test_a_motion_of_part_of_a_pixel_is_followed(method: PixelFlowName) -> None:
    image = texture()
    moved = shift(image, (0.0, 0.5), order=3).clip(0, 255)
    flow = flow_b_from_a(image.astype(np.uint8), moved.astype(np.uint8), method=method)
    np.testing.assert_allclose(np.median(flow[25:-25, 25:-25], axis=(0, 1)), [0.5, 0.0], atol=0.1)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("image", [texture(), np.zeros((40, 50)), np.full((40, 50), 200.0)])
def test_no_motion_is_exactly_zero(method: PixelFlowName, image: np.ndarray) -> None:
    flow = flow_b_from_a(image.astype(np.uint8), image.astype(np.uint8), method=method)
    assert flow.shape == (*image.shape, 2)
    assert not flow.any()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (9, 1), (3, 200), (31, 33)])
def test_any_size_gives_a_finite_float32_of_its_size(method: PixelFlowName, shape: tuple[int, int]) -> None:
    generator = np.random.default_rng(1)
    one, other = generator.integers(1, 255, (2, *shape), np.uint8)
    flow = flow_b_from_a(one, other, method=method)
    assert flow.shape == (*shape, 2)
    assert flow.dtype == np.float32
    assert np.isfinite(flow).all()


@pytest.mark.parametrize("method", METHODS)
def test_who_appears_or_vanishes_does_no_harm(method: PixelFlowName) -> None:
    empty, someone = np.zeros((80, 100), np.uint8), texture().astype(np.uint8)
    for pair in ((empty, someone), (someone, empty)):
        assert np.isfinite(flow_b_from_a(*pair, method=method)).all()


@pytest.mark.parametrize("method", METHODS)
def test_far_from_everything_the_flow_is_zero(method: PixelFlowName) -> None:
    image = np.zeros((200, 220), np.uint8)
    image[20:60, 30:70] = texture()[20:60, 30:70]
    flow = flow_b_from_a(image, np.roll(image, 2, axis=1), method=method)
    assert not flow[100:].any()
    assert not flow[:, 120:].any()


def test_the_images_are_left_as_they_were() -> None:
    image = texture().astype(np.uint8)
    moved = np.roll(image, 2, axis=1)
    copies = image.copy(), moved.copy()
    flow_b_from_a(image, moved, method="dis")
    np.testing.assert_array_equal(image, copies[0])
    np.testing.assert_array_equal(moved, copies[1])


TURN = 0.05
TURNS = {
    "rotation": np.array([[np.cos(TURN), -np.sin(TURN)], [np.sin(TURN), np.cos(TURN)]]),
    "approach": 1.06 * np.eye(2),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", TURNS)
def test_a_rotation_and_an_approach_are_followed(method: PixelFlowName, kind: str) -> None:
    image = texture(96, 96)
    middle = np.array([47.5, 47.5])
    grid = np.stack(np.mgrid[:96, :96], axis=-1) - middle
    came_from = grid @ np.linalg.inv(TURNS[kind]).T + middle
    later = map_coordinates(image, np.moveaxis(came_from, -1, 0), order=1)
    truth = (grid @ TURNS[kind].T - grid)[..., ::-1]
    flow = flow_b_from_a(image.astype(np.uint8), later.astype(np.uint8), method=method)
    error = np.linalg.norm(flow - truth, axis=-1)[24:-24, 24:-24]
    assert np.median(error) < 0.25


@pytest.mark.parametrize("method", METHODS)
def test_there_and_back_are_opposite(method: PixelFlowName) -> None:
    image = texture()
    pair = image.astype(np.uint8), np.roll(image, 2, axis=1).astype(np.uint8)
    there = flow_b_from_a(*pair, method=method)
    back = flow_b_from_a(*pair[::-1], method=method)
    np.testing.assert_allclose(np.median((there + back)[25:-25, 25:-25], axis=(0, 1)), 0, atol=0.1)


@pytest.mark.parametrize("method", METHODS)
def test_a_single_pixel_has_a_finite_flow(method: PixelFlowName) -> None:
    image = np.zeros((40, 50), np.uint8)
    image[20, 20] = 200
    assert np.isfinite(flow_b_from_a(image, np.roll(image, 1, axis=1), method=method)).all()


@pytest.mark.parametrize("method", METHODS)
def test_photographs_are_followed(method: PixelFlowName) -> None:
    noise = gaussian_filter(np.random.default_rng(4).normal(size=(64, 72, 3)), (2.0, 2.0, 0.0))
    image = (128 + 40 * noise / noise.std()).clip(1, 255).astype(np.uint8)
    flow = photograph_flow_b_from_a(image, np.roll(image, 2, axis=1), method=method)
    np.testing.assert_allclose(np.median(flow[10:-10, 10:-10], axis=(0, 1)), [2, 0], atol=0.1)
