"""The links that together are likeliest."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import crossing, followed_of, person, rows_of, trajectories_of, walker

from algorithm.continuation import Candidates
from algorithm.continued import links_between
from algorithm.linking import Links, Standing, confidences, is_scrap, linked, standings
from algorithm.settings import Settings

FPS = 30.0


def links(paths: list[tuple[int, np.ndarray]], segment: np.ndarray) -> set[tuple[int, int]]:
    """The links made of segments seen by a camera at (0, -6, 0) that looks along y."""
    made = trajectories_of(paths)
    chosen, _ = links_between(rows_of(made, segment), followed_of(made), Settings())
    return {(link.before, link.after) for link in chosen}


def test_two_who_cross_behind_a_wall_go_on_as_themselves() -> None:
    assert links(*crossing()) == {(0, 1), (2, 3)}


@pytest.mark.parametrize("turn", [0.0, 0.9, np.pi])
@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_a_turned_or_mirrored_world_has_the_same_links(turn: float, mirror: float) -> None:
    paths, segment = crossing()
    cos, sin = np.cos(turn), np.sin(turn)
    about_the_vertical = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]) * (mirror, 1, 1)
    assert links([(first, path @ about_the_vertical.T) for first, path in paths], segment) == {(0, 1), (2, 3)}


def test_time_reversed_the_links_are_the_same() -> None:
    paths, segment = crossing()
    turned = [(120 - (first + len(path) - 1), path[::-1]) for first, path in paths]
    assert links(turned, segment) == {(1, 0), (3, 2)}


@given(seed=st.integers(0, 23))
@settings(max_examples=6)
def test_the_order_of_segments_does_not_matter(seed: int) -> None:
    paths, segment = crossing()
    name = np.random.default_rng(seed).permutation(4)
    assert links(paths, name[segment]) == {(name[0], name[1]), (name[2], name[3])}


def test_nobody_is_linked_to_a_scrap() -> None:
    whole = walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 40), (80, 121)))
    scrap = walker((-2.4, 0, 0), (0.04, 0, 0), ((45, 60),), count=2)
    assert links(whole + scrap, np.repeat([0, 1, 2], [40, 40, 2])) == {(0, 1)}


def test_who_leaves_and_who_enters_at_the_border_stay_alone() -> None:
    leaving = person(0, (2.4, 0, 0), (0.05, 0, 0), 45, count=40)
    entering = person(75, (5.5, 1.2, 0), (-0.05, 0, 0), 45, count=40)
    assert links(leaving + entering, np.repeat([0, 1], 40)) == set()


@pytest.mark.parametrize("count", [0, 1])
def test_nothing_and_one_segment_have_no_links(count: int) -> None:
    paths = person(0, (0, 0, 0), (0.04, 0, 0), 20) * count
    assert links(paths, np.zeros(len(paths), int)) == set()


def test_ends_are_cheap_at_the_border_and_at_the_recordings_ends() -> None:
    through = walker((-4.7, 0, 0), (0.08, 0, 0), ((20, 40), (60, 118)))  # Appears and vanishes, then leaves.
    early = walker((0, 2, 0), (0.01, 0, 0), ((0, 60),))
    made = trajectories_of(through + early)
    known = followed_of(made)
    rows = rows_of(made, np.repeat([0, 1, 2], 40))
    standing = standings(rows, known.camera, Settings(), frames=200, fps=FPS)
    dear, cheap = standing.begin[0], standing.begin[2]
    assert dear > cheap > 0
    assert standing.begin.tolist() == [dear, dear, cheap]
    assert standing.end.tolist() == [dear, cheap, dear]
    assert (standing.weight == 1).all()


def test_what_shows_little_is_a_scrap_only_beside_what_shows_much() -> None:
    much = person(0, (0, 0, 0), (0.04, 0, 0), 90, count=200)
    little = person(30, (1.2, 0.3, 0), (0.04, 0, 0), 9, count=10)
    few = person(0, (3, 3, 0), (0.04, 0, 0), 30, count=2)
    beside = rows_of(trajectories_of(much + little + few), np.repeat([0, 1, 2], [200, 10, 2]))
    assert is_scrap(beside, Settings()).tolist() == [False, True, True]
    assert is_scrap(rows_of(trajectories_of(little), [0] * 10), Settings()).tolist() == [False]


def random_prices(seed: int) -> tuple[Candidates, Standing, np.ndarray]:
    """Candidates among five segments, and the gain of each link."""
    generator = np.random.default_rng(seed)
    before, after = np.nonzero(generator.uniform(size=(5, 5)) < 0.3)
    price = generator.normal(0, 4, len(before))
    begin, end, weight = generator.uniform(0, 3, (3, 5))
    standing = Standing(begin=begin, end=end, weight=weight / 3)
    gain = price - np.minimum(weight[before], weight[after]) / 3 * (end[before] + begin[after])
    calm = np.ones(len(before))
    return Candidates(before=before, after=after, price=price, restlessness=calm), standing, gain


def is_assignment(links: Links, chosen: np.ndarray) -> bool:
    return all(len(set(ends[chosen])) == chosen.sum() for ends in (links.before, links.after))


@given(seed=st.integers(0, 10_000))
@settings(max_examples=50)
def test_no_other_assignment_is_cheaper(seed: int) -> None:
    possible, standing, gain = random_prices(seed)
    found = linked(possible, standing)
    assert is_assignment(found, found.chosen)
    every = (np.array(some, bool) for some in product([False, True], repeat=min(len(gain), 10)))
    rest = np.zeros(max(len(gain) - 10, 0), bool)
    for chosen in every:
        other = np.concatenate([chosen, rest])
        if is_assignment(found, other):
            assert gain[found.chosen].sum() <= gain[other].sum() + 1e-9


@given(seed=st.integers(0, 10_000))
@settings(max_examples=50)
def test_margins_agree_with_their_definition(seed: int) -> None:
    possible, standing, gain = random_prices(seed)
    found = linked(possible, standing)
    rivals = (found.before[:, None] == found.before) | (found.after[:, None] == found.after)
    rivals &= found.chosen & ~np.eye(len(gain), dtype=bool)
    rise = gain - rivals @ gain  # Of taking a link and dropping its rivals.
    for link in np.flatnonzero(rivals.sum(axis=1) == 2):  # Whom they leave alone may find each other.
        crossing = (found.before == found.before[rivals[link] & (found.after == found.after[link])]) & (
            found.after == found.after[rivals[link] & (found.before == found.before[link])]
        )
        rise[link] += min(0.0, gain[crossing].sum())
    for link, chosen in enumerate(found.chosen):
        exchanges = rise[~found.chosen & rivals[:, link]]
        expected = min([-gain[link], *exchanges]) if chosen else -rise[link]
        assert found.margin[link] == pytest.approx(expected)
    assert (found.margin[found.chosen] >= 0).all()
    assert (found.margin[~found.chosen] <= 1e-9).all()


def test_two_who_may_have_changed_places_are_doubtful() -> None:
    before, after = np.array([0, 0, 1, 1]), np.array([2, 3, 2, 3])
    possible = Candidates(before=before, after=after, price=np.array([0.0, 0.2, 0.1, 0.0]), restlessness=np.ones(4))
    lonely = Standing(begin=np.full(4, 6.0), end=np.full(4, 6.0), weight=np.ones(4))
    found = linked(possible, lonely)
    assert found.chosen.tolist() == [True, False, False, True]
    assert found.margin == pytest.approx([0.3, -0.3, -0.3, 0.3])


def test_what_is_surprising_is_doubtful() -> None:
    none = np.zeros(3, int)
    price = np.array([-3.0, 2.0, 6.0])
    known = Links(
        before=none,
        after=none,
        chosen=np.ones(3, bool),
        margin=np.full(3, 4.0),
        restlessness=np.ones(3),
        price=price,
    )
    straight, usual, turned = confidences(known)
    assert straight == usual > 0.9 > turned


def test_confidence_rises_with_the_margin() -> None:
    margin = np.array([-1e4, -5.0, 0.0, 5.0, 1e4])
    none = np.zeros(5, int)
    sure = confidences(
        Links(
            before=none,
            after=none,
            chosen=margin > 0,
            margin=margin,
            restlessness=np.ones(len(margin)),
            price=np.zeros(len(margin)),
        )
    )
    assert (np.diff(sure) > 0).all()
    assert 0 <= sure[0] < 0.01
    assert 0.99 < sure[-1] <= 1
