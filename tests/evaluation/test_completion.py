"""Completion on hidden frames: errors of a known size, recall, coverage of the surface, by length."""

import numpy as np
import pytest
from known import LEFT, RIGHT, crossing, perfect, with_rows, without_rows

from evaluation.completion import point_errors
from evaluation.scores import completion_by_length, evidence_of, scores
from recording.motions import OBSERVED, Motions
from recording.recording import Recording
from recording.visibility import visibility_of


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return perfect(recording)


def completion(recording: Recording, motions: Motions) -> dict[str, float | None]:
    return scores(recording, motions)["completion"]


def shifted(motions: Motions, metres: float) -> Motions:
    """Every completed point moved upwards."""
    position = motions.position.copy()
    position[~motions.observed, 1] -= metres
    return with_rows(motions, position=position)


@pytest.mark.parametrize(
    ("metres", "within"),
    [(0.005, (1, 1, 1, 1)), (0.03, (0, 1, 1, 1)), (0.12, (0, 0, 1, 1)), (0.5, (0, 0, 0, 1)), (0.7, (0, 0, 0, 0))],
)
def test_a_known_error_is_measured(recording: Recording, motions: Motions, metres: float, within: tuple) -> None:
    found = completion(recording, shifted(motions, metres))
    for name in ("median_m", "mean_m", "p95_m", "max_m"):
        assert found[name] == pytest.approx(metres, abs=1e-5)
    assert tuple(found[f"within_{cm}cm"] for cm in (1, 4, 16, 64)) == within


def test_the_centre_errs_as_its_representative_does(recording: Recording, motions: Motions) -> None:
    found = completion(recording, shifted(motions, 0.3))
    assert found["centre_max_m"] == pytest.approx(0.3, abs=1e-5)
    # In three of the 20 hidden frames the squares stick out, and what is observed pulls the mean back.
    assert 0.29 < found["centre_mean_m"] < 0.3


def test_only_hidden_frames_count(recording: Recording, motions: Motions) -> None:
    visibility = visibility_of(recording)
    number = np.where(motions.motion == LEFT, 0, 1)
    visible = ~visibility.hidden[number, motions.frame]
    position = motions.position.copy()
    position[visible & ~motions.observed] += 5.0
    assert completion(recording, with_rows(motions, position=position))["max_m"] < 1e-5


def test_what_was_never_seen_before_is_measured_from_the_first_time_after(
    recording: Recording, motions: Motions
) -> None:
    backwards = without_rows(motions, motions.observed & (motions.frame < 18))
    evidence = evidence_of(recording, backwards)
    errors = point_errors(recording, backwards, evidence.observations, evidence.visibility)
    assert len(errors.error_m) == (~motions.observed & hidden_rows(recording, motions)).sum()
    assert errors.error_m.max() < 1e-5


def test_the_point_last_seen_is_what_counts(recording: Recording, motions: Motions) -> None:
    """A trajectory that jumps to another material point before the hole is held against that one."""
    rows = np.flatnonzero(motions.trajectory == motions.trajectory[motions.motion == LEFT][0])
    seen = rows[motions.observed[rows]]
    last = seen[motions.frame[seen] < 18][-1]
    column_row = motions.column_row.copy()
    column_row[last] += [0.0, 2.0]  # Two pixels down, 15 cm at 3 m.
    evidence = evidence_of(recording, with_rows(motions, column_row=column_row))
    errors = point_errors(recording, evidence.motions, evidence.observations, evidence.visibility)
    assert errors.error_m.max() == pytest.approx(0.15, abs=1e-5)


def test_recall_is_lost_with_the_points(recording: Recording, motions: Motions) -> None:
    left_out = ~motions.observed & (motions.motion == RIGHT)
    found = completion(recording, without_rows(motions, left_out))
    assert found["hidden_object_frames"] == 20
    assert found["recall"] == pytest.approx(9 / 20)  # The left square is hidden for 9 frames, the right one for 11.
    assert found["surface_coverage_10cm"] < 0.7
    assert found["max_m"] < 1e-5


def test_recall_asks_for_half_of_the_surface(recording: Recording, motions: Motions) -> None:
    top_only = ~motions.observed & (motions.position[:, 1] > -0.4)
    found = completion(recording, without_rows(motions, top_only))
    assert found["recall"] == 0  # 10 cm of points reach 25 cm further: 35 of 100 cm.
    assert 0 < found["surface_coverage_10cm"] < 0.3


def test_a_motion_completed_elsewhere_recalls_nothing(recording: Recording, motions: Motions) -> None:
    found = completion(recording, shifted(motions, 3.0))
    assert (found["recall"], found["surface_coverage_10cm"]) == (0, 0)


def test_observed_points_are_no_completion(recording: Recording, motions: Motions) -> None:
    found = completion(recording, without_rows(motions, ~motions.observed))
    assert (found["recall"], found["surface_coverage_10cm"]) == (0, 0)
    assert found["median_m"] is None


def test_errors_and_recall_are_told_by_length(recording: Recording, motions: Motions) -> None:
    left_out = ~motions.observed & (motions.motion == RIGHT)
    short, long = completion_by_length(evidence_of(recording, without_rows(motions, left_out)))
    assert (short.hidden_frames, short.object_frames, short.recall) == (9, 9, 1)
    assert (long.hidden_frames, long.object_frames, long.recall, long.points) == (11, 11, 0, 0)
    assert long.median_m is None


def test_x_rays_without_meshes_leave_only_the_errors_of_points_open(recording: Recording, motions: Motions) -> None:
    """As an imported recording has it whose objects' whole depth is known."""
    without_meshes = Recording(metadata=recording.metadata, frames=recording.frames, xray=recording.xray)
    found = completion(without_meshes, motions)
    assert {name for name, value in found.items() if value is None} == {
        *("median_m", "mean_m", "p95_m", "max_m"),
        *(f"within_{cm}cm" for cm in (1, 4, 16, 64)),
    }
    assert found["recall"] == 1


def hidden_rows(recording: Recording, motions: Motions) -> np.ndarray:
    hidden = visibility_of(recording).hidden
    assert (motions.source[motions.observed] == OBSERVED).all()
    return hidden[np.where(motions.motion == LEFT, 0, 1), motions.frame]
