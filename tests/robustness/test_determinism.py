"""The same input and settings give the same frames and the same rows, however many workers and threads there are."""

import os
import subprocess
import sys
from pathlib import Path

from case import SCENE, WALK

ROOT = Path(__file__).parents[2]
PROGRAM = """
import hashlib, sys
from pathlib import Path
import unocclude
from simulator.simulate import prepared, write_simulation
scene, out, workers = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
write_simulation(prepared(scene, seed=4, sensor="tof", frames=20), out, backend="scalar", workers=workers)
total = hashlib.sha256()
for path in sorted(path for path in out.rglob("*") if path.is_file()):
    total.update(str(path.relative_to(out)).encode() + path.read_bytes())
motions = unocclude.solve(unocclude.load_recording(out))
for name in ("frame", "trajectory", "position", "column_row", "segment", "motion", "source", "confidence"):
    total.update(getattr(motions, name).tobytes())
print(len(motions), total.hexdigest())
"""


def made(scene: Path, out: Path, number: int) -> str:
    """What a process makes that has so many workers and threads, and a hash seed of its own."""
    threads = dict.fromkeys(("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), str(number))
    environment = os.environ | threads | {"PYTHONHASHSEED": str(number), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-P", "-c", PROGRAM, str(scene), str(out), str(number)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout


def test_frames_and_rows_are_the_same_for_any_number_of_workers(tmp_path: Path) -> None:
    scene = tmp_path / "small.toml"
    scene.write_text(SCENE + WALK, encoding="utf-8")
    one, two = (made(scene, tmp_path / str(number), number) for number in (1, 2))
    assert one == two
    assert int(one.split()[0]) > 0
