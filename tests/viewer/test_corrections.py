"""Corrections by hand in the viewer: marks, what is said of them, and that it is solved, refused, undone and saved."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from by_hand import HandClock
from known_motions import two_motions
from passing_by import SETTINGS

from algorithm.settings import Settings, changed_settings, preset_settings
from recording.cache import Cache
from recording.corrections import Anchor, Correction, Corrections, load_corrections, save_corrections
from recording.errors import InputError
from recording.motions import NOISE, Motions
from recording.palette import rgb
from recording.recording import Recording
from viewer.answer import Answer
from viewer.clouds import motion_cloud
from viewer.colours import MARK_COLOURS, Shades, motion_colours
from viewer.hand import Hand, described
from viewer.keeping import CorrectionsFile
from viewer.marks import Marks, mark_at, mark_on, segment_frames
from viewer.panels.corrections import file_text
from viewer.session import Session
from viewer.wish import Wish, command

MOTIONS = two_motions()


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


@pytest.fixture
def session(scene: Recording, solved: Motions, clock: HandClock, own_cache: Path, tmp_path: Path) -> Session:
    """A session of a person who passes behind a wall, seen as one segment before it and as one behind it."""
    file = CorrectionsFile(tmp_path / "corrections.toml")
    return Session(scene, solved, clock=clock, cache=Cache(folder=own_cache), file=file)


@pytest.fixture
def hand(session: Session) -> Hand:
    return Hand(session)


def answer(session: Session) -> Answer:
    assert session.answer is not None
    return session.answer


def mark_both_ends(session: Session) -> None:
    """Mark the segments that the made link joins."""
    motions = answer(session).motions
    for segment in (motions.links[0].before, motions.links[0].after):
        mark = mark_on(motions, segment)
        assert mark is not None
        session.marks.add(mark)


def settled(session: Session, clock: HandClock) -> None:
    clock.work_until(lambda: session.status not in ("", "solving ..."))


def test_a_mark_is_the_point_itself_and_of_a_completed_one_its_segment() -> None:
    observed = mark_at(MOTIONS, 0)
    assert observed is not None
    assert observed.anchor == Anchor(frame=0, column=1.5, row=1.5, segment=0)
    completed = mark_at(MOTIONS, int(np.flatnonzero(~MOTIONS.observed)[0]))
    assert completed is not None
    assert (completed.segment, completed.anchor.frame) == (1, 1)
    assert mark_at(MOTIONS, int(np.flatnonzero(MOTIONS.segment == NOISE)[0])) is None


def test_a_segment_is_marked_in_the_middle_of_its_time() -> None:
    mark = mark_on(MOTIONS, 0)
    assert mark is not None
    assert mark.anchor.frame == 3
    assert mark_on(MOTIONS, 99) is None
    assert segment_frames(MOTIONS) == {0: (0, 5), 1: (0, 1), 2: (4, 5)}


def test_clicks_mark_the_first_then_the_second_then_begin_anew() -> None:
    marks = Marks()
    found = [mark_on(MOTIONS, segment) for segment in (0, 1, 2)]
    for mark in found:
        assert mark is not None
        marks.add(mark)
        assert marks.known[-1] is mark
    assert list(marks.segments) == [2, None]
    marks.put(1, found[0])
    assert list(marks.segments) == [2, 0]
    marks.clear()
    assert marks.known == []


def test_marked_segments_stand_out_and_all_others_pale(scene: Recording, session: Session) -> None:
    cloud = motion_cloud(MOTIONS, MOTIONS.observed, scene, session.space)
    plain, marked = (
        motion_colours(cloud, Answer(motions=MOTIONS), Shades(colouring="motion", depth_m=(1.0, 2.0), marked=pair))
        for pair in ((None, None), (2, 1))
    )
    segment = MOTIONS.segment[cloud.row]
    assert set(map(tuple, marked[segment == 2])) == {tuple(rgb(MARK_COLOURS[0]))}
    assert set(map(tuple, marked[segment == 1])) == {tuple(rgb(MARK_COLOURS[1]))}
    assert (marked[segment == 0] > plain[segment == 0]).any()


def test_clicks_pick_or_mark(session: Session) -> None:
    row = int(np.flatnonzero(answer(session).motions.observed & (answer(session).motions.motion == 0))[0])
    session.click(row)
    assert (session.picked, session.marks.known) == (0, [])
    session.click_to("mark")
    session.click(None)
    session.click(row)
    assert session.marks.segments == (answer(session).motions.segment[row], None)


def test_what_is_different_is_solved_apart_and_comes_together_again(
    session: Session, hand: Hand, clock: HandClock
) -> None:
    mark_both_ends(session)
    assert answer(session).motions.motion_ids == [0]
    hand.say("different")
    settled(session, clock)
    assert session.status.startswith("solved in")
    assert len(answer(session).motions.motion_ids) == 2
    assert answer(session).motions.making.corrections == session.corrections
    assert session.marks.known == []
    hand.undo()
    assert answer(session) is session.opened
    assert not session.corrections.correction
    hand.undo()  # There is nothing left to undo.
    assert not session.corrections.correction


def test_a_made_link_is_forbidden_and_then_forced_again(session: Session, hand: Hand, clock: HandClock) -> None:
    link = answer(session).motions.links[0]
    hand.say_of(link)
    settled(session, clock)
    assert [each.kind for each in session.corrections.correction] == ["forbid"]
    assert answer(session).motions.links == ()
    hand.take_back(0)
    hand.say_of(replace(link, chosen=False))
    settled(session, clock)
    assert [each.kind for each in session.corrections.correction] == ["force"]
    assert answer(session).motions.making.corrections == session.corrections
    assert answer(session).motions.links[0].confidence == pytest.approx(1.0)


def test_a_contradiction_is_one_line_and_not_added(session: Session, hand: Hand, clock: HandClock) -> None:
    mark_both_ends(session)
    hand.say("same")
    settled(session, clock)
    before = session.corrections
    mark_both_ends(session)
    hand.say("different")
    assert len(session.corrections.correction) == 2
    clock.work_until(lambda: session.status.startswith("not added: correction"))
    assert len(session.status.splitlines()) == 1
    assert session.corrections == before
    hand.undo()
    assert not session.corrections.correction


def test_nothing_is_said_of_nothing_and_nothing_twice(session: Session, hand: Hand, clock: HandClock) -> None:
    hand.say("same")
    assert session.status == "mark two segments first"
    link = answer(session).motions.links[0]
    hand.say_of(link)
    hand.say_of(link)
    assert session.status == "this has been said already"
    clock.work_until(lambda: session.status.startswith("solved"))
    hand.clear()
    assert answer(session) is session.opened


def test_settings_go_back_and_corrections_stay(session: Session, hand: Hand, clock: HandClock) -> None:
    hand.say_of(answer(session).motions.links[0])
    settled(session, clock)
    session.want(changed_settings(session.settings, {"eps2": 0.11}, source="test"))
    session.reset()
    clock.work_until(lambda: session.status.startswith("solved"))
    assert session.settings == SETTINGS
    assert len(session.corrections.correction) == 1
    assert answer(session).motions.links == ()


def test_the_papers_completing_knows_no_corrections_and_says_so(session: Session, hand: Hand, clock: HandClock) -> None:
    assert session.opened is not None
    paper = preset_settings("paper")
    assert not Wish(settings=paper, corrections=session.corrections).is_near(Cache(folder=Path("nowhere")))
    hand.say_of(answer(session).motions.links[0])
    session.want(paper)
    session.solve()
    clock.work_until(lambda: "completing" in session.status)
    assert len(session.corrections.correction) == 1


def test_pointing_at_something_keeps_the_motions_so_that_the_next_correction_is_quick(
    session: Session, clock: HandClock
) -> None:
    assert session._foresight.prepared is None
    session.pick(None)
    assert session._foresight.prepared is None
    session.pick(0)
    assert session._foresight.prepared == SETTINGS
    assert session.status == ""


def test_they_are_saved_and_read_again(session: Session, hand: Hand, clock: HandClock, scene: Recording) -> None:
    assert session.file is not None
    assert file_text(session).endswith("nothing to save")
    hand.say_of(answer(session).motions.links[0])
    settled(session, clock)
    assert file_text(session).endswith("**not saved yet**")
    hand.save()
    assert session.status == f"saved to {session.file.path}"
    assert file_text(session).endswith(": saved")
    assert load_corrections(session.file.path) == session.corrections
    again = CorrectionsFile(session.file.path)
    again.read(scene)
    assert session.opened is not None
    other = Session(scene, session.opened.motions, clock=clock, cache=session._cache, file=again)
    other.begin()
    clock.work_until(lambda: other.answer is not other.opened)
    np.testing.assert_array_equal(answer(other).motions.motion, answer(session).motions.motion)


@pytest.mark.parametrize(("digest", "whose"), [("0" * 64, "another recording"), (None, "somebody else")])
def test_what_others_wrote_is_not_replaced(session: Session, hand: Hand, digest: str | None, whose: str) -> None:
    assert session.file is not None
    anchor = Anchor(frame=0, column=1.0, row=1.0)
    theirs = Corrections(
        recording_digest=digest or session.corrections.recording_digest,
        correction=(Correction(kind="same", one=anchor, other=anchor),),
    )
    save_corrections(theirs, session.file.path)
    hand.save()
    assert f"those of {whose}" in session.status
    assert load_corrections(session.file.path) == theirs


def test_a_file_of_another_recording_is_refused(scene: Recording, tmp_path: Path) -> None:
    file = CorrectionsFile(tmp_path / "corrections.toml")
    file.read(scene)
    assert file.known is None
    save_corrections(Corrections(recording_digest="0" * 64), file.path)
    with pytest.raises(InputError, match="another one"):
        file.read(scene)


def test_the_command_that_solves_alike_names_preset_settings_and_file(scene: Recording, session: Session) -> None:
    said = Corrections(recording_digest="0", correction=(correction("same"),))
    path = Path("my corrections.toml")
    plain = Wish(settings=Settings(), corrections=Corrections(recording_digest="0"))
    assert command(plain, scene, path) == "unocclude solve RECORDING"
    changed = replace(plain, settings=changed_settings(preset_settings("paper"), {"eps3": 4.5}, source="test"))
    assert command(changed, scene, path) == "unocclude solve RECORDING --preset paper --set eps3=4.5"
    other = changed_settings(Settings(), {"limb_swing": False, "flow": "dis"}, source="test")
    assert command(Wish(settings=other, corrections=said), scene, path) == (
        "unocclude solve RECORDING --set flow=dis --set limb_swing=false --corrections 'my corrections.toml'"
    )


def test_corrections_are_described_with_the_numbers_that_the_segments_had() -> None:
    assert described(correction("same")) == "same: 3 (frame 1), frame 7"
    assert described(correction("forbid")) == "forbid 3 (frame 1) \u2192 frame 7"


def correction(kind: str) -> Correction:
    one, other = Anchor(frame=1, column=2.0, row=3.0, segment=3), Anchor(frame=7, column=2.0, row=3.0)
    return Correction(kind=kind, one=one, other=other)  # type: ignore[arg-type]  # One of the four kinds.
