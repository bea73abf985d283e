"""Parts of free falls."""

import numpy as np
import pytest

from algorithm.flights import flights
from recording.motions import Link
from tests.algorithm.made import person, rows_of, trajectories_of

_FPS = 30.0


def _fall(velocity: tuple[float, float, float], first: int, stop: int, *, begin: float = 0.0) -> list:
    """A ball's points from frame `first` to before `stop`, of a throw from the origin shifted along y."""
    time = np.arange(first, stop)[:, None] / _FPS
    places = [0.0, begin, 1.5] + np.array(velocity) * time + [0.0, 0.0, -9.81 / 2] * time**2
    offsets = np.random.default_rng(2).uniform(-0.1, 0.1, (20, 3))
    return [(first, places + offset) for offset in offsets]


def _links(parts: list, links: tuple[Link, ...] = ()) -> set[tuple[int, int]]:
    segment = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    rows = rows_of(trajectories_of([path for part in parts for path in part]), segment)
    return {(link.before, link.after) for link in flights(rows, links, fps=_FPS)}


def test_two_parts_of_a_free_fall_are_one_flight() -> None:
    velocity = (5.0, 0.0, 3.0)
    assert _links([_fall(velocity, 0, 8), _fall(velocity, 14, 19)]) == {(0, 1)}


def test_three_parts_are_a_chain() -> None:
    velocity = (5.0, 0.0, 3.0)
    assert _links([_fall(velocity, 0, 8), _fall(velocity, 20, 26), _fall(velocity, 12, 16)]) == {(0, 2), (2, 1)}


def test_crossing_flights_go_on_as_themselves() -> None:
    ahead, back = (4.0, 0.0, 2.0), (-4.0, 0.0, 2.5)
    assert _links([_fall(ahead, 0, 6), _fall(back, 0, 6), _fall(back, 10, 16), _fall(ahead, 10, 16)]) == {
        (0, 3),
        (1, 2),
    }


def test_what_comes_back_in_another_way_is_another_flight() -> None:
    assert _links([_fall((5.0, 0.0, 3.0), 0, 8), _fall((5.0, 1.5, 3.0), 14, 19)]) == set()


def test_people_do_not_fly() -> None:
    step = (5.0 / _FPS, 0.0, 0.0)
    assert _links([person(0, (0.0, 0.0, 0.0), step, 8), person(14, (14 * step[0], 0.0, 0.0), step, 8)]) == set()


def test_what_is_linked_already_stays_so() -> None:
    velocity = (5.0, 0.0, 3.0)
    parts = [_fall(velocity, 0, 8), _fall(velocity, 14, 19), _fall(velocity, 14, 19, begin=1.0)]
    assert _links(parts, (Link(before=0, after=2, confidence=0.9),)) == set()


@pytest.mark.parametrize("parts", [[], [_fall((5.0, 0.0, 3.0), 0, 8)]])
def test_fewer_than_two_are_no_flight(parts: list) -> None:
    assert _links(parts) == set()


def test_what_lies_in_a_hand_before_it_is_thrown_flies_all_the_same() -> None:
    rest = [(0, np.repeat(path[:1], 30, axis=0)) for _, path in _fall((0.5, 0.0, 4.0), 0, 1)]
    thrown = [
        (0, np.concatenate([still, path]))
        for (_, still), (_, path) in zip(rest, _fall((0.5, 0.0, 4.0), 1, 8), strict=True)
    ]
    later = [(30 + first, path) for first, path in _fall((0.5, 0.0, 4.0), 9, 15)]
    assert _links([thrown, later]) == {(0, 1)}


def test_a_ball_near_its_top_is_slow_but_falls() -> None:
    velocity = (0.5, 0.0, 2.0)
    assert _links([_fall(velocity, 0, 5), _fall(velocity, 7, 12)]) == {(0, 1)}


def test_what_floats_slowly_on_does_not_fly() -> None:
    step = np.array([0.5, 0.0, 0.3]) / _FPS
    offsets = np.random.default_rng(2).uniform(-0.1, 0.1, (20, 3))
    parts = [[(first, offset + np.arange(first, first + 6)[:, None] * step) for offset in offsets] for first in (0, 8)]
    assert _links(parts) == set()
