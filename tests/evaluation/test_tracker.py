"""The practitioner's baseline: filter and smoother against known answers, crossing squares, bad weather."""

import numpy as np
import pytest
from known import crossing, leaves
from passing import seen_at, straight
from worlds import recording_of

from evaluation.carried import DetectionTrack, motions_of_tracks
from evaluation.detections import DetectorSettings, MovingPoints, detections_of, moving_points
from evaluation.scores import evaluate
from evaluation.tracker import State, TrackerSettings, predicted, smoothed, track_motions, tracked_detections, updated
from recording.checks import validated
from recording.errors import InputError
from recording.motions import INTER, NOISE, Making, Motions
from recording.recording import Recording

FPS = 30.0


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return track_motions(recording)


def test_a_constant_speed_is_predicted_exactly() -> None:
    state = State(mean=np.array([[1.0, 2.0, 3.0], [0.5, 0.0, -1.0]]), covariance=np.zeros((2, 2)))
    ahead = predicted(state, seconds=2.0, acceleration_m_per_s2=0.0)
    np.testing.assert_allclose(ahead.mean, [[2.0, 2.0, 1.0], [0.5, 0.0, -1.0]])
    np.testing.assert_allclose(ahead.covariance, 0.0)


def test_filter_and_smoother_are_least_squares_where_the_speed_is_constant() -> None:
    """Without acceleration and with hardly a prior, the smoothed places are the straight line of best fit."""
    generator = np.random.default_rng(3)
    time = np.arange(12) / FPS
    seen = generator.normal(size=(12, 3))
    wide = State(mean=np.zeros((2, 3)), covariance=np.diag([1e8, 1e8]))
    expected, believed = [wide], [updated(wide, seen[0], measurement_m=0.1)]
    for place in seen[1:]:
        expected.append(predicted(believed[-1], seconds=1 / FPS, acceleration_m_per_s2=0.0))
        believed.append(updated(expected[-1], place, measurement_m=0.1))
    line = np.stack([np.polyval(np.polyfit(time, seen[:, axis], 1), time) for axis in range(3)], axis=1)
    np.testing.assert_allclose(believed[-1].mean[0], line[-1], atol=1e-4)
    states = smoothed(tuple(expected), tuple(believed), seconds=1 / FPS)
    np.testing.assert_allclose([state.mean[0] for state in states], line, atol=1e-3)


def test_a_coasting_track_goes_on_straight_and_is_found_again() -> None:
    places = straight((0, 0, 3), (0.05, 0, 0), 40)
    truth = places.copy()
    places[15:25] = np.nan
    settings = TrackerSettings(coast_seconds=1.0)
    (track,) = tracked_detections(detections_of(seen_at(places), settings), settings, frames=40, fps=FPS)
    assert (track.first, len(track.detections), len(track.position)) == (0, 30, 40)
    assert np.linalg.norm(track.position - truth, axis=1).max() < 0.03


def test_a_track_that_coasts_for_too_long_ends_with_its_last_detection() -> None:
    places = straight((0, 0, 3), (0.05, 0, 0), 40)
    places[15:25] = np.nan
    settings = TrackerSettings(coast_seconds=0.2, shortest_seconds=0.1)
    tracks = tracked_detections(detections_of(seen_at(places), settings), settings, frames=40, fps=FPS)
    assert [(track.first, len(track.position)) for track in tracks] == [(0, 15), (25, 15)]


def test_what_stands_still_is_one_track_of_no_speed() -> None:
    places = np.tile([0.0, 0.0, 3.0], (20, 1))
    settings = TrackerSettings()
    (track,) = tracked_detections(detections_of(seen_at(places), settings), settings, frames=20, fps=FPS)
    np.testing.assert_allclose(track.position, places, atol=1e-6)


def test_points_are_carried_along_with_the_state() -> None:
    places = straight((0, 0, 3), (0.05, 0, 0), 10)
    truth = places.copy()
    places[4:7] = np.nan
    detections = detections_of(seen_at(places), DetectorSettings())
    track = DetectionTrack(detections=np.arange(7), first=0, position=truth)
    motions = motions_of_tracks(detections, [track], carry_frames=1, making=Making())
    carried = ~motions.observed
    assert set(motions.source[carried]) == {INTER}
    assert set(motions.frame[carried]) == {4, 5, 6}
    for frame in (4, 5, 6):
        centre = motions.position[carried & (motions.frame == frame)].mean(axis=0)
        np.testing.assert_allclose(centre, truth[frame], atol=1e-5)
    assert [(link.before, link.after) for link in motions.links] == [(0, 1)]


def test_two_squares_that_cross_are_two_motions() -> None:
    free = crossing(wall=False)
    found = leaves(evaluate(free, track_motions(free)))
    assert (found["motions.found"], found["motions.count"], found["preset"]) == (2, 2, "tracker")
    assert found["motions.purity"] == 1
    assert found["coverage"] > 0.95


def test_motions_are_well_formed(recording: Recording, motions: Motions) -> None:
    key = motions.trajectory.astype(np.int64) * 1000 + motions.frame
    assert (np.diff(key) > 0).all()
    np.testing.assert_array_equal(np.isfinite(motions.column_row).all(axis=1), motions.observed)
    assert (motions.motion[~motions.observed] != NOISE).all()
    assert motions.motion_ids == [entry.motion for entry in motions.representatives]
    assert motions.making.recording_digest == recording.digest()


def test_the_same_recording_gives_the_same_motions(recording: Recording, motions: Motions) -> None:
    again = track_motions(recording)
    for column in ("frame", "trajectory", "position", "motion", "segment"):
        np.testing.assert_array_equal(getattr(again, column), getattr(motions, column))


def test_picture_size_does_not_change_what_is_detected(recording: Recording) -> None:
    points = moving_points(recording)
    thick = [
        MovingPoints(position=np.repeat(one.position, 3, axis=0), column_row=np.repeat(one.column_row, 3, axis=0))
        for one in points
    ]
    settings = DetectorSettings()
    few, many = detections_of(points, settings), detections_of(thick, settings)
    np.testing.assert_array_equal(few.moment, many.moment)
    np.testing.assert_allclose(few.centre, many.centre, atol=1e-9)


@pytest.mark.parametrize("depth", [np.nan, 3.0])
def test_where_nothing_moves_there_is_no_motion(depth: float) -> None:
    still = recording_of([np.full((24, 32), depth, np.float32)] * 8)
    motions = track_motions(still)
    assert motions.motion_ids == []
    assert motions.representatives == ()


def test_unknown_and_impossible_settings_are_refused() -> None:
    with pytest.raises(InputError, match=r"coast_secnds.*did you mean 'coast_seconds'"):
        validated(TrackerSettings, {"coast_secnds": 1.0}, source="settings")
    with pytest.raises(InputError, match="gate"):
        validated(TrackerSettings, {"gate": 0}, source="settings")
