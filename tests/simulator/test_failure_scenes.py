"""The scenes in which common fate or good continuation fail: each is what its description says, on every day."""

import functools

import numpy as np
import pytest

from recording.recording import Recording
from recording.verify import verify
from recording.visibility import holes, visibility_of
from simulator.scene import load_scene
from simulator.simulate import simulate
from simulator.stage import frame_times, walkers_centres
from simulator.variation import varied

WALKS = ("in_step", "u_turn", "swap", "stop")
SCENES = (*WALKS, "catch", "throw")
DAYS = (0, *range(1, 21), *range(1001, 1011))
BEHIND_THE_WALL_M = 1.0
"""From the middle: nobody farther is behind it."""


@functools.cache
def recorded(name: str) -> Recording:
    return simulate(name)


def centres_on(name: str, seed: int) -> list[np.ndarray]:
    return walkers_centres(varied(load_scene(name), seed))


@pytest.mark.parametrize("name", SCENES)
def test_it_passes_its_own_check_and_says_what_is_expected(name: str) -> None:
    report = verify(recorded(name))
    assert report.passes, report.text
    assert "Expected: " in load_scene(name).description


@pytest.mark.parametrize("name", WALKS)
def test_each_of_the_two_is_hidden_by_the_wall_for_a_second_or_more(name: str) -> None:
    recording = recorded(name)
    longest = {hole.objectid: hole.frames for hole in holes(visibility_of(recording)) or () if hole.frames > 9}
    assert longest.keys() == {1, 2}
    assert min(longest.values()) > recording.fps
    assert max(longest.values()) < 2.6 * recording.fps


@pytest.mark.parametrize("name", SCENES)
def test_its_days_differ(name: str) -> None:
    days = [varied(load_scene(name), seed).people for seed in DAYS]
    assert len(set(days)) == len(days)


@pytest.mark.parametrize("seed", DAYS)
def test_in_step_both_keep_the_same_distance_and_the_same_foot(seed: int) -> None:
    one, other = centres_on("in_step", seed)
    np.testing.assert_allclose(one - other, np.broadcast_to(one[0] - other[0], one.shape), atol=1e-3)
    day = varied(load_scene("in_step"), seed).people
    assert day[0].model_copy(update={"waypoints": day[1].waypoints}) == day[1]


@pytest.mark.parametrize("seed", DAYS)
def test_those_who_turn_round_come_back_on_the_side_that_they_came_from(seed: int) -> None:
    left, right = centres_on("u_turn", seed)
    assert max(left[0, 0], left[-1, 0]) < -BEHIND_THE_WALL_M < left[:, 0].max() < 0.3
    assert min(right[0, 0], right[-1, 0]) > BEHIND_THE_WALL_M > right[:, 0].min() > -0.3


@pytest.mark.parametrize("seed", DAYS)
def test_those_who_swap_are_mirror_images_of_each_other(seed: int) -> None:
    one, other = centres_on("swap", seed)
    outside = np.abs(one[:, 0]) > 1.3
    np.testing.assert_allclose(one[outside], other[outside] * [-1, 1], atol=0.02)
    np.testing.assert_allclose(one[:, 0], -other[:, 0], atol=0.02)
    assert one[0, 0] < -BEHIND_THE_WALL_M
    assert one[-1, 0] > BEHIND_THE_WALL_M


@pytest.mark.parametrize("seed", DAYS)
def test_who_stops_stands_still_behind_the_wall_and_goes_on(seed: int) -> None:
    one, other = centres_on("stop", seed)
    pace = np.linalg.norm(np.diff(one, axis=0), axis=1)
    still = one[1:][pace < 1e-6]
    assert len(still) > 10
    assert np.abs(still[:, 0]).max() < 0.4
    assert one[0, 0] < -BEHIND_THE_WALL_M < BEHIND_THE_WALL_M < one[-1, 0]
    assert np.linalg.norm(np.diff(other, axis=0), axis=1).min() > 0.03


@pytest.mark.parametrize("name", ["catch", "throw"])
def test_the_ball_is_seen_in_flight_and_comes_into_the_hand(name: str) -> None:
    recording = recorded(name)
    found = visibility_of(recording)
    ball = recording.metadata.carried[-1].object
    caught = recording.metadata.carried[-1].first
    assert 0 < caught < recording.metadata.frames - 30
    seen = found.seen[found.ids.index(ball)]
    assert (seen[caught - 8 : caught] > 20).sum() >= 6
    places = recording.truth[ball].vertices.mean(axis=1)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps[caught:].max() < 0.1
    assert steps[caught - 6 : caught - 1].min() > 0.1


def test_the_ball_is_thrown_from_where_nobody_sees_it() -> None:
    recording = recorded("catch")
    times = frame_times(load_scene("catch"))
    found = visibility_of(recording)
    ball = found.ids.index(2)
    assert (found.unoccluded[ball][times < load_scene("catch").balls[0].times[0]] == 0).all()


def test_one_pillar_hides_the_ball_in_flight_and_who_caught_it() -> None:
    hidden = {hole.objectid for hole in holes(visibility_of(recorded("catch"))) or ()}
    assert hidden == {1, 2}
