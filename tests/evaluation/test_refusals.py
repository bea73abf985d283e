"""Motions that cannot be of the recording are refused in one line."""

from dataclasses import replace

import numpy as np
import pytest
from known import FRAMES, crossing, perfect

from evaluation.scores import check_belongs, evaluate
from recording.errors import InputError
from recording.motions import Making, Motions, Representative
from recording.recording import Recording


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return perfect(recording)


def test_motions_of_another_recording_are_refused(motions: Motions) -> None:
    with pytest.raises(InputError, match="expected motions of this recording"):
        evaluate(crossing(wall=False), motions)


def test_motions_of_an_unknown_recording_are_a_warning(recording: Recording, motions: Motions) -> None:
    assert check_belongs(recording, motions) is None
    unknown = replace(motions, making=Making())
    assert "do not say which recording" in check_belongs(recording, unknown)
    assert evaluate(recording, unknown)["preset"] is None


def beyond_the_frames(motions: Motions) -> Motions:
    return replace(motions, frame=motions.frame + 1)


def before_the_frames(motions: Motions) -> Motions:
    return replace(motions, frame=motions.frame - 1)


def outside_the_picture(motions: Motions) -> Motions:
    return replace(motions, column_row=motions.column_row + np.float32(40))


def without_picture_places(motions: Motions) -> Motions:
    return replace(motions, column_row=np.full_like(motions.column_row, np.nan))


def twice(motions: Motions) -> Motions:
    return motions.rows(np.repeat(np.arange(len(motions)), 2))


def represented_beyond_the_frames(motions: Motions) -> Motions:
    late = Representative(
        motion=1, frame=np.array([FRAMES], np.int32), position=np.zeros((1, 3)), observed=np.ones(1, bool)
    )
    return replace(motions, representatives=(late,))


def represented_nowhere(motions: Motions) -> Motions:
    lost = Representative(
        motion=1, frame=np.zeros(1, np.int32), position=np.full((1, 3), np.nan), observed=np.ones(1, bool)
    )
    return replace(motions, representatives=(lost,))


@pytest.mark.parametrize(
    ("spoilt", "sentence"),
    [
        (beyond_the_frames, "frames 0 to 35, got frame 36"),
        (before_the_frames, "frames 0 to 35, got frame -1"),
        (outside_the_picture, "inside the picture of 64x30"),
        (without_picture_places, "inside the picture of 64x30, got row nan"),
        (twice, "one row a trajectory and frame"),
        (represented_beyond_the_frames, "representative of motion 1 in the recording's frames"),
        (represented_nowhere, "NaN in the representative of motion 1"),
    ],
)
def test_motions_that_cannot_be_of_the_recording_are_refused(recording, motions, spoilt, sentence) -> None:
    with pytest.raises(InputError, match=sentence) as raised:
        evaluate(recording, spoilt(motions))
    assert "\n" not in str(raised.value)
