"""How trajectories drift and flows err, held against recordings whose motion is known."""

from functools import cache

import numpy as np
import pytest

import unocclude
from algorithm.given import Given
from algorithm.lifting import SceneFlow
from algorithm.pipeline import followed_points
from algorithm.settings import Settings
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories
from evaluation.drift import drift_of
from evaluation.flow_errors import flow_errors
from evaluation.oracles import true_flow
from recording.correspondence import flow_between, places_of
from recording.errors import InputError
from recording.recording import Recording, stripped


@cache
def wall() -> Recording:
    return unocclude.simulate("wall", size="96x72", frames=12)


def perfect(frames: int = 8) -> Trajectories:
    """Every moving pixel of frame 0, followed by the truth."""
    recording = wall()
    labels = recording.frames[0].labels
    assert labels is not None
    moving = np.isin(labels.objectid, recording.moving_ids)
    places = np.stack([places_of(recording, 0, at=at)[moving] for at in range(frames)], axis=1)
    column_row, _ = recording.camera.pixel_from_world(places)
    inside = recording.camera.contains(column_row).all(axis=1)
    places, column_row = places[inside], column_row[inside]
    return Trajectories(
        trajectory=np.repeat(np.arange(len(places)), frames),
        frame=np.tile(np.arange(frames), len(places)),
        position=places.reshape(-1, 3),
        column_row=column_row.reshape(-1, 2),
    )


def test_the_truth_does_not_drift() -> None:
    drift = drift_of(wall(), perfect())
    assert drift.metres.max() < 1e-4
    assert not drift.ends_astray.any()
    assert drift.median_at(5) < 1e-4
    assert drift.length.tolist() == [8] * len(drift.length)
    assert 0.3 < drift.covered_within(0.01) <= drift.coverage <= 1.0


@pytest.mark.parametrize("off", [0.03, 0.2])
def test_a_trajectory_that_moves_aside_drifts_by_as_much(off: float) -> None:
    true = perfect()
    shifted = Trajectories(
        trajectory=true.trajectory,
        frame=true.frame,
        position=true.position + np.where(true.frame[:, None] > 0, [0.0, 0.0, off], 0.0),
        column_row=true.column_row,
    )
    drift = drift_of(wall(), shifted)
    assert drift.median_at(1) == pytest.approx(off, abs=1e-4)
    first = int((np.isin(_objects(0), wall().moving_ids)).sum())
    assert np.isfinite(drift.nearest_m[:first]).any()
    assert drift.covered_within(off - 0.01) < drift.coverage


def _objects(frame: int) -> np.ndarray:
    labels = wall().frames[frame].labels
    assert labels is not None
    return labels.objectid


def test_short_trajectories_cover_nothing() -> None:
    assert drift_of(wall(), perfect(frames=4)).coverage == 0.0


def test_true_flow_drifts_less_than_our_own() -> None:
    recording, settings = wall(), Settings()
    drifts = [
        drift_of(recording, followed_points(recording, settings, Stopwatch(), given).trajectories)
        for given in (Given(), true_flow(recording))
    ]
    assert drifts[1].median_at(5) < 0.5 * drifts[0].median_at(5)


def test_without_truth_there_is_no_drift() -> None:
    with pytest.raises(InputError, match="expected a recording with its truth"):
        drift_of(stripped(wall()), perfect())


def test_the_true_flow_has_no_error_and_no_flow_has_the_motion_as_its_error() -> None:
    recording = wall()
    truth = flow_between(recording, 3, 4)
    start, end = (recording.camera.pixel_from_world(places_of(recording, 3, at=at))[1] for at in (3, 4))
    exact = SceneFlow(column_row=np.nan_to_num(truth.pixels).astype(np.float32), depth=(end - start).astype(np.float32))
    right = flow_errors(recording, exact, 3, 4)
    assert right.pixels.max() < 1e-3
    assert right.metres.max() < 1e-3
    still = SceneFlow(column_row=np.zeros_like(exact.column_row), depth=np.zeros_like(exact.depth))
    counts = np.isin(_objects(3), recording.moving_ids) & truth.visible
    wrong = flow_errors(recording, still, 3, 4)
    np.testing.assert_allclose(wrong.pixels, np.linalg.norm(truth.pixels, axis=-1)[counts], atol=1e-5)
    np.testing.assert_allclose(wrong.metres, np.linalg.norm(truth.metres, axis=-1)[counts], atol=1e-5)
    assert ((wrong.height_share >= 0) & (wrong.height_share <= 1)).all()
