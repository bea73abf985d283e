"""Sampled tracks as way-points and times, and back by the path through them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.path import path_through
from simulator.things import Person
from simulator.walk_record import KNOT_S, walk_record


def curve(time: np.ndarray, pace: float) -> np.ndarray:
    """A winding walk, metres."""
    return np.stack([pace * time, 0.5 * np.sin(1.3 * time)], axis=-1)


@settings(deadline=None)
@given(
    step_s=st.sampled_from([1 / 60, 0.04, 0.1, 0.15]),
    begin_s=st.floats(-3, 3),
    pace=st.floats(0.2, 1.6),
    samples=st.integers(8, 80),
)
def test_the_path_passes_every_sample(step_s: float, begin_s: float, pace: float, samples: int) -> None:
    time = step_s * np.arange(samples)
    waypoints, times = walk_record(curve(time, pace), step_s=step_s, begin_s=begin_s)
    passed = path_through(waypoints, times=times).positions(begin_s + time)
    assert np.linalg.norm(passed - curve(time, pace), axis=1).max() < 0.02


def test_knots_are_evenly_spaced_rounded_and_make_a_person() -> None:
    waypoints, times = walk_record(curve(np.arange(0, 4.01, 0.1), 1.2), step_s=0.1, begin_s=1.0)
    assert (times[0], times[-1]) == (1.0, 5.0)
    assert np.diff(times) == pytest.approx(KNOT_S)
    assert all(round(value, 4) == value for place in waypoints for value in place)
    assert Person(body="man", waypoints=waypoints, times=times).waypoints == waypoints


def test_two_samples_are_a_walk() -> None:
    assert walk_record(np.array([[0.0, 0.0], [0.1, 0.0]]), step_s=0.1) == (((0.0, 0.0), (0.1, 0.0)), (0.0, 0.1))


def test_who_stops_stands_still() -> None:
    time = np.arange(0, 6.01, 0.1)
    walked = 1.2 * np.clip(time, 0, 2) + np.clip(time - 4, 0, None)
    waypoints, times = walk_record(np.stack([walked, 0 * walked], axis=-1), step_s=0.1)
    path = path_through(waypoints, times=times)
    standing = path.positions(np.linspace(2.2, 3.8, 50))
    assert np.ptp(standing, axis=0).max() == 0
    assert np.linalg.norm(path.positions(time)[:, 0] - walked, ord=np.inf) < 0.06  # A sudden stop takes a knot.
