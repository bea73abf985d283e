"""Killed at any moment, a command leaves nothing half-written under a final name, and the next run completes."""

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest
from case import FAMILY, SCENE, WALK

import unocclude

ROOT = Path(__file__).parents[2]
PROGRAM = "import sys, unocclude; print('ready', flush=True); unocclude.main(sys.argv[1:])"
FOCAL = ["--fx", "20", "--fy", "20", "--cx", "12", "--cy", "9", "--fps", "15"]
COMMANDS = {
    "simulate": ["simulate", "{place}/small.toml", "-o", "{out}", "--backend", "scalar"],
    "import": ["import", "{place}/images", *FOCAL, "-o", "{out}/images"],
    "solve": ["solve", "{place}/small", "-o", "{out}/motions.parquet", "--no-cache"],
    "export": ["export", "{place}/small", "--format", "ply", "-o", "{out}/clouds"],
    "generate": [
        "generate",
        "{place}/tiny.toml",
        "--count",
        "2",
        "-o",
        "{out}",
        "--backend",
        "scalar",
        "--workers",
        "1",
    ],
}


@dataclass(frozen=True, kw_only=True)
class Known:
    """What a command makes where nobody kills it."""

    place: Path
    contents: dict[str, dict[str, bytes]]
    seconds: dict[str, float]


def arguments(command: str, place: Path, out: Path) -> list[str]:
    return [word.format(place=place, out=out) for word in COMMANDS[command]]


def ended(words: list[str]) -> int:
    with pytest.raises(SystemExit) as stop:
        unocclude.main([*words, "--quiet"])
    return int(stop.value.code or 0)


def contents(out: Path) -> dict[str, bytes]:
    """Every file's bytes; of motions the rows, for they tell how long they took."""
    found = {}
    for path in sorted(out.rglob("*")):
        if path.suffix == ".parquet":
            found[path.name] = b"".join(unocclude.load_motions(path).position)
        elif path.is_file():
            found[str(path.relative_to(out))] = path.read_bytes()
    return found


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Known:
    place = tmp_path_factory.mktemp("place")
    (place / "small.toml").write_text(SCENE + WALK, encoding="utf-8")
    (place / "tiny.toml").write_text(FAMILY, encoding="utf-8")
    recording = unocclude.simulate(place / "small.toml", backend="scalar")
    unocclude.save_recording(recording, place / "small")
    unocclude.save_motions(unocclude.solve(recording), place / "small" / "motions.parquet")
    (place / "images").mkdir()
    for number, frame in enumerate(recording.frames):
        millimetres = np.nan_to_num(1000 * frame.depth).astype(np.uint16)
        cv2.imwrite(str(place / "images" / f"{number}.png"), millimetres)
    made, seconds = {}, {}
    for command in COMMANDS:
        begun = time.monotonic()
        assert ended(arguments(command, place, place / f"out_{command}")) == 0
        seconds[command] = time.monotonic() - begun
        made[command] = contents(place / f"out_{command}")
    return Known(place=place, contents=made, seconds=seconds)


def killed_after(seconds: float, words: list[str]) -> bool:
    """Whether the command was still at work so long after it began."""
    program = [sys.executable, "-c", PROGRAM, *words, "--quiet"]
    running = subprocess.Popen(program, cwd=ROOT, stdout=subprocess.PIPE, start_new_session=True)
    assert running.stdout is not None
    with running.stdout as said:
        said.readline()
        time.sleep(seconds)
        os.killpg(running.pid, signal.SIGKILL)
        return running.wait() == -signal.SIGKILL


def final(out: Path) -> Iterator[tuple[str, bytes]]:
    """The files under final names: a name that begins with a dot is at work."""
    for name, content in contents(out).items():
        if not any(part.startswith(".") for part in Path(name).parts):
            yield name, content


def check_kill(command: str, known: Known, out: Path, share: float) -> bool:
    """Kill a run after a share of the time that it takes, and hold what is left and what comes next against it."""
    words = arguments(command, known.place, out)
    killed = killed_after(share * known.seconds[command], words)
    for name, content in final(out):
        assert content == known.contents[command][name], name
    names = {Path(name).parts[0] for name, _ in final(out)}
    whole = {name for name in known.contents[command] if Path(name).parts[0] in names}
    assert {name for name, _ in final(out)} == whole
    status = ended(words)
    assert status == 0 or (status == 2 and whole)  # What is there already is not overwritten.
    assert contents(out) == known.contents[command]
    return killed


@pytest.mark.parametrize("command", COMMANDS)
def test_a_killed_run_leaves_nothing_half_written(command: str, known: Known, tmp_path: Path) -> None:
    check_kill(command, known, tmp_path / "out", 0.5)


@pytest.mark.soak
@pytest.mark.parametrize("command", COMMANDS)
def test_many_killed_runs_leave_nothing_half_written(command: str, known: Known, tmp_path: Path) -> None:
    shares = random.Random(command)
    killed = sum(check_kill(command, known, tmp_path / str(number), shares.uniform(0, 1.2)) for number in range(25))
    assert killed > 5


def test_a_folder_that_was_being_replaced_comes_back(known: Known, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = arguments("simulate", known.place, out)
    assert ended(words) == 0
    (out / "small").rename(out / ".small.old")  # Where a run is killed between its two renames.
    assert ended(words) == 2
    assert contents(out) == known.contents["simulate"]
    assert ended([*words, "--overwrite"]) == 0
    assert contents(out) == known.contents["simulate"]
