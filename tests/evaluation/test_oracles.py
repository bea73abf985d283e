"""Stages that know the truth: what they say is true, and the algorithm takes it."""

import numpy as np
import pytest
from known import CAMERA, LEFT, RIGHT, crossing, leaves, masks_only

from algorithm.given import Given
from algorithm.pipeline import solve
from algorithm.trajectories import Trajectories
from evaluation.oracles import heaviest_chain, objects_behind, true_flow, true_links, true_segments, unbroken
from evaluation.scores import evaluate
from recording.errors import InputError
from recording.recording import Recording


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


def followed(recording: Recording, *spans: tuple[int, int, int]) -> Trajectories:
    """A trajectory of an object's middle from a first frame to a last, for each span (object, first, last)."""
    assert recording.truth is not None
    rows = [
        (number, frame, recording.truth[objectid].vertices_at(frame).mean(axis=0))
        for number, (objectid, first, last) in enumerate(spans)
        for frame in range(first, last + 1)
    ]
    trajectory, frame, position = zip(*rows, strict=True)
    place = np.array(position, np.float64)
    return Trajectories(
        trajectory=np.array(trajectory),
        frame=np.array(frame),
        position=place,
        column_row=CAMERA.pixel_from_world(place)[0],
    )


def test_true_flow_moves_the_squares_by_their_step(recording: Recording) -> None:
    flow = true_flow(recording).flow
    assert flow is not None
    labels = recording.frames[3].labels
    assert labels is not None
    for objectid, step_px in ((LEFT, 1.0), (RIGHT, -1.0)):
        own = labels.objectid == objectid
        assert own.any()
        assert np.abs(flow(3, 4)[own] - [step_px, 0.0]).max() < 1e-4
        assert np.abs(flow(3, 2)[own] + [step_px, 0.0]).max() < 1e-4


def test_true_segments_are_the_objects_visible_episodes(recording: Recording) -> None:
    segmenter = true_segments(recording).segments
    assert segmenter is not None
    spans = (LEFT, 0, 10), (LEFT, 2, 9), (RIGHT, 0, 8), (LEFT, 26, 35), (RIGHT, 28, 35)
    np.testing.assert_array_equal(segmenter(followed(recording, *spans)), [0, 0, 2, 1, 3])


def test_episodes_that_overlap_are_one() -> None:
    first, last, episode = np.array([0, 20, 19, 40]), np.array([18, 30, 25, 50]), np.array([0, 2, 0, 5])
    np.testing.assert_array_equal(unbroken(first, last, episode), [0, 0, 0, 1])
    nothing = np.zeros(0, int)
    assert len(unbroken(nothing, nothing, nothing)) == 0


def test_true_links_lead_from_each_segment_of_an_object_to_the_next(recording: Recording) -> None:
    linker = true_links(recording).links
    assert linker is not None
    spans = (RIGHT, 0, 8), (LEFT, 0, 10), (RIGHT, 28, 35), (LEFT, 26, 30), (LEFT, 33, 35)
    pairs = linker(followed(recording, *spans), np.arange(5))
    assert sorted(pairs) == [(0, 2), (1, 3), (3, 4)]


def test_noise_is_not_linked(recording: Recording) -> None:
    linker = true_links(recording).links
    assert linker is not None
    trajectories = followed(recording, (LEFT, 0, 10), (LEFT, 26, 35))
    assert linker(trajectories, np.array([0, -1])) == []


def test_of_segments_that_overlap_those_with_the_most_points_are_linked() -> None:
    first, last = np.array([0, 0, 12, 8]), np.array([10, 10, 20, 30])
    assert heaviest_chain(first, last, np.array([5, 50, 40, 60])) == [1, 2]
    assert heaviest_chain(first, last, np.array([5, 50, 40, 100])) == [3]
    assert heaviest_chain(np.zeros(0, int), np.zeros(0, int), np.zeros(0, int)) == []


def test_the_object_behind_a_point_is_that_of_its_pixel(recording: Recording) -> None:
    np.testing.assert_array_equal(objects_behind(recording, followed(recording, (LEFT, 0, 2))), [LEFT] * 3)
    hidden = followed(recording, (LEFT, 18, 18))
    np.testing.assert_array_equal(objects_behind(recording, hidden), [0])  # The wall stands still.


def test_the_algorithm_takes_what_is_given(recording: Recording) -> None:
    """With true flow, segments and links both squares are found and every hole is bridged."""
    given = Given(
        flow=true_flow(recording).flow, segments=true_segments(recording).segments, links=true_links(recording).links
    )
    found = leaves(evaluate(recording, solve(recording, given=given)))
    assert (found["motions.found"], found["motions.purity"]) == (2, 1)
    assert (found["links.precision"], found["links.recall"]) == (1, 1)
    assert found["completion.centre_mean_m"] < 0.1


def test_without_truth_there_is_no_oracle(recording: Recording) -> None:
    with pytest.raises(InputError, match="X-ray twins"):
        true_segments(masks_only(recording))
    with pytest.raises(InputError, match="truth"):
        solve(masks_only(recording), given=true_flow(masks_only(recording)))
