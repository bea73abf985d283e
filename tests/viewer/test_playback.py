"""Time in the viewer: it plays at the recording's speed, skips what nobody had time for, and goes round."""

from collections.abc import Iterator

import pytest
from by_hand import HandClock

from viewer import playback
from viewer.playback import Playback


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Iterator[HandClock]:
    """A clock whose time is everybody's."""
    clock = HandClock()
    with monkeypatch.context() as changed:
        changed.setattr(playback.time, "monotonic", lambda: clock.now)
        yield clock


@pytest.fixture
def film(clock: HandClock) -> Playback:
    """Ten frames, five a second."""
    return Playback(frames=10, fps=5.0, clock=clock)


def test_it_plays_as_many_frames_a_second_as_the_recording_has(film: Playback, clock: HandClock) -> None:
    seen: list[int] = []
    film.moved.connect(lambda: seen.append(film.frame))
    film.play(True)
    clock.pass_by(1.01)
    assert seen == [1, 2, 3, 4, 5]


def test_it_goes_round_and_faster_or_slower(film: Playback, clock: HandClock) -> None:
    film.go_to(8)
    film.play(True)
    film.set_speed(2.0)
    clock.pass_by(0.41)
    assert film.frame == 2
    film.set_speed(0.5)
    clock.pass_by(0.41)
    assert film.frame == 3


def test_frames_that_nobody_had_time_for_are_skipped(film: Playback, clock: HandClock) -> None:
    seen: list[int] = []

    def slow() -> None:
        seen.append(film.frame)
        clock.now += 0.75

    film.moved.connect(slow)
    film.play(True)
    clock.pass_by(2.0)
    assert seen == [1, 4, 8]


def test_a_step_stops_it_and_nothing_moves_after(film: Playback, clock: HandClock) -> None:
    told: list[bool] = []
    film.playing_changed.connect(lambda: told.append(film.playing))
    film.play(True)
    film.step(-1)
    clock.pass_by(3.0)
    assert film.frame == 9
    assert told == [True, False]


def test_scrubbing_while_it_plays_goes_on_from_there(film: Playback, clock: HandClock) -> None:
    film.play(True)
    film.play(True)
    clock.pass_by(0.1)
    film.go_to(5)
    clock.pass_by(0.25)
    assert film.frame == 6
