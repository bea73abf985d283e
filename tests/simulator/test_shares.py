"""Frames made by several processes: the same bytes, and nothing left behind where one of them fails."""

import subprocess
from pathlib import Path
from typing import Any

import pytest

from recording import workers
from recording.errors import InputError
from recording.store import load_recording
from recording.verify import verify
from simulator import shares
from simulator.backend import find_backend
from simulator.scene import Scene
from simulator.simulate import Simulation, prepared, write_simulation

SMALL: dict[str, Any] = {
    "name": "small",
    "frames": 5,
    "fps": 10,
    "camera": {"width": 48, "height": 36, "position": [0, -4, 1.5], "look_at": [0, 0, 1]},
    "balls": [
        {"radius": 0.3, "waypoints": [[1, 0, 1], [0.5, 0, 1.4]], "times": [0, 0.4]},
        {"radius": 0.2, "waypoints": [[9, 0, 1], [8, 0, 1]], "times": [0, 0.4]},
    ],
    "obstacles": [{"name": "post", "shape": "cylinder", "radius": 0.2, "height": 1.5, "position": [0.3, -0.8, 0]}],
}


@pytest.fixture(scope="module")
def small() -> Simulation:
    return prepared(Scene.model_validate(SMALL))


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_number_of_workers_changes_no_byte(small: Simulation, tmp_path: Path) -> None:
    for count in (1, 2, 7):  # Seven are more than there are frames.
        write_simulation(small, tmp_path / str(count), workers=count)
    one = contents(tmp_path / "1")
    assert len(one) == 12
    assert one == contents(tmp_path / "2") == contents(tmp_path / "7")
    assert verify(load_recording(tmp_path / "2")).passes


@pytest.mark.parametrize("count", [1, 2])
def test_what_a_worker_cannot_write_is_one_line(small: Simulation, tmp_path: Path, count: int) -> None:
    nowhere = tmp_path / "nowhere"
    written = shares.written_pictures(
        small.stage, nowhere, metadata=small.metadata, backend=find_backend(), workers=count
    )
    with pytest.raises(InputError, match=r"nowhere/frames/00000[01]\.exr: cannot be written") as refused:
        list(written)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("command", "error", "message"),
    [
        ("import os; os.kill(os.getpid(), 9)", InputError, "ended by signal 9: .*pass fewer workers"),
        ("import sys; sys.stdin.buffer.read(); sys.exit(3)", RuntimeError, "failed with exit status 3"),
    ],
)
def test_a_worker_that_fails_leaves_nothing(
    small: Simulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, error: type, message: str
) -> None:
    monkeypatch.setattr(workers, "_COMMAND", command)
    with pytest.raises(error, match=message):
        write_simulation(small, tmp_path / "new", workers=2)
    assert list(tmp_path.iterdir()) == []


def test_who_stops_asking_stops_the_workers(small: Simulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    start = workers._started
    monkeypatch.setattr(workers, "_started", lambda: started.append(start()) or started[-1])
    (tmp_path / "frames").mkdir()
    written = shares.written_pictures(small.stage, tmp_path, metadata=small.metadata, backend=find_backend(), workers=2)
    next(written)
    written.close()
    assert len(started) == 2
    assert all(worker.poll() is not None for worker in started)


def test_no_worker_is_refused(small: Simulation, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="at least one worker, got 0"):
        write_simulation(small, tmp_path / "new", workers=0)
