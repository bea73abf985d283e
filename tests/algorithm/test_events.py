"""What is caught and thrown, by hand."""

from collections.abc import Sequence

import numpy as np
import pytest

from algorithm.continued import common_fates, continued
from algorithm.events import Clock, events_between, things
from algorithm.settings import Settings
from recording.motions import Event
from tests.algorithm.made import body, followed_of, line, person, trajectories_of

_FRAMES, _CATCH = 80, 40
_WALK, _THROW = np.array([0.04, 0.0, 0.0]), np.array([-0.16, 0.0, 0.05])
_IN_HAND = np.array([0.35, 0.0, 0.2])
"""Of the ball's centre from the walker's."""
_START = np.array([-1.6, 0.0, 0.0])
Paths = list[tuple[int, np.ndarray]]


def _walker() -> Paths:
    return person(0, _START, _WALK, _FRAMES)


def _ball(first: int, places: np.ndarray, *, count: int = 30) -> Paths:
    offsets = np.random.default_rng(1).uniform(-0.08, 0.08, (count, 3))
    return [(first, places + offset) for offset in offsets]


def _flight(frames: int = 16) -> np.ndarray:
    """Where the ball flies before it is caught."""
    goal = _START + _CATCH * _WALK + _IN_HAND
    return goal + np.arange(-frames, 0)[:, None] * _THROW


def _carried() -> np.ndarray:
    return line(_START + _CATCH * _WALK + _IN_HAND, _WALK, _FRAMES - _CATCH)


def _events(motions: Sequence[Paths], *, frames: int = _FRAMES) -> tuple[Event, ...]:
    paths = [path for motion in motions for path in motion]
    motion = np.repeat(np.arange(len(motions)), [len(each) for each in motions])
    return events_between(things(trajectories_of(paths), motion), Clock(fps=30.0, frames=frames))


def _reversed(motions: Sequence[Paths]) -> list[Paths]:
    return [[(_FRAMES - first - len(path), path[::-1]) for first, path in each] for each in motions]


def _caught() -> list[Paths]:
    """A ball that flies, and is a part of the walker from then on."""
    return [_walker() + _ball(_CATCH, _carried()), _ball(_CATCH - 16, _flight())]


def test_a_ball_that_is_caught_merges_with_the_catcher() -> None:
    assert _events(_caught()) == (Event(kind="merge", frame=_CATCH, motions=(1, 0)),)


def test_a_ball_that_is_thrown_splits_from_the_thrower() -> None:
    assert _events(_reversed(_caught())) == (Event(kind="split", frame=_FRAMES - _CATCH, motions=(1, 0)),)


def test_a_ball_that_stays_a_motion_of_its_own_in_the_hand_merges_as_well() -> None:
    ball = _ball(_CATCH - 16, np.concatenate([_flight(), _carried()]))
    (event,) = _events([_walker(), ball])
    assert event.kind == "merge"
    assert set(event.motions) == {0, 1}
    assert abs(event.frame - _CATCH) <= 3


def test_a_ball_that_is_caught_and_thrown_again_merges_and_splits() -> None:
    carried = _carried()[:20]
    thrown = carried[-1] + np.arange(1, 17)[:, None] * -_THROW
    ball = _ball(_CATCH - 16, np.concatenate([_flight(), carried, thrown]))
    merge, split = _events([_walker(), ball])
    assert (merge.kind, split.kind) == ("merge", "split")
    assert abs(merge.frame - _CATCH) <= 3
    assert abs(split.frame - _CATCH - 20) <= 3


def test_a_ball_that_flies_past_in_front_makes_no_event() -> None:
    middle = _START + _CATCH * _WALK + [0.0, -0.3, 0.2]
    flight = middle + np.arange(-16, 16)[:, None] * _THROW
    assert _events([_walker(), _ball(_CATCH - 16, flight)]) == ()


def test_a_ball_that_flies_past_behind_makes_no_event() -> None:
    middle = _START + _CATCH * _WALK + [0.0, 0.7, 0.2]
    flight = middle + np.arange(-16, 16)[:, None] * _THROW
    seen = [(_CATCH - 16, flight[:13]), (_CATCH + 3, flight[19:])]
    assert _events([_walker(), [path for first, part in seen for path in _ball(first, part)]]) == ()


def test_somebody_who_vanishes_behind_somebody_else_makes_no_event() -> None:
    other = person(0, [1.0, 0.5, 0.0], [-0.04, 0.0, 0.0], 30)
    assert _events([_walker(), other]) == ()


def test_a_limb_that_is_a_motion_of_its_own_makes_no_event() -> None:
    hand = body(20, _START + 20 * _WALK + _IN_HAND, _WALK, 25, half=(0.1, 0.1, 0.1))
    assert _events([_walker(), hand]) == ()


def test_what_leaves_the_recording_in_a_hand_is_not_caught_at_its_end() -> None:
    caught = [[(first, path[: _CATCH - first]) for first, path in each if first < _CATCH] for each in _caught()]
    assert _events(caught, frames=_CATCH) == ()


@pytest.mark.parametrize("motions", [[], [_walker()], [_ball(0, _carried())]])
def test_fewer_than_two_make_no_event(motions: list[Paths]) -> None:
    assert _events(motions) == ()


def test_the_order_of_motions_changes_their_numbers_only() -> None:
    assert _events(_caught()[::-1]) == (Event(kind="merge", frame=_CATCH, motions=(0, 1)),)


def test_from_points_to_events_the_ball_is_a_motion_that_merges() -> None:
    walker, ball = _caught()
    followed = followed_of(trajectories_of(walker + ball))
    settings = Settings()
    solution = continued(followed, common_fates(followed, settings), settings, None)
    (event,) = solution.events
    assert (event.kind, event.frame) == ("merge", _CATCH)
    small, large = event.motions
    assert solution.motions[small].members.sum() == 30
    assert solution.motions[large].members.sum() == 230
