"""Each hole by itself, held against the scores of all and against what is known of the scene."""

from functools import cache

import numpy as np
import pytest

import unocclude
from evaluation.holes import hole_rows, hole_table
from evaluation.scores import Evidence, evidence_of
from recording.recording import Recording, stripped


@cache
def wall() -> Recording:
    return unocclude.simulate("wall", size="96x72")


@cache
def evidence() -> Evidence:
    return evidence_of(wall(), unocclude.solve(wall()))


def test_there_is_a_row_for_every_hole_and_the_wall_hides() -> None:
    rows = hole_rows(evidence())
    assert [row.name for row in rows] == ["person 1", "person 2"]
    assert {row.hidden_by for row in rows} == {"box 1"}
    assert max(row.frames for row in rows) == unocclude.evaluate(wall(), evidence().motions)["longest_hole_frames"]


def test_the_holes_errors_are_the_scores_errors() -> None:
    rows, scores = hole_rows(evidence()), unocclude.evaluate(wall(), evidence().motions)["completion"]
    frames = np.array([row.frames for row in rows])
    known = [(row.frames, row.centre_mean_m) for row in rows if row.centre_mean_m is not None]
    mean = sum(count * error for count, error in known) / sum(count for count, _ in known)
    assert mean == pytest.approx(scores["centre_mean_m"])
    assert max(row.centre_max_m or 0.0 for row in rows) == pytest.approx(scores["centre_max_m"])
    assert sum(row.frames * row.recall for row in rows) / frames.sum() == pytest.approx(scores["recall"])


def test_who_walks_straight_at_one_speed_is_near_the_straight_line() -> None:
    assert all(row.straight_mean_m < 0.1 for row in hole_rows(evidence()))


def test_without_xray_there_is_no_hole() -> None:
    bare = stripped(wall())
    assert hole_rows(evidence_of(bare, unocclude.solve(bare))) == []
    assert hole_table([]) == "no holes"


def test_the_table_names_object_and_occluder() -> None:
    text = hole_table(hole_rows(evidence()))
    assert "straight line cm" in text
    assert "person 1" in text
    assert "box 1" in text
