"""How much memory a long recording takes to solve: people walk to and fro behind one another, a wall and a pillar.

Each length is solved in a process of its own, by `unocclude solve --max-memory`, without a cache. Beside the largest
memory of that process and its time stand what it estimated before, and what the depth images alone would take. Two
thousand frames of 640x480 pixels take half an hour on two cores.
"""

import re
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import Annotated

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

import psutil
from cyclopts import App, Parameter

from benchmarks.tables import Row, run, show
from recording.cache import GIGABYTE
from recording.errors import InputError
from recording.parquet import load_motions
from recording.store import load_recording
from simulator.simulate import prepared, write_simulation

app = App(help=__doc__)
_FPS = 15
_LANES = {"man": (-1.5, 0.9), "woman": (-0.6, 1.0), "heavy": (0.3, 0.85), "teen": (1.2, 1.1), "man 2": (2.1, 0.95)}
"""Who walks how far away, metres, and how fast, metres a second."""
_REACH_M = 2.6
_SURROUNDINGS = {
    "wall": ([0.9, 0.1, 2.2], [-0.9, -2.4, 0]),
    "background": ([12, 0.1, 4], [0, 5, 0]),
    "floor": ([12, 14, 0.02], [0, 0, -0.02]),
}
"""Sizes and positions, metres."""
_TOLD = re.compile(r"about ([\d.]+) minutes and ([\d.]+) GB")
_SAMPLED_SECONDS = 0.05


@app.default
def long(
    *,
    frames: Annotated[tuple[int, ...], Parameter(consume_multiple=True, negative="")] = (250, 500, 1000, 2000),
    size: str = "640x480",
    max_memory: str = "4GB",
    workers: int = 2,
    json: bool = False,
) -> None:
    """Print a row for each length.

    Args:
        frames: Numbers of frames.
        size: Of the pictures, in pixels.
        max_memory: That the solver may use.
        workers: Processes that simulate.
        json: One JSON object in place of the table.
    """
    rows = []
    for count in frames:
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "lanes.toml"
            scene.write_text(_scene(count), encoding="utf-8")
            write_simulation(prepared(scene, size=size), Path(folder) / "lanes", workers=workers)
            rows.append(_solved(Path(folder) / "lanes", max_memory))
    show(f"{size} pixels, --max-memory {max_memory}", rows, as_json=json)


def _scene(frames: int) -> str:
    """The scene as TOML."""
    lines = [
        f'name = "lanes"\nframes = {frames}\nfps = {_FPS}\nstress_test = true',  # The floor counts as an obstacle.
        "[camera]\nposition = [0, -7.5, 1.5]\nlook_at = [0, 0, 1]\nhorizontal_fov_deg = 50",
    ]
    for number, (name, (lane, speed)) in enumerate(_LANES.items()):
        crossings = int(frames / _FPS * speed / (2 * _REACH_M)) + 3
        way = [[_REACH_M * (-1) ** (number + crossing), lane] for crossing in range(crossings)]
        walker = f'body = "{name.split()[0]}"\nwaypoints = {way}\nspeed = {speed}\nstart = {-0.8 - 0.7 * number:.1f}'
        lines.append(f"[[people]]\n{walker}")
    for name, (size, position) in _SURROUNDINGS.items():
        lines.append(f'[[obstacles]]\nname = "{name}"\nshape = "box"\nsize = {size}\nposition = {position}')
    return "\n\n".join(lines) + "\n"


def _solved(recording: Path, max_memory: str) -> Row:
    """A row of the table: what solving took, and what was expected of it."""
    about = load_recording(recording).metadata
    command = [sys.executable, "-m", "unocclude", "solve", str(recording), "--no-cache", "--max-memory", max_memory]
    begun, largest = time.perf_counter(), 0
    with (recording.parent / "said.txt").open("w+", encoding="utf-8") as said:
        process = psutil.Popen(command, stderr=said, cwd=sys.path[0])
        while process.poll() is None:
            with suppress(psutil.Error):  # It may end just now.
                largest = max(largest, process.memory_info().rss)
            time.sleep(_SAMPLED_SECONDS)
        said.seek(0)
        text = said.read()
    if process.returncode:
        raise InputError(f"solve ended with {process.returncode}: {text.strip()}")
    told = _TOLD.search(text)
    motions = load_motions(recording / "motions.parquet")
    return {
        "frames": about.frames,
        "depth images GB": 4 * about.frames * about.width * about.height / GIGABYTE,
        "rows": len(motions),
        "motions": len(motions.motion_ids),
        "memory GB": largest / GIGABYTE,
        "estimated GB": float(told[2]) if told else None,
        "minutes": (time.perf_counter() - begun) / 60,
        "estimated minutes": float(told[1]) if told else None,
    }


if __name__ == "__main__":
    run(app)
