"""Curves, paths, holes, links and boxes as lines."""

import numpy as np
from known_motions import FRAMES, two_motions

from recording.motions import Motions
from recording.palette import COLOURS, rgb
from recording.visibility import Visibility
from viewer.boxes import boxes_of
from viewer.lines import (
    CHOSEN,
    OTHER,
    curve_lines,
    hole_lines,
    link_lines,
    links_of,
    presence,
    segment_lines,
    segment_places,
)

MOTIONS = two_motions()
NOTHING = MOTIONS.rows(np.zeros(len(MOTIONS), bool))


def steps(ends: np.ndarray) -> set[tuple[int, int]]:
    """The pairs of frames that lines of the known motions, whose x counts frames, lead between."""
    return {(int(a), int(b)) for a, b in ends[:, :, 0]}


def test_a_curve_is_full_where_it_was_observed_and_has_gaps_where_it_was_completed() -> None:
    full, dashed = (curve_lines([curve], None) for curve in MOTIONS.representatives)
    assert steps(full.ends) == {(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)}
    assert steps(dashed.ends) == {(0, 1), (1, 2), (4, 5)}
    assert set(map(tuple, dashed.colours)) == {tuple(rgb(COLOURS[1]))}


def test_the_curves_of_motions_that_are_not_picked_are_pale() -> None:
    lines = curve_lines(MOTIONS.representatives, 1)
    assert lines.colours[0].sum() > rgb(COLOURS[0]).sum()
    assert tuple(lines.colours[-1]) == tuple(rgb(COLOURS[1]))


def test_segments_go_no_farther_than_they_were_seen() -> None:
    places = segment_places(MOTIONS)
    assert [place.motion for place in places] == [0, 1, 2]
    assert [place.frame.tolist() for place in places[1:]] == [[0, 1], [4, 5]]
    assert len(segment_lines(places)) == 5 + 1 + 1


def test_holes_are_the_true_paths_where_they_are_known() -> None:
    seen = np.array([[9, 9, 0, 0, 9, 9]])
    centre = np.arange(FRAMES)[None, :, None] * np.array([1.0, 0.0, 0.0])
    truth = Visibility(
        ids=(1,),
        labelled=True,
        returns=seen[0],
        seen=seen,
        unoccluded=np.full((1, FRAMES), 9),
        centre=centre,
    )
    assert steps(hole_lines(truth, ()).ends) == {(1, 2), (2, 3), (3, 4)}


def test_without_truth_holes_are_the_completed_parts_of_curves() -> None:
    assert steps(hole_lines(None, MOTIONS.representatives).ends) == {(2, 3), (3, 4)}


def test_a_motions_links_are_those_of_its_segments_the_surest_first() -> None:
    assert [(link.before, link.after) for link in links_of(MOTIONS, 1)] == [(1, 2), (0, 2)]
    assert [(link.before, link.after) for link in links_of(MOTIONS, 0)] == [(0, 2)]


def test_a_link_that_was_made_is_one_line_and_one_that_was_not_is_dashed() -> None:
    made, other = (link_lines([link], segment_places(MOTIONS)) for link in links_of(MOTIONS, 1))
    np.testing.assert_allclose(made.ends, [[[1, 0, 1], [4, 0, 1]]])
    assert len(other) > 1
    assert tuple(made.colours[0]) == tuple(rgb(CHOSEN))
    assert tuple(other.colours[0]) == tuple(rgb(OTHER))


def test_presence_tells_seen_from_completed_and_from_absent() -> None:
    np.testing.assert_array_equal(presence(MOTIONS.representatives, FRAMES + 1), [[2] * 6 + [0], [2, 2, 1, 1, 2, 2, 0]])


def test_a_box_holds_the_bulk_of_a_motions_points_and_its_edges_are_twelve() -> None:
    corner = np.array([[0, 0, 0], [1, 2, 3]] * 50 + [[99, 99, 99]], np.float32)  # One point strays.
    count = len(corner)
    body = Motions(
        frame=np.zeros(count, np.int32),
        trajectory=np.arange(count, dtype=np.int32),
        position=corner,
        column_row=np.zeros((count, 2), np.float32),
        segment=np.zeros(count, np.int32),
        motion=np.zeros(count, np.int32),
        source=np.zeros(count, np.uint8),
        confidence=np.ones(count, np.float32),
    )
    boxes = boxes_of(body)
    np.testing.assert_allclose(boxes.low, [[0, 0, 0]])
    np.testing.assert_allclose(boxes.high, [[1, 2, 3]])
    lines = boxes.lines(None, 2)
    assert [len(each) for each in lines] == [12, 0]
    assert np.abs(np.diff(lines[0].ends, axis=1)).sum() == 4 * (1 + 2 + 3)
    np.testing.assert_allclose(boxes.tops(np.array([0.0, 0.0, 1.0])), [[0.5, 1.0, 3.0]])
    np.testing.assert_allclose(boxes.tops(np.array([0.0, -1.0, 0.0])), [[0.5, 0.0, 1.5]])


def test_noise_has_no_box_and_nothing_has_no_lines() -> None:
    assert set(boxes_of(MOTIONS).motion.tolist()) == {0, 1}
    assert len(boxes_of(NOTHING).motion) == 0
    assert segment_places(NOTHING) == ()
    assert len(curve_lines((), None)) == len(hole_lines(None, ())) == 0
