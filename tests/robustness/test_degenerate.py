"""Degenerate scenes: the solver never raises, never hangs, and says what it found."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from worlds import box, plane, recorded, recording_of, small_camera, sphere

import unocclude
from recording.recording import Recording

WALL = plane(lambda _: 4.0)
CAMERA = small_camera(64, 48)


def crossing(frame: int) -> tuple[float, float, float]:
    return (-0.8 + 0.04 * frame, 0.0, 2.0)


def ball(frames: int) -> Recording:
    return recorded([WALL, sphere(crossing, 0.25)], frames=frames, moving=[False, True], camera=CAMERA)


def changed(recording: Recording, change: Callable[[int, np.ndarray], np.ndarray]) -> Recording:
    return recording_of([change(number, frame.depth) for number, frame in enumerate(recording.frames)])


def one_point(frame: int) -> np.ndarray:
    depth = np.full((48, 64), np.nan)
    depth[20, 10 + frame] = 2.0
    return depth


def hidden_for_ever() -> Recording:
    """A ball that passes before another one, which comes out nowhere."""
    before = box(lambda _: (0, 0, 1.5), (0.6, 0.6, 0.05))
    late = sphere(lambda frame: (-0.8 + 0.04 * min(frame, 20), 0.0, 2.0), 0.2)
    return recorded([WALL, before, late], frames=30, moving=[False, False, True], camera=CAMERA)


def alike() -> Recording:
    """All that is seen moves as one."""
    return recorded([plane(lambda frame: 3.0 - 0.03 * frame)], frames=20, moving=[True], camera=CAMERA)


SCENES: dict[str, tuple[Callable[[], Recording], tuple[int, int]]] = {
    "empty": (lambda: recording_of([np.full((48, 64), np.nan)] * 5), (0, 0)),
    "one frame": (lambda: ball(1), (0, 0)),
    "two frames": (lambda: ball(2), (0, 0)),
    "one point": (lambda: recording_of([one_point(frame) for frame in range(12)]), (0, 1)),
    "nothing moves": (lambda: recorded([WALL], frames=12, moving=[False], camera=CAMERA), (0, 0)),
    "everything moves alike": (alike, (0, 12)),
    "one object for ever hidden": (hidden_for_ever, (0, 3)),
    "all points lost in the middle frame": (
        lambda: changed(ball(30), lambda number, depth: np.where(number == 15, np.nan, depth)),
        (1, 2),
    ),
    "a picture of one pixel": (lambda: recording_of([np.full((1, 1), 2 + 0.1 * frame) for frame in range(9)]), (0, 1)),
    "a picture of one row": (
        lambda: recording_of([np.where(np.arange(60)[None] // 8 == frame, 1.0, 3.0) for frame in range(7)]),
        (0, 7),
    ),
    "noise": (
        lambda: recording_of(list(np.random.default_rng(1).uniform(0.5, 9, (12, 24, 32)))),
        (0, 60),
    ),
    "the nearest depths there are": (
        lambda: recording_of([np.full((12, 16), 1e-4 * (1 + f)) for f in range(8)]),
        (0, 1),
    ),
    "the farthest depths there are": (
        lambda: recording_of([np.full((12, 16), 1e5 - 1e3 * f) for f in range(8)]),
        (0, 1),
    ),
}


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("name", SCENES)
def test_a_degenerate_scene_is_solved(name: str, preset: str) -> None:
    make, (fewest, most) = SCENES[name]
    recording = make()
    motions = unocclude.solve(recording, unocclude.preset_settings(preset))
    assert len(motions.motion_ids) <= 60
    if preset == "default":
        assert fewest <= len(motions.motion_ids) <= most
    assert np.isfinite(motions.position).all()
    assert ((motions.frame >= 0) & (motions.frame < recording.metadata.frames)).all()


def said(recording: Recording, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    unocclude.save_recording(recording, folder / "degenerate")
    with pytest.raises(SystemExit) as ended:
        unocclude.main(["solve", str(folder / "degenerate")])
    assert ended.value.code == 0
    return capsys.readouterr().err


@pytest.mark.parametrize("name", ["empty", "one frame", "nothing moves"])
def test_it_says_what_it_found(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = said(SCENES[name][0](), tmp_path, capsys)
    assert re.search(r"solved .*: 0 motions in ", line)


@pytest.mark.soak
@pytest.mark.parametrize("name", ["300 frames", "1,280x960"])
def test_a_long_or_large_scene_is_solved(name: str) -> None:
    if name == "300 frames":
        around = sphere(lambda frame: (0.7 * np.cos(frame / 20), 0.0, 2 + 0.5 * np.sin(frame / 20)), 0.2)
        recording = recorded([WALL, around], frames=300, moving=[False, True], camera=CAMERA)
    else:
        large = small_camera(1280, 960)
        recording = recorded([WALL, sphere(crossing, 0.25)], frames=3, moving=[False, True], camera=large)
    motions = unocclude.solve(recording)
    assert len(motions.motion_ids) == (1 if name == "300 frames" else 0)
