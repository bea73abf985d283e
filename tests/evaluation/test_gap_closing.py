"""Gap closing: straight lines through gaps, the cost over gaps, a missing package."""

import numpy as np
import pytest
from known import crossing, leaves
from passing import seen_at, straight
from worlds import recording_of

from evaluation import gap_closing
from evaluation.detections import detections_of
from evaluation.gap_closing import GapClosingSettings, closed_tracks, extrapolation_miss, gap_closing_motions
from evaluation.scores import evaluate
from recording.errors import InputError

FPS = 30.0
MOVING = GapClosingSettings(radius_m=0.12, velocity_seconds=0.3, gap_seconds=1.0, gap_m=0.5)


def test_a_gap_is_closed_by_a_straight_line() -> None:
    truth = straight((0, 0, 3), (0.05, 0, 0), 40)
    seen = truth.copy()
    seen[15:25] = np.nan
    (track,) = closed_tracks(detections_of(seen_at(seen), MOVING), MOVING, frames=40, fps=FPS)
    assert (track.first, len(track.detections)) == (0, 30)
    np.testing.assert_allclose(track.position, truth, atol=1e-6)


def test_a_gap_longer_than_allowed_stays_open() -> None:
    seen = straight((0, 0, 3), (0.05, 0, 0), 60)
    seen[10:45] = np.nan
    settings = MOVING.model_copy(update={"shortest_seconds": 0.1})
    tracks = closed_tracks(detections_of(seen_at(seen), settings), settings, frames=60, fps=FPS)
    assert [(track.first, len(track.position)) for track in tracks] == [(0, 10), (45, 15)]


def test_two_that_cross_while_hidden_are_told_apart_by_their_speed() -> None:
    right, left = straight((-1, 0, 3), (0.05, 0, 0), 40), straight((1, 0, 3.2), (-0.05, 0, 0), 40)
    seen = right.copy(), left.copy()
    for places in seen:
        places[15:26] = np.nan
    tracks = closed_tracks(detections_of(seen_at(*seen), MOVING), MOVING, frames=40, fps=FPS)
    assert len(tracks) == 2
    np.testing.assert_allclose(sorted(track.position[-1, 0] for track in tracks), [-0.95, 0.95], atol=1e-6)
    for track in tracks:
        assert abs(track.position[0, 0] - track.position[-1, 0]) > 1.9


def test_the_miss_is_the_mean_of_both_extrapolations() -> None:
    end = np.array([0, 0, 0, 1, 0, 0, 9, 9, 9, 2.0])  # Leaves with 1 m/s along x at 2 s.
    begin = np.array([3, 0, 0, 9, 9, 9, 1, 0, 0, 4.0])  # Comes with 1 m/s along x at 4 s.
    assert extrapolation_miss(end, begin) == pytest.approx(1.0)
    assert extrapolation_miss(end, np.array([2, 0, 0, 9, 9, 9, 0, 0, 0, 4.0])) == pytest.approx(1.0)


def test_squares_that_cross_behind_a_wall_score_like_any_motions() -> None:
    recording = crossing()
    found = leaves(evaluate(recording, gap_closing_motions(recording)))
    assert found["preset"] == "gap_closing"
    assert found["motions.purity"] > 0.95
    assert found["coverage"] > 0.75


def test_where_nothing_moves_there_is_no_motion() -> None:
    still = recording_of([np.full((24, 32), 3.0, np.float32)] * 8)
    assert gap_closing_motions(still).motion_ids == []


def test_a_missing_package_is_one_line_that_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gap_closing, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="pip install 'unocclude\\[compare\\]'"):
        gap_closing_motions(crossing())
