"""Crowds by social force: laws of walking, of keeping apart, and of symmetry."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recording.errors import InputError
from recording.feet import foot_sink_m, foot_slide_m
from simulator.body import load_body
from simulator.crowds import Crowds
from simulator.path import path_through
from simulator.person import walking_person
from simulator.social_force import BRAKING, QUICKEST, SPEEDING_UP, SWERVING, TURNING, social_force_walks
from simulator.walk_record import walk_record

STEP_S = 0.1
WALL = np.stack([np.arange(-1.0, 1.01, 0.2), np.zeros(11), np.full(11, 0.1)], axis=-1)


def crowd(starts: object, goals: object, speeds: object, discs: object = ()) -> Crowds:
    """One crowd."""
    return Crowds(
        starts=np.array([starts], float).reshape(1, -1, 2),
        goals=np.array([goals], float).reshape(1, -1, 2),
        speeds=np.array([speeds], float),
        discs=np.array(discs, float).reshape(1, -1, 3),
    )


def random_crowds(seed: int, *, crowds: int, people: int, discs: np.ndarray | None = None) -> Crowds:
    """People who come from the border of a square 5 m wide, 1 m apart, and go through it to another side."""
    generator = np.random.default_rng(seed)
    starts, goals = np.empty((2, crowds, people, 2))
    for own, aims in zip(starts, goals, strict=True):
        come = 0
        while come < people:
            sides = generator.choice(4, size=2, replace=False)
            own[come], end = (border(side, generator.uniform(-2.5, 2.5)) for side in sides)
            apart = np.linalg.norm(own[:come] - own[come], axis=-1).min(initial=np.inf)
            if apart > 1.0 and np.linalg.norm(end - own[come]) > 2.0:
                aims[come] = own[come] + 1.3 * (end - own[come])
                come += 1
    around = np.zeros((0, 3)) if discs is None else discs
    speeds = generator.uniform(0.9, 1.6, (crowds, people))
    return Crowds(starts=starts, goals=goals, speeds=speeds, discs=np.tile(around, (crowds, 1, 1)))


def border(side: int, along: float) -> tuple[float, float]:
    return ((-2.5, along), (2.5, along), (along, -2.5), (along, 2.5))[side]


def nearest_m(walks: np.ndarray) -> np.ndarray:
    """How near two people come in each crowd."""
    first, second = np.triu_indices(walks.shape[1], k=1)
    return np.linalg.norm(walks[:, first] - walks[:, second], axis=-1).min(axis=(1, 2))


def accelerations(walks: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.diff(walks, n=2, axis=2), axis=-1) / STEP_S**2


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), people=st.integers(2, 4))
def test_a_few_people_who_have_room_keep_the_clearance(seed: int, people: int) -> None:
    generator = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(people) + generator.uniform(-0.2, 0.2, people)) / people
    starts = 4 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    goals = -starts + generator.uniform(-1.5, 1.5, starts.shape)
    walks = social_force_walks(crowd(starts, goals, generator.uniform(0.6, 1.7, people)), seconds=6.0)
    assert nearest_m(walks)[0] >= 0.6


@pytest.mark.parametrize(("clearance_m", "share"), [(0.6, 0.95), (0.45, 0.9)])
def test_nearly_every_crowd_of_six_on_five_metres_keeps_the_clearance(clearance_m: float, share: float) -> None:
    crowds = random_crowds(5, crowds=100, people=6)
    walks = social_force_walks(crowds, seconds=6.0, clearance_m=clearance_m)
    found = nearest_m(walks)
    assert (found >= clearance_m).mean() >= share
    assert (found >= 0.35).mean() >= 0.98


def test_who_walks_alone_walks_straight_at_the_own_speed_and_on_past_the_goal() -> None:
    walks = social_force_walks(crowd([[-2, 1]], [[0, 2]], [1.3]), seconds=5.0)
    along = 1.3 * STEP_S * np.arange(51)[:, None] * np.array([2, 1]) / np.sqrt(5)
    np.testing.assert_allclose(walks[0, 0], np.array([-2, 1]) + along, atol=1e-9)


def test_what_stands_in_the_way_is_gone_round() -> None:
    for discs in ([[0.0, 0.0, 0.3]], WALL):
        around = crowd([[0, -3], [-0.3, 3]], [[0, 3], [-0.3, -3]], [1.3, 1.1], discs)
        walks = social_force_walks(around, seconds=7.0)
        beside = np.linalg.norm(walks[0, :, :, None] - around.discs[0, :, :2], axis=-1) - around.discs[0, :, 2]
        assert beside.min() >= 0.3
        assert walks[0, 0, -1, 1] > 2.5
        assert walks[0, 1, -1, 1] < -2.5


def test_two_who_meet_head_on_pass_on_the_right() -> None:
    walks = social_force_walks(crowd([[-3, 0], [3, 0]], [[3, 0], [-3, 0]], [1.3, 1.3]), seconds=5.0)
    first, second = walks[0]
    assert first[:, 1].min() < -0.3
    np.testing.assert_allclose(second, -first, atol=1e-9)
    assert nearest_m(walks)[0] >= 0.6


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), angle=st.floats(0, 6.3), mirrored=st.booleans())
def test_turning_moving_and_mirroring_the_ground_does_the_same_to_the_walks(
    seed: int, angle: float, mirrored: bool
) -> None:
    discs = np.array([[0.3, -0.4, 0.25], [-1.1, 1.0, 0.2]])
    crowds = random_crowds(seed, crowds=3, people=3, discs=discs)
    change = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    if mirrored:
        change = change @ np.diag([1.0, -1.0])
    shift = np.array([4.0, -7.0])
    changed = Crowds(
        starts=crowds.starts @ change.T + shift,
        goals=crowds.goals @ change.T + shift,
        speeds=crowds.speeds,
        discs=np.concatenate([crowds.discs[..., :2] @ change.T + shift, crowds.discs[..., 2:]], axis=-1),
    )
    walks = social_force_walks(crowds, seconds=2.0) @ change.T + shift
    np.testing.assert_allclose(social_force_walks(changed, seconds=2.0), walks, atol=1e-6)


def test_a_crowd_walks_among_others_as_it_does_alone_and_nobody_changes_nothing() -> None:
    crowds = random_crowds(2, crowds=4, people=5, discs=WALL)
    together = social_force_walks(crowds, seconds=4.0)
    more = [(0, 0), (0, 2), (0, 0)]
    for number in range(4):
        alone = Crowds(
            starts=np.pad(crowds.starts[number : number + 1], [*more[:2], (0, 0)], constant_values=np.nan),
            goals=np.pad(crowds.goals[number : number + 1], [*more[:2], (0, 0)], constant_values=np.nan),
            speeds=np.pad(crowds.speeds[number : number + 1], more[:2], constant_values=np.nan),
            discs=np.pad(crowds.discs[number : number + 1], more, constant_values=np.nan),
        )
        walks = social_force_walks(alone, seconds=4.0)
        np.testing.assert_allclose(walks[0, :5], together[number], atol=1e-9)
        assert np.isnan(walks[0, 5:]).all()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_nobody_jumps(seed: int) -> None:
    walks = social_force_walks(random_crowds(seed, crowds=4, people=8, discs=WALL), seconds=6.0)
    velocities = np.diff(walks, axis=2) / STEP_S
    assert np.linalg.norm(velocities, axis=-1).max() <= QUICKEST
    assert accelerations(walks).max() <= np.hypot(max(SPEEDING_UP, BRAKING), SWERVING)
    flow = velocities[..., 0] + 1j * velocities[..., 1]
    turned = np.abs(np.angle(flow[..., 1:] * flow[..., :-1].conj()))
    walking = np.minimum(np.abs(flow[..., 1:]), np.abs(flow[..., :-1])) > 0.05
    assert turned[walking].max() <= 1.1 * TURNING * STEP_S


def test_the_feet_of_who_walks_so_stand() -> None:
    crowds = random_crowds(11, crowds=1, people=10, discs=WALL)
    body = load_body("woman")
    for number, track in enumerate(social_force_walks(crowds, seconds=5.0)[0]):
        waypoints, times = walk_record(track, step_s=STEP_S)
        path = path_through(waypoints, times=times)
        mesh = walking_person(body, path, np.arange(140) / 30, phase=0.1 * number).mesh
        assert foot_slide_m(mesh) < 0.02
        assert foot_sink_m(mesh) < 0.02


def test_who_has_no_way_stands_and_is_passed() -> None:
    walks = social_force_walks(crowd([[0, 0.1], [-3, 0]], [[0, 0.1], [3, 0]], [1.0, 1.3]), seconds=5.0)
    np.testing.assert_array_equal(walks[0, 0], np.tile([0, 0.1], (51, 1)))
    assert walks[0, 1, -1, 0] > 2.0
    assert nearest_m(walks)[0] >= 0.6


def test_no_crowd_and_nobody_walk_nowhere() -> None:
    none = Crowds(
        starts=np.zeros((0, 3, 2)), goals=np.ones((0, 3, 2)), speeds=np.ones((0, 3)), discs=np.zeros((0, 2, 3))
    )
    assert social_force_walks(none, seconds=1.0).shape == (0, 3, 11, 2)
    assert social_force_walks(crowd([], [], [], WALL), seconds=1.0).shape == (1, 0, 11, 2)
    assert social_force_walks(crowd([[0, 0]], [[1, 0]], [1.0]), seconds=0.0).shape == (1, 1, 1, 2)


def test_the_walks_hardly_depend_on_how_often_they_are_sampled() -> None:
    crowds = random_crowds(8, crowds=2, people=4)
    rare = social_force_walks(crowds, seconds=3.0, step_s=0.15)
    often = social_force_walks(crowds, seconds=3.0, step_s=0.05)
    assert rare.shape[2] == 21
    np.testing.assert_allclose(rare, often[:, :, ::3], atol=1e-9)


@pytest.mark.parametrize(
    ("speed", "seconds", "step_s", "sentence"),
    [
        (2.6, 1.0, 0.1, r"expected speeds above 0 and up to 2\.45 m/s, got 2\.6"),
        (0.0, 1.0, 0.1, "expected speeds above 0"),
        (1.0, -1.0, 0.1, "expected 0 seconds or more"),
        (1.0, 1.0, 0.0, "in steps above 0, got 1.0 s in steps of 0.0 s"),
    ],
)
def test_what_nobody_can_walk_is_refused(speed: float, seconds: float, step_s: float, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        social_force_walks(crowd([[0, 0]], [[1, 0]], [speed]), seconds=seconds, step_s=step_s)
