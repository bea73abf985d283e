"""Common fate: what keeps together is one segment, up to the size of a body."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as few
from hypothesis import strategies as st
from made import body, followed_of, line, person, random_paths, same_partition, trajectories_of

from algorithm.affinity import neighbour_pairs
from algorithm.continued import common_fates
from algorithm.grouping import groups, separations
from algorithm.outlines import DIRECTIONS, Intervals, reaches, size_limits, united
from algorithm.settings import Settings
from algorithm.trajectories import Trajectories

FPS = 30.0


def fates(trajectories: Trajectories) -> np.ndarray:
    """The groups under the default settings."""
    return groups(trajectories, Settings(), fps=FPS)


@pytest.mark.parametrize("count", [50, 200, 1000])
def test_a_rigid_body_is_one_with_its_companions(count: int) -> None:
    made = trajectories_of(person(0, (0, 0, 1), (0.04, 0, 0), 20, count=count))
    assert common_fates(followed_of(made), Settings()).max() == 0


def test_two_who_walk_in_step_with_a_gap_have_no_group_in_common() -> None:
    made = trajectories_of(person(0, (0, 0, 1), (0.04, 0, 0), 30) + person(0, (0.7, 0, 1), (0.04, 0, 0), 30))
    found = fates(made)
    assert not set(found[:200]) & set(found[200:])


def test_a_crowd_without_gaps_is_parted_at_the_size_of_a_body() -> None:
    made = trajectories_of(body(0, (0, 0, 1), (0.04, 0, 0), 20, half=(2.0, 0.1, 0.8), count=1500))
    found = fates(made)
    width = [
        np.ptp(made.position[(found == g)[made.trajectory] & (made.frame == 0), 0]) for g in range(found.max() + 1)
    ]
    assert found.max() + 1 > 2
    assert max(width) <= 1.25


def test_two_that_touch_and_go_different_ways_are_two_groups() -> None:
    left = body(0, (0, 0, 1), (0.04, 0, 0), 20, half=(0.1, 0.1, 0.1))
    right = body(0, (0.15, 0, 1), (0, 0.04, 0), 20, half=(0.1, 0.1, 0.1))
    assert same_partition(fates(trajectories_of(left + right)), np.repeat([0, 1], 60))


def test_a_bad_match_does_not_make_two_bodies_one() -> None:
    stranger = [(5, np.concatenate([line((0, 0, 1), (0.04, 0, 0), 8), line((0.95, 0, 1), (0.04, 0, 0), 8)]))]
    made = trajectories_of(
        person(0, (0, 0, 1), (0.04, 0, 0), 13) + person(13, (1.2, 0, 1), (0.04, 0, 0), 20) + stranger
    )
    assert len(set(fates(made)[:200]) & set(fates(made)[200:400])) == 0


def test_nothing_has_no_groups_and_one_trajectory_is_one() -> None:
    assert len(fates(trajectories_of([]))) == 0
    assert fates(trajectories_of([(3, line((0, 0, 0), (0.1, 0, 0), 5))])).tolist() == [0]


@given(seed=st.integers(0, 50))
def test_the_order_of_trajectories_does_not_matter(seed: int) -> None:
    paths = person(0, (0, 0, 1), (0.04, 0, 0), 12, count=20) + person(4, (1, 0, 1), (-0.04, 0, 0), 12, count=20)
    order = np.random.default_rng(seed).permutation(len(paths))
    shuffled = fates(trajectories_of([paths[number] for number in order]))
    assert same_partition(shuffled, fates(trajectories_of(paths))[order])


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_turned_or_mirrored_world_has_the_same_groups(mirrored: bool) -> None:
    paths = person(0, (0, 0, 1), (0.04, 0, 0), 12) + person(0, (0.8, 0.3, 1), (0.03, 0.02, 0), 12)
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    turn[0] *= -1 if mirrored else 1
    moved = [(first, path @ turn.T + (3.0, -2.0, 0.5)) for first, path in paths]
    assert same_partition(fates(trajectories_of(paths)), fates(trajectories_of(moved)))


@given(seed=st.integers(0, 200))
def test_separations_agree_with_their_definition(seed: int) -> None:
    paths = random_paths(seed, count=6)
    made = trajectories_of(paths)
    pairs = np.triu_indices(len(paths), 1)
    found = separations(made, pairs, fps=FPS, loosest_m=1e9)
    for one, other, separation in zip(*pairs, found, strict=True):
        (first, a), (start, b) = paths[one], paths[other]
        frames = range(max(first, start), min(first + len(a), start + len(b)))
        if len(frames) < 3:
            assert np.isinf(separation)
            continue
        apart = np.array([a[frame - first] - b[frame - start] for frame in frames])
        lag = min(4, len(apart) - 1)
        speed = np.linalg.norm(apart[lag:] - apart[:-lag], axis=1).max() / lag
        expected = (np.linalg.norm(apart, axis=1).max() + 0.17 * FPS * speed) * (1 + 0.17 * FPS / len(apart))
        assert separation == pytest.approx(expected)


Paths = list[tuple[int, np.ndarray]]


def outline(paths: Paths, members: frozenset, frame: int) -> np.ndarray:
    """Least and largest reach of the members seen in a frame; none is seen: no rows."""
    seen = [paths[n][1][frame - paths[n][0]] for n in members if 0 <= frame - paths[n][0] < len(paths[n][1])]
    reach = np.array(seen).reshape(-1, 3) @ DIRECTIONS.T
    return np.stack([reach.min(axis=0), reach.max(axis=0)]) if seen else np.zeros((0, len(limit())))


def limit() -> np.ndarray:
    return size_limits(widest_m=3.0, tallest_m=2.5)


def lasting(paths: Paths, members: frozenset) -> range:
    return range(min(paths[n][0] for n in members), max(paths[n][0] + len(paths[n][1]) for n in members))


def may_be_one(paths: Paths, one: frozenset, other: frozenset, size: float) -> bool:
    """Whether the union is too large once at the most, and neither strays about the other."""
    outlines = [[outline(paths, members, frame) for frame in range(40)] for members in (one, other)]
    shared = [(a, b) for a, b in zip(*outlines, strict=True) if len(a) and len(b)]
    beyond = [(np.ptp(np.concatenate(both), axis=0) > limit()).any() for both in shared]
    apart = [a.mean(axis=0) - b.mean(axis=0) for a, b in shared]
    return sum(beyond) <= 1 and (not shared or np.ptp(apart, axis=0).max() <= 1.2 * max(size, 0.15))


def naive_unions(paths: Paths, pairs: np.ndarray) -> np.ndarray:
    """The same by sets of points, for so few paths that one pair is enough for every union."""
    extent = {frozenset([number]): 0.0 for number in range(len(paths))}
    for pair in pairs.T:
        one, other = (next(members for members in extent if number in members) for number in pair)
        if one == other:
            continue
        if len(lasting(paths, one)) < len(lasting(paths, other)):
            one, other = other, one
        size = max(extent[one], extent[other])
        if may_be_one(paths, one, other, size):
            del extent[one], extent[other]
            outlines = [outline(paths, one | other, frame) for frame in lasting(paths, other)]
            extent[one | other] = max(size, *(np.ptp(both, axis=0).max() for both in outlines if len(both)))
    return np.array([next(min(members) for members in extent if n in members) for n in range(len(paths))])


@given(seed=st.integers(0, 300))
@few(max_examples=40)
def test_unions_agree_with_a_naive_implementation(seed: int) -> None:
    paths = random_paths(seed, count=7)
    made = trajectories_of(paths)
    pairs = np.random.default_rng(seed).integers(0, 7, (2, 25))
    intervals = Intervals(made.first_frame, made.length, made.first_row)
    found = united((pairs[0], pairs[1]), intervals, reaches(made.position), limit(), 1)
    assert same_partition(found, naive_unions(paths, pairs))


def test_neighbours_are_looked_for_where_something_moves() -> None:
    made = trajectories_of(person(0, (0, 0, 1), (0.04, 0, 0), 3))
    assert len(neighbour_pairs(made, neighbours=5, radius_m=0.5)[0]) > 0
