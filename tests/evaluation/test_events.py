"""Merges and splits: what is caught and let go, and what a solver says of it."""

from dataclasses import replace

import numpy as np
import pytest
from known import FRAMES, LEFT, RIGHT, crossing, leaves, perfect, with_rows

from evaluation.events import TrueEvent, event_counts, true_events
from evaluation.ignored import counted, uncarried
from evaluation.scores import scores
from recording.errors import InputError
from recording.metadata import CarriedRecord
from recording.motions import Event, Motions
from recording.recording import Recording
from recording.visibility import visibility_of

CAUGHT, LET_GO = 24, 30


def with_carried(*stretches: tuple[int, int]) -> Recording:
    """The crossing, in which the left square is carried by the right one in the stretches of frames."""
    recording = crossing()
    carried = tuple(CarriedRecord(object=LEFT, by=RIGHT, first=first, stop=stop) for first, stop in stretches)
    return replace(recording, metadata=recording.metadata.model_copy(update={"carried": carried}))


def telling(recording: Recording, *events: Event) -> Motions:
    return replace(perfect(recording), events=events)


def merge(frame: int, motions: tuple[int, int] = (LEFT, RIGHT)) -> Event:
    return Event(kind="merge", frame=frame, motions=motions)


MOTION_OF = {LEFT: LEFT, RIGHT: RIGHT}


def test_catching_is_a_merge_and_letting_go_a_split() -> None:
    assert true_events(with_carried((CAUGHT, LET_GO))) == [
        TrueEvent(kind="merge", frame=CAUGHT, objects=(LEFT, RIGHT)),
        TrueEvent(kind="split", frame=LET_GO, objects=(LEFT, RIGHT)),
    ]
    assert true_events(with_carried((0, 5), (20, FRAMES))) == [
        TrueEvent(kind="split", frame=5, objects=(LEFT, RIGHT)),
        TrueEvent(kind="merge", frame=20, objects=(LEFT, RIGHT)),
    ]
    assert true_events(crossing()) == []


@pytest.mark.parametrize("frame", [CAUGHT - 9, CAUGHT, CAUGHT + 9])
def test_an_event_within_three_tenths_of_a_second_is_right(frame: int) -> None:
    recording = with_carried((CAUGHT, FRAMES))
    counts = event_counts(recording, telling(recording, merge(frame, (RIGHT, LEFT))), MOTION_OF)
    assert (counts.precision, counts.recall) == (1, 1)


@pytest.mark.parametrize(
    "event",
    [
        merge(CAUGHT - 10),
        merge(CAUGHT + 10),
        Event(kind="split", frame=CAUGHT, motions=(LEFT, RIGHT)),
        merge(24, (1, 5)),
    ],
)
def test_another_time_kind_or_motion_is_wrong(event: Event) -> None:
    recording = with_carried((CAUGHT, FRAMES))
    counts = event_counts(recording, telling(recording, event), MOTION_OF)
    assert (counts.precision, counts.recall) == (0, 0)


def test_telling_an_event_twice_makes_one_of_them_wrong() -> None:
    recording = with_carried((CAUGHT, FRAMES))
    counts = event_counts(recording, telling(recording, merge(CAUGHT), merge(CAUGHT + 1)), MOTION_OF)
    assert (counts.precision, counts.recall) == (0.5, 1)


def test_events_that_are_near_each_other_are_paired_as_well_as_can_be() -> None:
    recording = with_carried((10, 12), (20, FRAMES))
    counts = event_counts(recording, telling(recording, merge(15), merge(8)), MOTION_OF)
    assert (counts.right, counts.true, counts.told) == (2, 3, 2)


def test_the_scores_say_it() -> None:
    recording = with_carried((CAUGHT, LET_GO))
    assert scores(recording, telling(recording))["events"] == {"count": 0, "true": 2, "recall": 0}
    found = scores(recording, telling(recording, merge(CAUGHT)))["events"]
    assert found == {"count": 1, "true": 2, "precision": 1, "recall": 0.5}
    assert scores(crossing(), telling(crossing(), merge(3)))["events"] == {"count": 1, "true": 0, "precision": 0}


def test_an_event_after_the_last_frame_is_of_another_recording() -> None:
    with pytest.raises(InputError, match=f"expected events in the recording's frames 0 to {FRAMES - 1}, got frame 99"):
        scores(crossing(), telling(crossing(), merge(99)))


# ---- What is carried counts neither for nor against ----


def test_a_carried_object_may_go_on_as_itself_or_as_its_carrier() -> None:
    recording = with_carried((CAUGHT, FRAMES))
    motions = perfect(recording)
    in_hand = motions.observed & (motions.motion == LEFT) & (motions.frame >= CAUGHT)
    assert in_hand.any()
    as_carrier = with_rows(motions, motion=np.where(in_hand, np.int32(RIGHT), motions.motion))
    as_itself, merged, new = (
        leaves(scores(recording, replace(each, representatives=motions.representatives)))
        for each in (motions, as_carrier, replace(motions, motion=np.where(in_hand, np.int32(9), motions.motion)))
    )
    assert merged == as_itself == new
    assert leaves(scores(crossing(), as_carrier)) != leaves(scores(crossing(), motions))


def test_in_a_hand_an_object_is_neither_seen_nor_hidden() -> None:
    recording = with_carried((CAUGHT, LET_GO))
    whole = visibility_of(recording)
    free = uncarried(whole, recording)
    assert free.unoccluded is not None
    assert (free.unoccluded[0, CAUGHT:LET_GO] == 0).all()
    assert (free.seen[0, CAUGHT:LET_GO] == 0).all()
    assert np.isnan(free.centre[0, CAUGHT:LET_GO]).all()
    np.testing.assert_array_equal(free.unoccluded[1], whole.unoccluded[1])
    np.testing.assert_array_equal(free.seen[0, :CAUGHT], whole.seen[0, :CAUGHT])
    assert uncarried(whole, crossing()) is whole


def test_events_of_motions_that_are_left_out_are_left_out() -> None:
    recording = with_carried((0, FRAMES))
    motions = telling(recording, merge(3))
    kept = counted(recording, motions)
    assert kept.motion_ids == [RIGHT]
    assert kept.events == ()
