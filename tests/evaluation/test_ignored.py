"""What lies on a juggler counts neither for nor against."""

from dataclasses import replace

import numpy as np
from known import LEFT, RIGHT, WALL, crossing, empty, leaves, perfect

from evaluation.ignored import counted, ignored_ids
from evaluation.scores import scores
from recording.motions import INTRA, OBSERVED, Link, Motions, mean_places
from recording.recording import Recording

ARMS = 50
"""The motion and the segment that a solver finds on the juggler."""


def juggled() -> Recording:
    """The crossing with a juggler in the wall's place."""
    recording = crossing()
    objects = [
        entry.model_copy(update={"kind": "juggler"}) if entry.id == WALL else entry
        for entry in recording.metadata.objects or ()
    ]
    return replace(recording, metadata=recording.metadata.model_copy(update={"objects": tuple(objects)}))


def with_arms(motions: Motions, recording: Recording, *, motion: int = ARMS) -> Motions:
    """The motions and one more trajectory, over the middle of the wall, its last frame completed."""
    row, column = (int(part.mean()) for part in np.nonzero(recording.frames[0].labels.objectid == WALL))
    frames = np.arange(recording.metadata.frames, dtype=np.int32)
    count = len(frames)
    columns = {
        "frame": frames,
        "trajectory": np.full(count, motions.trajectory.max(initial=0) + 1, np.int32),
        "position": np.tile(np.float32([0.0, 0.0, 2.0]), (count, 1)),
        "column_row": np.tile(np.float32([column + 0.5, row + 0.5]), (count, 1)),
        "segment": np.full(count, motion, np.int32),
        "motion": np.full(count, motion, np.int32),
        "source": np.where(frames == count - 1, INTRA, OBSERVED).astype(np.uint8),
        "confidence": np.ones(count, np.float32),
    }
    joined = {name: np.concatenate([getattr(motions, name), added]) for name, added in columns.items()}
    more = replace(motions, **joined, links=(*motions.links, Link(before=motion, after=21, confidence=1.0)))
    return replace(more, representatives=mean_places(more))


def test_only_jugglers_are_ignored() -> None:
    assert ignored_ids(crossing()) == ()
    assert ignored_ids(juggled()) == (WALL,)
    motions = perfect(crossing())
    assert counted(crossing(), motions) is motions


def test_a_motion_on_the_arms_changes_no_score() -> None:
    recording = juggled()
    motions = perfect(recording)
    alone, more = (leaves(scores(recording, each)) for each in (motions, with_arms(motions, recording)))
    assert alone == more
    assert leaves(scores(crossing(), with_arms(motions, crossing()))) != alone


def test_points_on_the_arms_are_left_out_of_an_objects_motion() -> None:
    recording = juggled()
    kept = counted(recording, with_arms(perfect(recording), recording, motion=LEFT))
    assert len(kept) == len(perfect(recording))
    assert kept.motion_ids == [LEFT, RIGHT]


def test_a_motion_of_arms_and_an_object_keeps_the_objects_points() -> None:
    recording = juggled()
    motions = with_arms(perfect(recording), recording)
    number = motions.trajectory == motions.trajectory[motions.motion == RIGHT][0]  # One trajectory of many.
    mixed = replace(motions, motion=np.where(number, np.int32(ARMS), motions.motion))
    kept = counted(recording, mixed)
    assert kept.motion_ids == [LEFT, RIGHT, ARMS]
    assert len(kept) == len(perfect(recording))


def test_a_solver_that_found_nothing_stays_so() -> None:
    assert len(counted(juggled(), empty())) == 0
