"""Paths over the ground."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recording.errors import InputError
from simulator.path import path_through

CORNER = [(0.0, 0.0), (2.0, 0.0), (3.0, 1.5), (3.0, 4.0)]


def test_a_straight_line_stays_straight_and_is_walked_evenly() -> None:
    path = path_through([(-1.0, 2.0), (3.0, 2.0)], speed=1.25)
    places = path.positions(np.linspace(0.0, 3.2, 33))
    np.testing.assert_allclose(places[:, 1], 2.0, atol=1e-12)
    np.testing.assert_allclose(np.diff(places[:, 0]), 0.125, atol=1e-9)


@given(st.floats(0.1, 2.5), st.floats(-3.0, 3.0))
def test_a_curve_is_walked_at_its_speed(speed: float, start: float) -> None:
    path = path_through(CORNER, speed=speed, start=start)
    step = 0.01 * (path.end - path.begin)
    places = path.positions(np.arange(path.begin, path.end, step))
    np.testing.assert_allclose(np.linalg.norm(np.diff(places, axis=0), axis=1) / step, speed, rtol=0.01)
    assert path.begin == start


def test_each_way_point_is_passed_at_its_time() -> None:
    times = [1.0, 2.5, 4.0, 7.0]
    path = path_through(CORNER, times=times, start=0.5)
    np.testing.assert_allclose(path.positions(np.array(times) + 0.5), CORNER, atol=1e-9)


def test_before_and_after_somebody_stands_at_the_ends() -> None:
    path = path_through(CORNER, speed=1.0, start=2.0)
    np.testing.assert_allclose(path.positions(np.array([-5.0, 2.0])), [CORNER[0]] * 2, atol=1e-9)
    np.testing.assert_allclose(path.positions(np.array([path.end, 99.0])), [CORNER[-1]] * 2, atol=1e-9)


def test_a_repeated_way_point_is_a_stop_without_swinging_back() -> None:
    path = path_through([(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (4.0, 0.0)], times=[0.0, 2.0, 3.5, 5.5])
    np.testing.assert_allclose(path.positions(np.linspace(2.0, 3.5, 20)), [(2.0, 0.0)] * 20, atol=1e-9)
    assert (np.diff(path.positions(np.linspace(0.0, 5.5, 200))[:, 0]) >= -1e-12).all()


def test_a_stop_may_come_first_or_last() -> None:
    path = path_through([(1.0, 0.0), (1.0, 0.0), (3.0, 0.0), (3.0, 0.0)], times=[0.0, 1.0, 3.0, 4.0])
    np.testing.assert_allclose(path.positions(np.array([0.5, 3.5])), [(1.0, 0.0), (3.0, 0.0)], atol=1e-9)


@pytest.mark.parametrize("begin", [0.0, 0.3281, 0.5])
def test_the_last_place_is_reached_whatever_the_rounding_of_the_times(begin: float) -> None:
    path = path_through([(0.0, 0.0), (9.0, 0.0)], times=[begin, round(begin + 9.45, 4)])
    assert (np.diff(path.places[:, 0]) > 0).all()
    assert path.places[-1].tolist() == [9.0, 0.0]


@pytest.mark.parametrize(
    ("waypoints", "given", "said"),
    [
        ([(0.0, 0.0)], {"speed": 1.0}, "two way-points"),
        (CORNER, {}, "either a speed or times"),
        (CORNER, {"speed": 1.0, "times": [0.0, 1.0, 2.0, 3.0]}, "either a speed or times"),
        (CORNER, {"speed": 0.0}, "speed above 0"),
        (CORNER, {"speed": 2.6}, "up to 2.5"),
        (CORNER, {"times": [0.0, 1.0, 2.0]}, "a time for each of the 4"),
        (CORNER, {"times": [0.0, 1.0, 1.0, 2.0]}, "times that grow"),
        ([(0.0, 0.0), (0.0, 0.0)], {"speed": 1.0}, "to wait, give times"),
    ],
)
def test_an_impossible_path_is_said_to_be_so(
    waypoints: list[tuple[float, float]], given: dict[str, object], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        path_through(waypoints, **given)
