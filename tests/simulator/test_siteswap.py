"""Siteswaps: which can be juggled, and that balls and hands move as they must."""

from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.siteswap import GRAVITY, IN_THE_AIR, Juggling, check_siteswap, planned_throws

SPOTS = {
    "throw_spots": np.array([[0.3, 0.1, 1.2], [0.3, -0.1, 1.2]]),
    "catch_spots": np.array([[0.3, 0.3, 1.2], [0.3, -0.3, 1.2]]),
}


@st.composite
def siteswaps(draw: st.DrawFn) -> tuple[int, ...]:
    """Any siteswap of up to six throws: where the balls land is a permutation, some cycles later."""
    landing = draw(st.permutations(range(draw(st.integers(1, 6)))))
    cycles = [draw(st.integers(int(place < beat), 2)) for beat, place in enumerate(landing)]
    pattern = [place - beat + cycles[beat] * len(landing) for beat, place in enumerate(landing)]
    return tuple(pattern) if any(pattern) else (3,)


@st.composite
def rhythms(draw: st.DrawFn) -> dict[str, Any]:
    """What makes a juggling; made in the test, for types are checked with random samples."""
    pattern = draw(siteswaps())
    beat = draw(st.floats(0.15, 0.4))
    longest = beat * min(2, *(height for height in pattern if height))
    dwell = draw(st.floats(0.3, 0.9)) * longest
    return {"pattern": pattern, "beat_s": beat, "dwell_s": dwell, "phase": draw(st.floats(0.0, 20.0))}


def cascade(balls: int, *, beat_s: float = 0.2, dwell_s: float = 0.25) -> Juggling:
    return Juggling(pattern=(balls,), beat_s=beat_s, dwell_s=dwell_s, phase=0.0, **SPOTS)


def events(juggling: Juggling) -> np.ndarray:
    """The times, in the first three seconds, at which a ball is thrown or caught."""
    beats = (np.arange(60) - juggling.phase % 1) * juggling.beat_s
    times = np.concatenate([beats, beats - juggling.dwell_s])
    return times[(times > 0.01) & (times < 3.0)]


@given(siteswaps())
def test_a_siteswap_has_as_many_balls_as_its_mean(pattern: tuple[int, ...]) -> None:
    check_siteswap(pattern)
    throws = planned_throws(pattern, 10 * len(pattern) + 30)
    assert len({throw.ball for throw in throws}) == sum(pattern) / len(pattern)
    due = [throw.beat + throw.height for throw in throws]
    assert len(set(due)) == len(due)


@pytest.mark.parametrize(
    ("pattern", "said"),
    [((5, 4, 3), "throws 1 and 2 come down together"), ((3, 2), "not 2.5"), ((0, 0), "one of 1"), ((-1, 7), "0 beats")],
)
def test_what_cannot_be_juggled_is_refused(pattern: tuple[int, ...], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        check_siteswap(pattern)


@given(rhythms())
@settings(max_examples=40, deadline=None)
def test_a_ball_in_the_air_feels_nothing_but_gravity(rhythm: dict[str, Any]) -> None:
    juggling = Juggling(**rhythm, **SPOTS)
    step = 0.002
    times = np.arange(0, 2, step)
    places, holders = juggling.ball_places(times), juggling.holders(times)
    assert np.isfinite(places).all()
    acceleration = np.diff(places, n=2, axis=1) / step**2
    flying = (holders[:, :-2] == IN_THE_AIR) & (holders[:, 1:-1] == IN_THE_AIR) & (holders[:, 2:] == IN_THE_AIR)
    np.testing.assert_allclose(acceleration[flying] - [0, 0, -GRAVITY], 0.0, atol=1e-6)


@given(rhythms())
@settings(max_examples=40, deadline=None)
def test_balls_and_hands_jump_neither_in_place_nor_in_speed(rhythm: dict[str, Any]) -> None:
    juggling = Juggling(**rhythm, **SPOTS)
    step = 1e-5
    for at in events(juggling)[::5]:
        times = at + step * np.arange(-2, 4)
        for places in (juggling.ball_places(times), juggling.hand_places(times)):
            speed = np.diff(places, axis=1) / step
            assert np.abs(np.diff(places, axis=1)).max() < 50 * step
            assert np.abs(np.diff(speed, axis=1)).max() < 0.1


@given(rhythms())
@settings(max_examples=40, deadline=None)
def test_a_held_ball_lies_in_its_hand_and_no_hand_holds_two(rhythm: dict[str, Any]) -> None:
    juggling = Juggling(**rhythm, **SPOTS)
    times = np.linspace(0, 3, 500)
    balls, hands, holders = juggling.ball_places(times), juggling.hand_places(times), juggling.holders(times)
    assert balls.shape[0] == juggling.balls
    for hand in (0, 1):
        assert (holders == hand).sum(axis=0).max() <= 1
        ball, moment = np.nonzero(holders == hand)
        np.testing.assert_array_equal(balls[ball, moment], hands[hand, moment])


@pytest.mark.parametrize("balls", [3, 5, 7])
def test_the_balls_of_a_cascade_keep_apart(balls: int) -> None:
    places = cascade(balls).ball_places(np.arange(0, 4, 0.002))
    nearest = min(np.linalg.norm(a - b, axis=-1).min() for a, b in combinations(places, 2))
    assert nearest > 0.1


def test_a_cascade_takes_turns_and_changes_hands() -> None:
    juggling = cascade(3)
    times = np.arange(0, 4, 0.01)
    for holders in juggling.holders(times):
        held = holders[holders != IN_THE_AIR]
        throws = [(one, other) for one, other in pairwise(held[np.flatnonzero(np.diff(held, prepend=-9))])]
        assert throws
        assert all(one != other for one, other in throws)


def test_a_fountain_of_even_throws_stays_in_its_hand() -> None:
    for holders in cascade(4).holders(np.arange(0, 4, 0.01)):
        assert len(np.unique(holders[holders != IN_THE_AIR])) == 1


def test_the_height_of_a_throw_is_that_of_its_flight() -> None:
    juggling = cascade(5, beat_s=0.2, dwell_s=0.26)
    top = juggling.ball_places(np.arange(0, 3, 0.001))[..., 2].max()
    assert top == pytest.approx(1.2 + GRAVITY * (5 * 0.2 - 0.26) ** 2 / 8, abs=1e-4)


def test_phase_moves_the_pattern_by_beats() -> None:
    times = np.arange(0, 1, 0.05)
    later = Juggling(pattern=(3,), beat_s=0.2, dwell_s=0.25, phase=1.5, **SPOTS)
    np.testing.assert_allclose(later.ball_places(times), cascade(3).ball_places(times + 0.3), atol=1e-9)
