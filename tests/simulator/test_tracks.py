"""Everybody of a trajectory file: resampled at any rate, straight on before and after, apart after a long gap."""

from pathlib import Path

import numpy as np
import pytest

from simulator.tracks import STEP_S, Tracks, tracks_of


def place_at(time: np.ndarray) -> np.ndarray:
    """A curve walked at about 1.3 m/s, metres."""
    return np.stack([-2 + 1.2 * time, 0.5 + 0.4 * np.sin(time)], axis=-1)


def written(folder: Path, times: np.ndarray, *, fps: float, scale: float = 1.0, person: int = 1) -> Path:
    rows = zip(np.round(times * fps).tolist(), (scale * place_at(times)).tolist(), strict=True)
    with (folder / "walks.txt").open("a") as file:
        file.writelines(f"{person} {frame:g} {x} {y}\n" for frame, (x, y) in rows)
    return folder / "walks.txt"


def only(tracks: Tracks) -> np.ndarray:
    assert len(tracks.tracks) == 1
    return tracks.tracks[0].places


@pytest.mark.parametrize(("fps", "metres"), [(2.5, 1.0), (10, 0.01), (25, 1.0), (60, 0.01)])
def test_any_rate_and_unit_make_the_same_track(tmp_path: Path, fps: float, metres: float) -> None:
    times = np.arange(0, 4 * fps + 1) / fps
    path = written(tmp_path, times, fps=fps, scale=1 / metres)
    tracks = tracks_of(path, fps=float(fps), metres=metres)
    np.testing.assert_allclose(only(tracks), place_at(STEP_S * np.arange(41)), atol=0.01)
    assert tracks.seconds == pytest.approx(4.0)


def test_before_and_after_the_record_somebody_walks_straight_on(tmp_path: Path) -> None:
    path = written(tmp_path, np.arange(20, 40) / 10, fps=10)
    written(tmp_path, np.arange(0, 60) / 10, fps=10, person=2)
    track = tracks_of(path, fps=10.0, metres=1.0).tracks[0]
    times = np.arange(0.0, 6.01, 0.25)
    assert track.recorded(times).tolist() == ((times >= 2.0) & (times <= 3.9)).tolist()
    velocity = np.diff(track.at(times), axis=0) / 0.25
    assert np.linalg.norm(np.diff(velocity, axis=0), axis=1).max() < 0.25  # No jump where the record begins or ends.
    np.testing.assert_allclose(np.diff(velocity[times[:-1] > 4.0], axis=0), 0.0, atol=1e-9)


def test_who_is_lost_for_long_comes_back_as_somebody_else(tmp_path: Path) -> None:
    times = np.arange(0, 100) / 10
    path = written(tmp_path, times[(times < 3) | (times > 6)], fps=10)
    assert len(tracks_of(path, fps=10.0, metres=1.0).tracks) == 2


def test_a_short_gap_is_bridged_and_a_moment_is_nobody(tmp_path: Path) -> None:
    times = np.arange(0, 40) / 10
    path = written(tmp_path, times[(times < 1) | (times > 2)], fps=10)
    written(tmp_path, np.array([0.5]), fps=10, person=2)
    np.testing.assert_allclose(only(tracks_of(path, fps=10.0, metres=1.0)), place_at(times), atol=0.01)
