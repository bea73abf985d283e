"""Identity scores: parity with TrackEval, the known switch, borders."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from trackeval.metrics import CLEAR, HOTA, Identity

from evaluation.identity import Tracks, assa, fragmentations, hota, id_switches, idf1, tracks

FRAMES = 12


def places(count: int) -> st.SearchStrategy[np.ndarray]:
    """Tracks along a line, absent in some frames."""
    along = arrays(float, (count, FRAMES), elements=st.floats(0, 2.5, width=32))
    there = arrays(bool, (count, FRAMES))
    return st.tuples(along, there).map(_on_a_line)


def _on_a_line(drawn: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    along, there = drawn
    return np.stack([np.where(there, along, np.nan)] * 3, axis=-1) * [1.0, 0.0, 0.0]


def straight(*, side: float, frames: slice = slice(None), length: int = 100) -> np.ndarray:
    """A track that stands at a side of the scene, absent outside the frames."""
    place = np.full((length, 3), np.nan)
    place[frames] = [side, 0.0, 0.0]
    return place


@given(st.integers(1, 4).flatmap(places), st.integers(0, 4).flatmap(places))
def test_scores_equal_those_of_trackeval(truth: np.ndarray, predicted: np.ndarray) -> None:
    ours = tracks(truth, predicted)
    assume(len(ours.truth_frames))  # Else there is nothing to score, and `tracks_of` says so.
    data = _as_trackeval_reads_it(ours)
    theirs = HOTA().eval_sequence(data)
    assert hota(ours) == pytest.approx(theirs["HOTA"].mean(), abs=1e-6)
    assert assa(ours) == pytest.approx(theirs["AssA"].mean(), abs=1e-6)
    quiet = {"PRINT_CONFIG": False}
    assert idf1(ours) == pytest.approx(Identity(quiet).eval_sequence(data)["IDF1"], abs=1e-6)
    clear = CLEAR(quiet).eval_sequence(data)
    assert (id_switches(ours), fragmentations(ours)) == (clear["IDSW"], clear["Frag"])


def test_the_same_places_score_perfectly() -> None:
    truth = np.stack([straight(side=0.0), straight(side=5.0, frames=slice(10, 60))])
    same = tracks(truth, truth[::-1])
    assert (hota(same), assa(same), idf1(same)) == (1, 1, 1)
    assert (id_switches(same), fragmentations(same)) == (0, 0)


def test_a_switch_halfway_in_one_of_two_tracks_costs_what_it_must() -> None:
    truth = np.stack([straight(side=0.0), straight(side=5.0)])
    switched = [straight(side=0.0, frames=slice(50)), straight(side=0.0, frames=slice(50, None)), straight(side=5.0)]
    found = tracks(truth, np.stack(switched))
    assert hota(found) == pytest.approx(np.sqrt(0.75))
    assert assa(found) == pytest.approx(0.75)
    assert idf1(found) == pytest.approx(0.75)
    assert (id_switches(found), fragmentations(found)) == (1, 0)


def test_a_gap_is_a_fragmentation_and_no_switch() -> None:
    truth = np.stack([straight(side=0.0), straight(side=5.0)])
    found = truth.copy()
    found[0, 40:60] = np.nan
    broken = tracks(truth, found)
    assert (id_switches(broken), fragmentations(broken)) == (0, 1)
    assert idf1(broken) == pytest.approx(2 * 180 / 380)


def test_a_track_that_is_too_long_is_punished() -> None:
    truth = np.stack([straight(side=0.0, frames=slice(50))])
    assert idf1(tracks(truth, np.stack([straight(side=0.0)]))) == pytest.approx(2 * 50 / 150)


@pytest.mark.parametrize(("distance", "matched"), [(0.49, 1.0), (0.51, 0.0)])
def test_half_a_metre_is_the_border_of_a_match(distance: float, matched: float) -> None:
    found = tracks(np.stack([straight(side=0.0)]), np.stack([straight(side=distance)]))
    assert idf1(found) == matched


def test_without_predictions_everything_is_missed() -> None:
    nothing = tracks(np.stack([straight(side=0.0)]), np.empty((0, 100, 3)))
    assert (hota(nothing), assa(nothing), idf1(nothing)) == (0, 0, 0)
    assert (id_switches(nothing), fragmentations(nothing)) == (0, 0)


def _as_trackeval_reads_it(ours: Tracks) -> dict[str, object]:
    return {
        "num_timesteps": len(ours.moments),
        "num_gt_ids": len(ours.truth_frames),
        "num_tracker_ids": len(ours.predicted_frames),
        "num_gt_dets": int(ours.truth_frames.sum()),
        "num_tracker_dets": int(ours.predicted_frames.sum()),
        "gt_ids": [moment.truth for moment in ours.moments],
        "tracker_ids": [moment.predicted for moment in ours.moments],
        "similarity_scores": [moment.similarity for moment in ours.moments],
    }
