"""The session: what the truth says comes in the background, settings solve anew, and all of it can be taken back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from by_hand import HandClock
from passing_by import SETTINGS
from worlds import recording_of

from algorithm.settings import Settings, changed_settings
from recording.cache import Cache
from recording.motions import Making, Motions
from recording.recording import Recording
from viewer.session import PATIENCE_SECONDS, Session


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


@pytest.fixture
def session(scene: Recording, solved: Motions, clock: HandClock, own_cache: Path) -> Session:
    """A session whose motions are judged."""
    session = Session(scene, solved, clock=clock, cache=Cache(folder=own_cache))
    session.begin()
    clock.work_until(lambda: session.answer is not None and session.answer.judgement is not None)
    return session


def test_what_is_opened_is_judged_and_named_in_the_background(session: Session) -> None:
    assert session.settings == SETTINGS
    assert session.answer is session.opened
    assert session.answer is not None
    judgement = session.answer.judgement
    assert judgement is not None
    assert judgement.scores["motions"]["found"] == 1
    assert session.answer.name(0) == "0: person 1"
    assert judgement.matches[0].hidden.error_m.max() < 0.3


def test_errors_stand_at_completed_points_only_and_are_those_of_the_scores(session: Session) -> None:
    assert session.answer is not None
    assert session.answer.judgement is not None
    error, motions = session.answer.judgement.error_m, session.answer.motions
    known = np.isfinite(error)
    assert not (known & motions.observed).any()
    assert error[known].mean() == pytest.approx(session.answer.judgement.scores["completion"]["mean_m"], rel=1e-5)


def test_another_setting_solves_anew_when_it_stays_and_shows_the_change(session: Session, clock: HandClock) -> None:
    assert session.opened is not None
    before = session.opened.judgement
    session.want(changed_settings(session.settings, {"eps4": 1e6}, source="test"))
    clock.pass_by(PATIENCE_SECONDS / 2)
    assert session.status == ""  # It may still be moved.
    clock.pass_by(PATIENCE_SECONDS)
    assert session.status == "solving ..."
    clock.work_until(lambda: session.answer is not session.opened and session.status.startswith("solved in"))
    assert session.answer is not None
    clock.work_until(lambda: session.answer is not None and session.answer.judgement is not None)
    assert session.answer.judgement is not None
    assert session.answer.motions.motion_ids == []  # No motion has so many trajectories.
    assert session.answer.judgement.scores["motions"]["found"] == 0
    assert session.opened is not None
    assert session.opened.judgement is before


def test_what_was_opened_comes_back_without_being_solved(session: Session, clock: HandClock) -> None:
    session.want(changed_settings(session.settings, {"eps2": 0.2}, source="test"))
    session.reset()
    clock.pass_by(2 * PATIENCE_SECONDS)
    assert session.settings == SETTINGS
    assert session.status == ""
    session.want(changed_settings(session.settings, {"eps2": 0.2}, source="test"))
    session.want(SETTINGS)
    clock.pass_by(2 * PATIENCE_SECONDS)
    assert session.answer is session.opened
    assert session.status == ""


def test_a_change_while_it_solves_is_solved_next(session: Session, clock: HandClock) -> None:
    session.want(changed_settings(session.settings, {"eps4": 1e6}, source="test"))
    session.solve()
    session.want(changed_settings(session.settings, {"eps4": 1e5}, source="test"))
    session.solve()
    clock.work_until(lambda: session.answer is not session.opened)
    assert session.answer is not None
    assert session.answer.motions.making.settings["eps4"] == 1e5


def test_a_recording_without_motions_can_be_solved(scene: Recording, clock: HandClock, own_cache: Path) -> None:
    session = Session(scene, None, clock=clock, cache=Cache(folder=own_cache))
    assert session.settings == Settings()
    session.begin()
    clock.work_until(lambda: session.jury.visibility is not None)
    session.solve()
    clock.work_until(lambda: session.answer is not None and session.answer.judgement is not None)
    assert session.opened is session.answer


def test_a_recording_without_truth_says_so_and_is_not_scored(clock: HandClock) -> None:
    session = Session(recording_of([np.full((6, 8), 2.0)] * 2), None, clock=clock, cache=None)
    session.begin()
    assert "no truth" in session.status
    assert session.answer is None


def test_what_cannot_be_solved_is_said_and_does_not_end_the_viewer(clock: HandClock) -> None:
    session = Session(recording_of([np.full((6, 8), np.nan)] * 2), None, clock=clock, cache=None)
    session.solve()
    clock.work_until(lambda: session.status not in ("", "solving ..."))
    assert session.answer is not None or "expected" in session.status


def test_settings_of_another_version_give_way_to_the_presets(
    scene: Recording, solved: Motions, clock: HandClock
) -> None:
    foreign = replace(solved, making=Making(settings={"eps99": 1.0}))
    assert Session(scene, foreign, clock=clock, cache=None).settings == Settings()


def test_a_picked_motion_is_told_and_recolours(session: Session) -> None:
    told: list[int | None] = []
    session.recoloured.connect(lambda: told.append(session.picked))
    session.pick(0)
    session.pick(None)
    assert told == [0, None]
