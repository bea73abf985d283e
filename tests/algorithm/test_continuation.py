"""How well one segment goes on as another."""

import numpy as np
import pytest
from made import crossing, person, rows_of, trajectories_of, walker

from algorithm.continuation import Candidates, candidates
from algorithm.settings import Settings

FPS = 30.0
Paths = list[tuple[int, np.ndarray]]


def prices(paths: Paths, segment: np.ndarray | list[int], settings: Settings | None = None) -> dict:
    """The price of every candidate, by its two segments."""
    found: Candidates = candidates(rows_of(trajectories_of(paths), segment), settings or Settings(), fps=FPS)
    return dict(zip(zip(found.before.tolist(), found.after.tolist(), strict=True), found.price, strict=True))


def pair(start: tuple[float, float, float], step: tuple[float, float, float], first: int = 60) -> dict:
    """The prices of a walker seen for 40 frames from (0, 0, 0) on at 1.2 m/s, and of another seen later."""
    paths = person(0, (0, 0, 0), (0.04, 0, 0), 40, count=40) + person(first, start, step, 40, count=40)
    return prices(paths, np.repeat([0, 1], 40))


def test_who_goes_on_straight_is_cheaper_than_who_turns_or_passes_beside() -> None:
    straight = pair((2.4, 0, 0), (0.04, 0, 0))[0, 1]
    beside = pair((2.4, 1.5, 0), (0.04, 0, 0))[0, 1]
    turned = pair((2.4, 0, 0), (0, 0.04, 0))[0, 1]
    back = pair((1.6, 0, 0), (-0.04, 0, 0))[0, 1]
    assert straight < 0
    assert straight < min(beside, turned, back)


def test_another_height_makes_a_link_dearer() -> None:
    small = [(first, path * (1, 1, 0.8)) for first, path in person(60, (2.4, 0, 0), (0.04, 0, 0), 40, count=40)]
    paths = person(0, (0, 0, 0), (0.04, 0, 0), 40, count=40) + small
    assert prices(paths, np.repeat([0, 1], 40))[0, 1] > pair((2.4, 0, 0), (0.04, 0, 0))[0, 1] + 1


def test_a_longer_hole_makes_a_link_dearer() -> None:
    holes = [pair((0.04 * first, 0, 0), (0.04, 0, 0), first)[0, 1] for first in (45, 60, 90)]
    assert holes == sorted(holes)


def test_only_what_is_near_in_time_and_space_can_follow() -> None:
    settings = Settings()
    late = 40 + round(settings.longest_hole_seconds * FPS) + 1
    assert pair((0.04 * late, 0, 0), (0.04, 0, 0), late) == {}
    assert pair((30.0, 0, 0), (0.04, 0, 0)) == {}
    assert set(pair((2.4, 0, 0), (0.04, 0, 0))) == {(0, 1)}


def test_two_who_are_seen_side_by_side_are_not_one_body() -> None:
    assert pair((1.2, 0, 0), (0.04, 0, 0), first=20) == {}  # Both in full.
    assert pair((1.44 + 1.6, 0, 0), (0.04, 0, 0), first=36) == {}  # Farther apart than a body is wide.


def test_the_halves_on_both_sides_of_a_trunk_may_be_one_body() -> None:
    trunk = (1.0, 1.2)
    paths = person(0, (0, 0, 0), (0.04, 0, 0), 60, count=60)
    before = [(0, path[path[:, 0] < trunk[0]]) for _, path in paths]
    after = [(60 - int((path[:, 0] > trunk[1]).sum()), path[path[:, 0] > trunk[1]]) for _, path in paths]
    found = prices(before + after, np.repeat([0, 1], 60))
    assert set(found) == {(0, 1)}
    assert found[0, 1] < 0


def test_time_reversed_and_turned_prices_are_about_the_same() -> None:
    paths, segment = crossing()
    turned = [(120 - (first + len(path) - 1), path[::-1] @ np.diag([-1, -1, 1])) for first, path in paths]
    there, back = prices(paths, segment), prices(turned, segment)
    assert {(b, a) for a, b in there} == set(back)
    for (before, after), price in there.items():
        assert back[after, before] == pytest.approx(price, abs=0.2)


def test_permuted_segments_have_the_same_prices() -> None:
    paths, segment = crossing()
    name = np.array([2, 0, 3, 1])
    moved = prices(paths, name[segment])
    assert moved == pytest.approx({(name[a], name[b]): price for (a, b), price in prices(paths, segment).items()})


@pytest.mark.parametrize("count", [0, 1])
def test_nothing_and_one_segment_have_no_candidates(count: int) -> None:
    paths = walker((0, 0, 0), (0.04, 0, 0), ((0, 20),)) * count
    assert prices(paths, np.zeros(len(paths), int)) == {}
