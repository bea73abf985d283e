"""A disk that is full: one line, exit status 2, and nothing half-written."""

import resource
import subprocess
import sys
from pathlib import Path

import pytest
from case import SCENE, WALK

import unocclude

ROOT = Path(__file__).parents[2]
LIMITED = (
    "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500)); "
    "import unocclude; unocclude.main(sys.argv[1:])"
)
COMMANDS = {
    "simulate": ["simulate", "{place}/small.toml", "-o", "{out}", "--backend", "scalar"],
    "solve": ["solve", "{place}/small", "-o", "{out}/motions.parquet", "--no-cache"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_disk_is_one_line_and_leaves_nothing(command: str, tmp_path: Path) -> None:
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    (tmp_path / "small.toml").write_text(SCENE + WALK, encoding="utf-8")
    unocclude.save_recording(unocclude.simulate(tmp_path / "small.toml", backend="scalar"), tmp_path / "small")
    out = tmp_path / "out"
    words = [word.format(place=tmp_path, out=out) for word in COMMANDS[command]]
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, *words], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "cannot be written" in done.stderr
    assert not [path for path in out.rglob("*") if path.is_file()]
