"""What no link reached goes to the motion that it lies in."""

import numpy as np
import pytest
from made import body, line, person, rows_of, trajectories_of

from algorithm.settings import Settings
from algorithm.stragglers import gathered

FPS = 30.0
Paths = list[tuple[int, np.ndarray]]
STEP = (0.04, 0.0, 0.0)


def owners(*motions: Paths) -> list[int]:
    """The motion that each belongs to."""
    name = np.repeat(np.arange(len(motions)), [len(motion) for motion in motions])
    paths = [path for motion in motions for path in motion]
    return gathered(rows_of(trajectories_of(paths), name), Settings(), fps=FPS).tolist()


def walker(start: tuple[float, float, float] = (0, 0, 0)) -> Paths:
    return person(0, start, STEP, 60, count=100)


def foot(start: tuple[float, float, float], step: tuple[float, float, float] = STEP, first: int = 20) -> Paths:
    """A small thing seen for 20 frames; where it starts is where it were in frame 0."""
    return body(first, np.asarray(start) + first * np.asarray(step), step, 20, half=(0.08, 0.08, 0.06), count=8)


def test_a_foot_goes_to_the_walker_above_it() -> None:
    assert owners(walker(), foot((0.05, 0, -0.75))) == [0, 0]
    assert owners(foot((0.05, 0, -0.75)), walker()) == [1, 1]


def test_a_foot_that_swings_is_faster_than_the_body_and_of_it_all_the_same() -> None:
    """1.5 m/s faster, for a quarter of a second; for longer, or about a small host, it goes its own way."""
    step = (0.09, 0.0, 0.0)
    swing = body(20, (0.65, 0, -0.75), step, 8, half=(0.08, 0.08, 0.06), count=8)
    assert owners(walker(), swing) == [0, 0]
    small = body(0, (0, 0, -0.6), STEP, 60, half=(0.25, 0.25, 0.25), count=100)
    assert owners(small, swing) == [0, 1]


def test_of_two_walkers_the_nearer_one_gets_it() -> None:
    assert owners(walker(), walker((0.8, 0, 0)), foot((0.7, 0, -0.7))) == [0, 1, 1]


def test_a_foot_seen_while_the_body_is_hidden_goes_to_the_body() -> None:
    before, after = person(0, (0, 0, 0), STEP, 20, count=100), person(45, (1.8, 0, 0), STEP, 30, count=100)
    assert owners(before + after, foot((0, 0, -0.75), first=22)) == [0, 0]


def test_what_is_beside_or_goes_another_way_or_comes_later_stays_alone() -> None:
    assert owners(walker(), foot((0.9, 0, -0.75))) == [0, 1]
    assert owners(walker(), foot((1.6, 0, -0.75), step=(-0.04, 0, 0))) == [0, 1]
    assert owners(walker(), foot((0, 0, -0.75), first=75)) == [0, 1]


def test_a_ball_that_flies_past_the_walker_stays_alone() -> None:
    time = np.arange(20)[:, None] / FPS
    flight = (0.9, 0, -0.3) + time * (1.0, 0, 3.3) - 4.905 * time**2 * (0, 0, 1)
    ball = [(20, flight + offset) for offset in np.random.default_rng(1).normal(size=(8, 3)) * 0.03]
    assert owners(walker(), ball) == [0, 1]


def test_two_whole_people_stay_two_however_near() -> None:
    assert owners(walker(), walker((0.3, 0.2, 0))) == [0, 1]


def test_the_straggler_of_a_straggler_goes_to_the_body() -> None:
    toe = [(20, line((0.85, 0, -0.8), STEP, 20))]
    assert owners(toe, foot((0.05, 0, -0.75)), walker()) == [2, 2, 2]


@pytest.mark.parametrize("count", [0, 1])
def test_nothing_and_one_motion(count: int) -> None:
    assert owners(*[walker()] * count) == [0] * count
