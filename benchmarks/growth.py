"""How time and memory of segmentation and completion grow with the number of trajectories, from 1 to 64 times as many.

The trajectories of one recording are repeated: far apart in space (a larger crowd), or one recording after the other in
time (a longer recording). Every point is measured in a process of its own; compiling is not counted. Seconds are those
that the processor has worked, so that other work on the machine does not count. The exponent is the slope of their
logarithm over that of the number, by least squares. Takes about a quarter of an hour.
"""

import json as json_format
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

import numpy as np
from cyclopts import App, Parameter

import unocclude
from algorithm.followed import Followed
from algorithm.patches import Patches
from algorithm.pipeline import completed_motions, followed_points, segmented
from algorithm.settings import Preset, Settings, preset_settings
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories
from benchmarks.repeating import ARMS, Arm, chosen, repeated
from benchmarks.tables import Row, run, show
from recording.recording import Recording
from recording.store import load_recording, save_recording

app = App(help=__doc__)
Several = Parameter(consume_multiple=True, negative="")
STAGES = ("segmentation", "completion")
MEGABYTE = 1024
"""Kilobytes, in which Linux counts the largest memory."""


@app.default
def growth(  # noqa: PLR0913 - a command has as many arguments as it has options
    *,
    scene: str = "9men",
    seed: int = 1,
    size: str = "2x",
    preset: Preset = "default",
    factors: Annotated[tuple[int, ...], Several] = (1, 2, 4, 8, 16, 32, 64),
    most: int = 1_000_000,
    json: bool = False,
) -> None:
    """Print a row for each number of trajectories, then the exponents.

    Args:
        scene: Name of the scene whose trajectories are repeated.
        seed: Its seed.
        size: Its picture size.
        preset: Settings to solve with.
        factors: How many times as many trajectories.
        most: Trajectories at the largest factor, at the most: of the scene's own as many are taken as make that.
        json: One JSON object in place of the table.
    """
    recording = unocclude.simulate(scene, seed=seed, size=size)
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        save_recording(recording, Path(folder) / "recording")
        _save_followed(recording, Path(folder), preset, at_most=most // max(factors))
        for arm in ARMS:
            own = [_measured_apart(Path(folder), preset, arm, factor) for factor in factors]
            rows += [*own, {"repeated in": arm, "times": "exponent", **_exponents(own)}]
    show(f"{preset}, {scene}, seed {seed}, {size}", rows, as_json=json)


@app.command(name="point", show=False)
def point(folder: Path, preset: Preset, arm: Arm, factor: int) -> None:
    """Measure one point and print it as JSON; the benchmark calls it for itself."""
    settings, few = preset_settings(preset), _load_followed(folder)
    some = np.arange(few.trajectories.count) < few.trajectories.count // 10
    _stages(chosen(few, some), settings)  # Compiles what is compiled.
    many = repeated(few, factor, arm, pause_frames=int(2 * Settings().longest_hole_seconds * few.fps))
    seconds, largest_mb = _stages(many, settings)
    row: Row = {"repeated in": arm, "times": str(factor)}
    row |= {"trajectories": many.trajectories.count, "points": len(many.trajectories.frame)}
    for stage in STAGES:
        row |= {f"{stage} s": seconds[stage], f"{stage} MB": largest_mb[stage]}
    print(json_format.dumps(row))


def _stages(followed: Followed, settings: Settings) -> tuple[dict[str, float], dict[str, float]]:
    """Seconds of work, and the largest memory of the process so far in megabytes, of segmentation and completion."""
    moments, largest_mb = [time.process_time()], []
    segments = segmented(followed, settings, Stopwatch())
    moments.append(time.process_time())
    largest_mb.append(_largest_memory_mb())
    completed_motions(followed, segments, settings)
    moments.append(time.process_time())
    largest_mb.append(_largest_memory_mb())
    seconds = np.diff(moments).tolist()
    return dict(zip(STAGES, seconds, strict=True)), dict(zip(STAGES, largest_mb, strict=True))


def _largest_memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MEGABYTE


def _save_followed(recording: Recording, folder: Path, preset: Preset, *, at_most: int) -> None:
    """Store the recording's trajectories, or as many of them as are asked for, evenly chosen."""
    found = followed_points(recording, preset_settings(preset), Stopwatch())
    count = found.trajectories.count
    kept = np.zeros(count, bool)
    kept[np.linspace(0, count - 1, min(count, at_most)).astype(int)] = True
    some = chosen(found, kept)
    columns = {
        entry.name: getattr(part, entry.name) for part in (some.trajectories, some.patches) for entry in fields(part)
    }
    np.savez(folder / "followed.npz", spacing_m=some.spacing_m, **columns)


def _load_followed(folder: Path) -> Followed:
    recording = load_recording(folder / "recording")
    with np.load(folder / "followed.npz") as stored:
        return Followed(
            trajectories=Trajectories(**{entry.name: stored[entry.name] for entry in fields(Trajectories)}),
            patches=Patches(**{entry.name: stored[entry.name] for entry in fields(Patches)}),
            spacing_m=float(stored["spacing_m"]),
            camera=recording.camera,
            fps=recording.fps,
            frames=recording.metadata.frames,
        )


def _measured_apart(folder: Path, preset: Preset, arm: Arm, factor: int) -> Row:
    """One point, measured in a process of its own; where that ends badly, its last line in place of numbers."""
    command = [sys.executable, __file__, "point", str(folder), preset, arm, str(factor)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
        return {"repeated in": arm, "times": str(factor), "failed": reason}
    row: dict[str, Any] = json_format.loads(done.stdout)
    return row


def _exponents(rows: list[Row]) -> Row:
    """The slope of log time over log number of each stage, over the rows that have both."""
    found: Row = {}
    for stage in STAGES:
        known = [(row["trajectories"], row[f"{stage} s"]) for row in rows if "trajectories" in row]
        if len(known) > 1:
            number, seconds = np.log(np.array(known, float)).T
            found[f"{stage} s"] = float(np.polyfit(number, seconds, 1)[0])
    return found


if __name__ == "__main__":
    run(app)
