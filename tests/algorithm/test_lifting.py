"""From flow in the picture to motion in space."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithm.lifting import lifted, pixel_index, sampled_depth

NAN = np.float32(np.nan)
CLOSE = {"similar_depth_m": 0.1, "largest_step_m": 0.3}


def still(shape: tuple[int, int]) -> np.ndarray:
    return np.zeros((*shape, 2), np.float32)


@given(st.floats(-0.25, 0.25), st.floats(1, 20))
def test_a_plane_that_approaches_comes_nearer_by_its_step(step: float, depth: float) -> None:
    before = np.full((5, 6), depth, np.float32)
    flow = lifted(still((5, 6)), before, before + np.float32(step), **CLOSE)
    np.testing.assert_allclose(flow.depth, step, atol=1e-5)
    assert flow.depth.dtype == np.float32


def test_the_depth_is_read_where_the_flow_leads() -> None:
    before = np.full((4, 12), 3.0, np.float32)
    after = np.tile(np.linspace(2.9, 3.1, 12, dtype=np.float32), (4, 1))
    flow = still((4, 12))
    flow[..., 0] = 3.0
    change = lifted(flow, before, after, **CLOSE).depth
    np.testing.assert_allclose(change[:, 2:7], (after - before)[:, 5:10], atol=1e-6)  # A mean of five columns.


def test_a_miss_at_an_edge_does_not_count() -> None:
    """At the outline the flow reads the background's depth; the neighbours know better."""
    before = np.full((5, 10), 3.0, np.float32)
    after = before - np.float32(0.05)
    after[:, 9] = 8.0
    np.testing.assert_allclose(lifted(still((5, 10)), before, after, **CLOSE).depth, -0.05, atol=1e-6)


def test_the_change_is_averaged_over_the_same_surface_only() -> None:
    before = np.full((5, 10), 3.0, np.float32)
    before[:, 5:] = 5.0
    after = before + np.float32(0.1)
    after[:, 5:] = before[:, 5:] - np.float32(0.2)
    change = lifted(still((5, 10)), before, after, **CLOSE).depth
    np.testing.assert_allclose(change[:, :5], 0.1, atol=1e-6)
    np.testing.assert_allclose(change[:, 5:], -0.2, atol=1e-6)


def test_the_average_is_that_of_a_naive_loop() -> None:
    generator = np.random.default_rng(0)
    before = generator.uniform(3.0, 3.3, (7, 8)).astype(np.float32)
    before[generator.random(before.shape) < 0.2] = NAN
    after = (before + generator.uniform(-0.4, 0.4, before.shape)).astype(np.float32)
    change = lifted(still((7, 8)), before, after, **CLOSE).depth
    raw = np.where(np.abs(after - before) <= 0.3, after - before, NAN)
    for row, column in np.ndindex(7, 8):
        window = (slice(max(row - 2, 0), row + 3), slice(max(column - 2, 0), column + 3))
        similar = (np.abs(before[window] - before[row, column]) <= 0.1) & np.isfinite(raw[window])
        expected = raw[window][similar].mean() if similar.any() else NAN
        np.testing.assert_allclose(change[row, column], expected, atol=1e-6)


def test_nothing_is_known_where_nothing_returned() -> None:
    before = np.full((5, 5), 3.0, np.float32)
    before[2, 2] = NAN
    change = lifted(still((5, 5)), before, np.full((5, 5), np.float32(3.1)), **CLOSE).depth
    np.testing.assert_array_equal(np.isnan(change), np.isnan(before))
    assert np.isnan(lifted(still((5, 5)), before, np.full((5, 5), NAN), **CLOSE).depth).all()


def test_a_flow_that_leaves_the_picture_has_no_depth() -> None:
    before = np.full((3, 3), 3.0, np.float32)
    assert np.isnan(lifted(still((3, 3)) + np.float32(10), before, before, **CLOSE).depth).all()


@pytest.mark.parametrize(
    ("position", "pixel"),
    [((0.0, 0.0), (0, 0)), ((0.99, 0.5), (0, 0)), ((1.0, 0.0), (0, 1)), ((2.5, 1.5), (1, 2))],
)
def test_a_position_belongs_to_the_pixel_around_it(position: tuple[float, float], pixel: tuple[int, int]) -> None:
    row, column, inside = pixel_index(np.array([position]), (2, 3))
    assert inside.all()
    assert (row[0], column[0]) == pixel


@pytest.mark.parametrize("position", [(-0.01, 0.0), (3.0, 0.0), (0.0, 2.0), (np.nan, 0.0), (0.0, np.inf)])
def test_a_position_outside_belongs_to_none(position: tuple[float, float]) -> None:
    assert not pixel_index(np.array([position]), (2, 3))[2].any()
    assert np.isnan(sampled_depth(np.ones((2, 3), np.float32), np.array([position]))).all()


def test_depth_is_not_interpolated() -> None:
    depth = np.array([[1.0, 9.0]], np.float32)
    np.testing.assert_array_equal(sampled_depth(depth, np.array([[0.9, 0.5], [1.1, 0.5]])), [1.0, 9.0])
