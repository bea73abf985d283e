"""The noise of surfaces: none on smooth ones, what was added on others, whatever their slope."""

import numpy as np
import pytest

from algorithm.noise import surface_noise_m


def slope(scale: float = 0.01) -> np.ndarray:
    row, column = np.mgrid[:60, :80]
    return (3 + scale * row + 0.5 * scale * column).astype(np.float32)


def test_a_smooth_surface_has_no_noise() -> None:
    assert surface_noise_m([slope()] * 3) < 1e-5


@pytest.mark.parametrize("sigma", [0.002, 0.02, 0.04])
def test_the_noise_is_what_was_added(sigma: float) -> None:
    generator = np.random.default_rng(0)
    depths = [(slope() + generator.normal(scale=sigma, size=(60, 80))).astype(np.float32) for _ in range(20)]
    assert surface_noise_m(depths) == pytest.approx(sigma, rel=0.05)


def test_rounded_noise_is_noise_too() -> None:
    generator = np.random.default_rng(1)
    depths = [np.round((slope(0) + generator.normal(scale=0.03, size=(60, 80))) / 0.1) * 0.1 for _ in range(5)]
    assert surface_noise_m([depth.astype(np.float32) for depth in depths]) > 0.01


def test_edges_between_surfaces_are_none() -> None:
    depth = slope()
    depth[:, 40:] += 2.0
    assert surface_noise_m([depth]) < 1e-5


@pytest.mark.parametrize("shape", [(1, 1), (4, 4), (3, 9)])
def test_without_a_surface_there_is_none(shape: tuple[int, int]) -> None:
    assert surface_noise_m([np.full(shape, np.nan, np.float32)]) == 0.0
