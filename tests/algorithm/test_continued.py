"""Segmentation, links and completion of the default, as a whole."""

import numpy as np
import pytest
from made import crossing, followed_of, line, person, same_partition, trajectories_of, walker

from algorithm.continued import common_fates, continued
from algorithm.result import Solution
from algorithm.settings import Settings
from recording.motions import OBSERVED

SETTINGS = Settings()


def solved(paths: list[tuple[int, np.ndarray]], segment: np.ndarray) -> Solution:
    return continued(followed_of(trajectories_of(paths)), segment, SETTINGS, None)


def motion_of(solution: Solution) -> np.ndarray:
    """The motion of every trajectory, -1 for noise."""
    motion = np.full(solution.trajectories.count, -1)
    for number, found in enumerate(solution.motions):
        motion[found.members] = number
    return motion


def test_two_who_look_alike_and_cross_behind_a_wall_are_two_motions() -> None:
    solution = solved(*crossing())
    assert same_partition(motion_of(solution), np.repeat([0, 1], 80))
    assert {(link.before, link.after) for link in solution.links} == {(0, 1), (2, 3)}
    assert [motion.segments for motion in solution.motions] == [(0, 1), (2, 3)]
    for motion, way in zip(
        solution.motions, (line((-2.4, 0, 0), (0.04, 0, 0), 121), line((2.4, 0.8, 0), (-0.04, 0, 0), 121)), strict=True
    ):
        assert (motion.curve.first, motion.curve.last) == (0, 120)
        assert motion.curve.observed.tolist() == [True] * 40 + [False] * 40 + [True] * 41
        beside = motion.curve.position - way
        np.testing.assert_allclose(beside, np.broadcast_to(beside[0], beside.shape), atol=0.02)


def test_every_point_is_completed_through_the_hole() -> None:
    paths, segment = crossing()
    truth = {number: path for number, (_, path) in enumerate(walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 121),)))}
    completion = solved(paths, segment).motions[0].completion
    for frame in range(40, 80):
        now = completion.frame == frame
        point = completion.trajectory[now] % 40  # Of the motion's members: those before the wall, those behind it.
        assert set(point) == set(range(40))
        expected = np.array([truth[number][frame] for number in point])
        assert np.linalg.norm(completion.position[now] - expected, axis=1).max() < 0.05
    assert (completion.source != OBSERVED).all()


def test_a_chain_of_three_segments_is_one_motion() -> None:
    paths = walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 30), (55, 75), (95, 121)))
    solution = solved(paths, np.repeat([2, 0, 1], 40))
    assert [motion.segments for motion in solution.motions] == [(0, 1, 2)]
    assert {(link.before, link.after) for link in solution.links} == {(2, 0), (0, 1)}


def test_a_motion_of_few_trajectories_is_noise() -> None:
    paths = walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 60),)) + walker((0, 2.5, 0), (-0.04, 0, 0), ((0, 60),), count=5)
    assert motion_of(solved(paths, np.repeat([0, 1], [40, 5]))).tolist() == [0] * 40 + [-1] * 5


def test_given_links_take_the_place_of_found_ones() -> None:
    paths, segment = crossing()
    followed = followed_of(trajectories_of(paths))
    swapped = continued(followed, segment, SETTINGS, lambda _trajectories, _segments: [(0, 3), (2, 1)])
    assert [motion.segments for motion in swapped.motions] == [(0, 3), (1, 2)]


@pytest.mark.parametrize("count", [0, 1])
def test_nothing_and_one_segment(count: int) -> None:
    paths = person(0, (0, 0, 0), (0.04, 0, 0), 20, count=40) * count
    solution = solved(paths, np.zeros(len(paths), int))
    assert (len(solution.motions), solution.links) == (count, ())


def test_the_same_recording_has_the_same_motions() -> None:
    one, other = (solved(*crossing()) for _ in range(2))
    assert one.links == other.links
    assert one.alternatives == other.alternatives
    for motion, again in zip(one.motions, other.motions, strict=True):
        np.testing.assert_array_equal(motion.members, again.members)
        np.testing.assert_array_equal(motion.curve.position, again.curve.position)
        np.testing.assert_array_equal(motion.completion.position, again.completion.position)


def test_a_walker_a_trunk_cuts_and_another_are_found_from_their_points() -> None:
    """From trajectories to motions: the halves that a trunk cuts are one body, the other one is another."""
    trunk = (0.3, 0.5)
    cut = []
    for first, path in walker((-1.5, 0, 0), (0.03, 0, 0), ((0, 100),), count=150):
        for part in (path[:, 0] < trunk[0], path[:, 0] > trunk[1]):
            cut.append((first + int(np.argmax(part)), path[part]))
    paths = [one for one in cut if len(one[1]) > 3] + walker((2.0, 2.0, 0), (-0.03, 0, 0), ((0, 100),), count=150)
    followed = followed_of(trajectories_of(paths))
    solution = continued(followed, common_fates(followed, SETTINGS), SETTINGS, None)
    assert same_partition(motion_of(solution), np.repeat([0, 1], [len(paths) - 150, 150]))
