"""A user who knows the truth: what he sees is wrong, and what he says of it."""

import numpy as np
import pytest
from known import CAMERA, LEFT, RIGHT, crossing, perfect, with_rows

from evaluation.guiding import guided
from evaluation.mistakes import Mistake, mistakes
from evaluation.observations import observations_of
from recording.motions import NOISE, Motions
from recording.recording import Recording
from recording.visibility import visibility_of


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


def found(recording: Recording, motions: Motions) -> list[Mistake]:
    return mistakes(observations_of(recording, motions, visibility_of(recording)), CAMERA)


def said(mistake: Mistake) -> tuple[str, set[int | None]]:
    correction = mistake.correction
    return correction.kind, {correction.one.segment, correction.other.segment}


def test_a_perfect_solution_has_no_mistakes(recording: Recording) -> None:
    assert found(recording, perfect(recording)) == []


def test_objects_that_were_exchanged_are_told_by_what_is_the_same(recording: Recording) -> None:
    motions = perfect(recording)
    exchanged = np.select([motions.segment == 11, motions.segment == 21], [2, 1], motions.motion).astype(np.int32)
    told = [said(mistake) for mistake in found(recording, with_rows(motions, motion=exchanged))]
    assert ("same", {10, 11}) in told


def test_a_segment_in_no_motion_is_the_same_as_the_nearest(recording: Recording) -> None:
    motions = perfect(recording)
    lost = np.where(motions.segment == 21, NOISE, motions.motion).astype(np.int32)
    assert [said(mistake) for mistake in found(recording, with_rows(motions, motion=lost))] == [("same", {20, 21})]


def test_two_objects_in_one_motion_are_different(recording: Recording) -> None:
    motions = perfect(recording)
    told = [said(mistake) for mistake in found(recording, with_rows(motions, motion=np.ones(len(motions), np.int32)))]
    assert {kind for kind, _ in told} == {"different"}


def test_two_objects_in_one_segment_are_different_and_marked_on_each(recording: Recording) -> None:
    motions = perfect(recording)
    mixed = np.where(motions.segment == 20, 10, motions.segment).astype(np.int32)
    first = found(recording, with_rows(motions, segment=mixed))[0]
    assert said(first) == ("different", {10})
    behind = set()
    for mark in (first.correction.one, first.correction.other):
        labels = recording.frames[mark.frame].labels
        assert labels is not None
        behind.add(int(labels.objectid[int(mark.row), int(mark.column)]))
    assert behind == {LEFT, RIGHT}


def test_the_worst_mistake_comes_first(recording: Recording) -> None:
    motions = perfect(recording)
    told = found(recording, with_rows(motions, motion=np.full(len(motions), NOISE, np.int32)))
    assert [mistake.points for mistake in told] == sorted((mistake.points for mistake in told), reverse=True)


def test_the_user_stops_where_nothing_is_wrong_or_he_has_said_enough(recording: Recording) -> None:
    course = list(guided(recording, most=2))
    assert [len(state.corrections.correction) for state in course] == list(range(len(course)))
    assert len(course) <= 3
    assert course[0].corrections.recording_digest == recording.digest()
