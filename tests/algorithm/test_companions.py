"""Segments that go together at the same time are one body; people, and what they throw, are not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made import body, line, person, rows_of, same_partition, trajectories_of

from algorithm.companions import companions, meetings
from algorithm.settings import Settings

FPS = 30.0
HALF_A_BODY = (0.1, 0.15, 0.85)


def bodies(*parts: list[tuple[int, np.ndarray]]) -> np.ndarray:
    """The body of each part, every part a segment."""
    segment = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return companions(rows_of(trajectories_of([path for part in parts for path in part]), segment), Settings(), fps=FPS)


def test_two_halves_that_a_trunk_cuts_are_one_body() -> None:
    left = body(0, (0, 0, 1), (0.04, 0, 0), 30, half=HALF_A_BODY)
    right = body(5, (0.5, 0, 1), (0.04, 0, 0), 20, half=HALF_A_BODY)
    assert same_partition(bodies(left, right), np.array([0, 0]))


def test_two_who_walk_in_step_side_by_side_stay_two() -> None:
    one, other = (person(0, (0, y, 1), (0.04, 0, 0), 60) for y in (0.0, 0.9))
    assert same_partition(bodies(one, other), np.array([0, 1]))


def test_an_umbrella_is_of_whoever_walks_under_it() -> None:
    """Together they are slim from no side, unlike two who walk side by side they are over one another."""
    bearer = body(0, (0, 0, 0.85), (0.04, 0, 0), 30, half=(0.3, 0.3, 0.8))
    umbrella = body(0, (0.2, 0, 1.95), (0.04, 0, 0), 30, half=(0.45, 0.45, 0.1))
    assert same_partition(bodies(bearer, umbrella), np.array([0, 0]))
    beside = body(0, (0.75, 0.2, 0.85), (0.04, 0, 0), 30, half=(0.3, 0.3, 0.8))
    assert same_partition(bodies(bearer, beside), np.array([0, 1]))


def test_a_swinging_leg_is_of_its_body() -> None:
    trunk = body(0, (0, 0, 1.2), (0.04, 0, 0), 60, half=(0.2, 0.15, 0.4))
    swing = 0.25 * np.sin(2 * np.pi * np.arange(60) / 32)[:, None] * (1, 0, 0)
    leg = [(0, path + swing) for _, path in body(0, (0, 0, 0.4), (0.04, 0, 0), 60, half=(0.08, 0.08, 0.35))]
    assert same_partition(bodies(trunk, leg), np.array([0, 0]))


def test_a_thrown_ball_is_not_of_the_walker() -> None:
    walker = person(0, (0, 0, 1), (0.02, 0, 0), 30)
    time = np.arange(30)[:, None] / FPS
    flight = (0.4, 0, 1.2) + time * (0.6, 0, 4.5) - 4.905 * time**2 * (0, 0, 1)
    ball = [(0, flight + offset) for offset in np.random.default_rng(1).normal(size=(20, 3)) * 0.03]
    assert same_partition(bodies(walker, ball), np.array([0, 1]))


def test_two_who_meet_in_passing_stay_two() -> None:
    one, other = person(0, (-1, 0, 1), (0.04, 0, 0), 50), person(0, (1, 0.5, 1), (-0.04, 0, 0), 50)
    assert same_partition(bodies(one, other), np.array([0, 1]))


def test_parts_that_are_never_seen_together_stay_apart() -> None:
    assert same_partition(
        bodies(person(0, (0, 0, 1), (0.04, 0, 0), 10), person(10, (0.4, 0, 1), (0.04, 0, 0), 10)), np.array([0, 1])
    )


def test_nothing_and_one_segment() -> None:
    assert len(bodies()) == 0
    assert bodies(person(0, (0, 0, 1), (0.04, 0, 0), 10)).tolist() == [0]


@given(seed=st.integers(0, 20))
def test_the_order_of_segments_does_not_matter(seed: int) -> None:
    parts = [
        body(0, (x, y, 1), (0.04, 0, 0), 20, half=HALF_A_BODY, count=15) for x, y in ((0, 0), (0.5, 0), (2, 0), (0, 3))
    ]
    order = np.random.default_rng(seed).permutation(len(parts))
    assert same_partition(bodies(*(parts[number] for number in order)), bodies(*parts)[order])


@pytest.mark.parametrize("reach_m", [0.5, 3.0])
def test_meetings_are_the_pairs_that_are_near_in_one_frame(reach_m: float) -> None:
    generator = np.random.default_rng(4)
    paths = [(first, generator.normal(size=(8, 3))) for first in (0, 3, 5, 5, 20)]
    rows = rows_of(trajectories_of(paths), range(5))
    met = meetings(rows, reach_m=reach_m)
    found = list(zip(rows.segment[met.one], rows.segment[met.other], rows.frame[met.one], strict=True))
    expected = [
        (a, b, frame)
        for a in range(5)
        for b in range(a + 1, 5)
        for frame in range(30)
        if all(paths[n][0] <= frame < paths[n][0] + 8 for n in (a, b))
        and np.linalg.norm(paths[a][1][frame - paths[a][0]] - paths[b][1][frame - paths[b][0]]) <= reach_m
    ]
    assert found == expected
    assert [found[start][:2] for start in met.start] == sorted({pair[:2] for pair in expected})


def test_a_walker_and_his_shadow_far_behind_stay_two() -> None:
    one = person(0, (0, 0, 1), (0.04, 0, 0), 40)
    behind = [(0, path + line((0, 1.6, 0), (0, 0, 0), 40)) for _, path in one]
    assert same_partition(bodies(one, behind), np.array([0, 1]))
