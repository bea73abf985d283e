"""Quantiles over frames leave missing returns out; a frame's shift is found where most of it stands still."""

import numpy as np
import pytest

from recording.over_time import quantile_over_time, spread_numbers, wobble_m


def test_quantiles_are_of_the_returns_alone() -> None:
    values = np.array([[[3, np.nan, 1]], [[1, np.nan, np.nan]], [[2, np.nan, np.nan]]], np.float32)
    np.testing.assert_array_equal(quantile_over_time(values, 0.5), [[2, np.nan, 1]])
    np.testing.assert_array_equal(quantile_over_time(values, 1.0), [[3, np.nan, 1]])
    assert values[0, 0, 0] == 3


def test_frames_are_spread_from_the_first_to_the_last() -> None:
    assert spread_numbers(3, 61) == [0, 1, 2]
    assert spread_numbers(101, 3) == [0, 50, 100]
    assert spread_numbers(1, 3) == [0]


def test_a_shift_is_found_beside_somebody_who_stands_before_it() -> None:
    behind = np.full((10, 10), 0.06)
    behind[:4] = -2
    behind[4] = np.nan
    assert wobble_m(behind) == pytest.approx(0.06)
    assert wobble_m(behind, least=51) == 0.0
    assert wobble_m(np.full((2, 2), np.nan)) == 0.0
