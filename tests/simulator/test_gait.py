"""The plan of a walk: phase, headings and footprints."""

import numpy as np
import pytest

from simulator.gait import RATE, STRIDE_FACTOR, Walk, planned_steps, planned_walk
from simulator.path import Path, path_through

THIGH = 0.9


def walk_along(path: Path, seconds: float, phase: float = 0.0) -> Walk:
    return planned_walk(path, thigh_height=THIGH, phase=phase, begin=0.0, end=seconds)


def during(walk: Walk, first: float, last: float) -> np.ndarray:
    return (walk.time >= first) & (walk.time <= last)


@pytest.mark.parametrize("speed", [0.2, 0.7, 1.4, 2.0])
def test_a_stride_is_as_long_as_the_article_says(speed: float) -> None:
    walk = walk_along(path_through([(-9.0, 0.0), (9.0, 0.0)], speed=speed, start=-3.0), 2.0)
    steady = during(walk, 0.2, 1.8)
    stride = speed / (np.diff(walk.phase[steady]) * RATE)
    np.testing.assert_allclose(stride, STRIDE_FACTOR * np.sqrt(speed / THIGH) * THIGH, rtol=1e-3)


@pytest.mark.parametrize("phase", [0.0, 0.37, 0.9])
def test_the_first_frame_has_the_phase_asked_for(phase: float) -> None:
    walk = walk_along(path_through([(0.0, 0.0), (9.0, 0.0)], speed=1.2), 2.0, phase)
    assert np.interp(0.0, walk.time, walk.phase) == pytest.approx(phase)


def test_one_foot_at_least_is_down_and_both_are_planted_in_turn() -> None:
    walk = walk_along(path_through([(-3.0, 0.0), (9.0, 0.0)], speed=1.4, start=-2.0), 4.0)
    left, right = (planned_steps(walk, side=side, half_width=0.09).stance for side in (0, 1))
    assert (left | right).all()
    assert (left & right).any()
    assert (left & ~right).any()
    assert (right & ~left).any()


def test_a_foot_that_is_down_keeps_its_footprint_beside_the_path() -> None:
    walk = walk_along(path_through([(-3.0, 0.0), (9.0, 0.0)], speed=1.4, start=-2.0), 4.0)
    for side, beside in ((0, 0.09), (1, -0.09)):
        step = planned_steps(walk, side=side, half_width=0.09)
        down = step.stance & during(walk, 0.0, 3.0)
        np.testing.assert_allclose(step.ground[down, 1], beside, atol=1e-9)
        together = down[1:] & down[:-1]
        moved = np.linalg.norm(np.diff(step.ground, axis=0), axis=1)
        assert np.median(moved[together]) == pytest.approx(0.0, abs=1e-9)
        assert (step.lift[down] == 0).all()


def test_the_heading_is_the_direction_of_walking() -> None:
    angle = np.linspace(0.0, 3.0, 9)
    walk = walk_along(path_through(list(zip(2 * np.cos(angle), 2 * np.sin(angle), strict=True)), speed=1.0), 5.0)
    middle = during(walk, 1.0, 4.0)
    around = np.unwrap(np.arctan2(walk.place[middle, 1], walk.place[middle, 0])) + np.pi / 2
    np.testing.assert_allclose(walk.heading[middle], around, atol=0.02)


def test_who_turns_on_the_spot_steps_and_turns_smoothly() -> None:
    path = path_through([(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (0.0, 0.0)], times=[0.0, 2.0, 5.0, 7.0])
    walk = walk_along(path, 7.0)
    assert walk.heading[during(walk, 0.5, 1.5)] == pytest.approx(0.0, abs=1e-6)
    assert np.abs(walk.heading[during(walk, 5.5, 6.5)]) == pytest.approx(np.pi, abs=1e-6)
    assert np.abs(np.diff(walk.heading)).max() * RATE < 5.0  # Radians a second.
    turning = during(walk, 3.6, 5.0)
    assert np.ptp(walk.phase[turning]) > 0.5


def test_who_stops_closes_his_feet_and_then_stands_still() -> None:
    walk = walk_along(path_through([(0.0, 0.0), (2.0, 0.0)], speed=1.3), 6.0, phase=0.45)
    standing = during(walk, 4.5, 6.0)
    assert np.ptp(walk.phase[standing]) < 1e-6
    feet = [planned_steps(walk, side=side, half_width=0.09).ground[standing][0] for side in (0, 1)]
    assert abs(feet[0][0] - feet[1][0]) < 0.12
    np.testing.assert_allclose(walk.place[standing], [(2.0, 0.0)] * standing.sum(), atol=1e-3)


def test_nobody_stops_within_one_frame() -> None:
    walk = walk_along(path_through([(0.0, 0.0), (2.0, 0.0)], speed=1.3), 4.0)
    acceleration = np.diff(walk.place, n=2, axis=0) * RATE**2
    assert np.linalg.norm(acceleration[during(walk, 0.3, 3.9)[2:]], axis=1).max() < 6.0


def test_who_sways_on_the_spot_does_not_spin() -> None:
    times = np.arange(0.0, 9.0, 0.2)
    swaying = 0.02 * np.stack([np.sin(2.1 * times), np.cos(3.3 * times)], axis=-1)
    there = np.stack([1.2 * np.clip(times, 0.0, 3.0), 0 * times], axis=-1)
    path = path_through([(float(x), float(y)) for x, y in there + swaying], times=times.tolist())
    walk = walk_along(path, 8.0)
    assert np.abs(np.gradient(walk.heading, 1 / RATE)[during(walk, 0.0, 8.0)]).max() < 1.0  # Radians a second.
    assert np.abs(walk.heading[during(walk, 0.0, 8.0)]).max() < 0.5
