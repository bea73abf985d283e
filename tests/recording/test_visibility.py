"""What is seen, hidden and out of view; holes; points a frame."""

import numpy as np
import pytest
from known import CAMERA, FRAMES, LEFT, RIGHT, crossing, masks_only

from recording.recording import Recording, stripped
from recording.visibility import (
    Visibility,
    hidden_lengths,
    hidden_runs,
    holes,
    longest_hole,
    visibility_of,
)


def visibility(seen: list[int], unoccluded: list[int] | None = None) -> Visibility:
    """One object's pixel counts; 10 unoccluded pixels a frame unless said otherwise."""
    whole = np.array([unoccluded or [10] * len(seen)])
    return Visibility(
        ids=(4,),
        labelled=True,
        returns=np.full(len(seen), 100),
        seen=np.array([seen]),
        unoccluded=whole,
        centre=np.zeros((1, len(seen), 3)),
    )


def test_a_square_behind_a_wall_is_hidden_and_its_centre_known() -> None:
    recording = crossing()
    found = visibility_of(recording)
    assert found.ids == (LEFT, RIGHT)
    assert (found.unoccluded[0] == 196).all()
    assert found.seen[0, 0] == 196
    assert found.seen[0, 18] == 0
    expected = recording.truth[LEFT].vertices.mean(axis=1)
    np.testing.assert_allclose(found.centre[0], expected, atol=CAMERA.fx / 1000)  # A fraction of a pixel of 7.5 cm.


def test_points_leave_the_ground_out_and_count_returns_only() -> None:
    recording = crossing()
    labels = recording.frames[0].labels.objectid
    assert visibility_of(recording).returns[0] == np.isin(labels, [LEFT, RIGHT, 7]).sum()
    assert visibility_of(crossing(lost=0.25)).points_per_frame == pytest.approx(472 * 0.75, rel=0.02)


@pytest.mark.parametrize(("seen", "expected"), [(2, False), (1, True), (0, True)])
def test_hidden_is_under_a_fifth(seen: int, expected: bool) -> None:
    assert visibility([seen]).hidden[0, 0] == expected


def test_out_of_view_is_not_hidden() -> None:
    found = visibility([10, 0, 10], [10, 0, 10])
    assert found.in_view.tolist() == [[True, False, True]]
    assert not found.hidden.any()
    assert holes(found) == []
    assert longest_hole(found) is None


def test_a_hole_lies_between_two_frames_in_which_the_object_is_seen() -> None:
    found = visibility([0, 10, 0, 1, 10, 0, 10, 0, 0, 0])
    assert [(run.first, run.stop, run.hole) for run in hidden_runs(found)] == [
        (0, 1, False),
        (2, 4, True),
        (5, 6, True),
        (7, 10, False),
    ]
    assert [hole.frames for hole in holes(found)] == [2, 1]
    assert longest_hole(found) == 2
    assert hidden_lengths(found).tolist() == [[1, 0, 2, 2, 0, 1, 0, 3, 3, 3]]


def test_who_leaves_the_picture_while_hidden_makes_no_hole() -> None:
    assert holes(visibility([10, 0, 0, 0, 10], [10, 10, 0, 10, 10])) == []


def test_masks_alone_know_what_is_seen_but_nothing_hidden() -> None:
    found = visibility_of(masks_only(crossing()))
    assert found.ids == (LEFT, RIGHT)
    assert found.seen[0].tolist() == visibility_of(crossing()).seen[0].tolist()
    assert found.hidden is None
    assert holes(found) is None
    assert longest_hole(found) is None


def test_a_bare_recording_knows_its_returns_alone() -> None:
    found = visibility_of(stripped(crossing()))
    assert not found.labelled
    assert found.ids == ()
    assert found.seen.shape == (0, FRAMES)


def test_an_object_that_never_comes_into_view_is_neither_seen_nor_hidden() -> None:
    recording = crossing()
    absent = np.full((CAMERA.height, CAMERA.width), np.nan, np.float32)
    alone = replace_xray(recording, [{LEFT: xray[LEFT], RIGHT: absent} for xray in recording.xray])
    found = visibility_of(alone)
    assert not found.hidden[1].any()
    assert np.isnan(found.centre[1]).all()


def replace_xray(recording: Recording, xray: list[dict[int, np.ndarray]]) -> Recording:
    return Recording(metadata=recording.metadata, frames=recording.frames, truth=recording.truth, xray=xray)
