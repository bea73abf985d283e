"""What sweeps and data sets hold to at scale: speed-up, killed workers, killed commands, overhead, cost.

Each row says what is wanted and what was measured. That points share what they have in common is counted in
`tests/evaluation/sweeps/test_graph.py`. Takes about twenty minutes on two idle cores; `--checks` chooses.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # For the packages beside this folder.

import os
import random
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, Literal

import psutil
from cyclopts import App, Parameter

from algorithm.settings import Settings
from algorithm.staged import solve
from benchmarks.tables import Row, run, show
from evaluation.scores import evaluate, scores
from evaluation.sweeps.graph import SCORES, Trial, trial_of
from evaluation.sweeps.plan import Sweep, load_sweep, points_of, settings_at
from evaluation.sweeps.run import RECORDINGS, swept
from evaluation.sweeps.subject import subjects_of
from evaluation.sweeps.table import read_results
from recording.cache import Cache
from recording.cluster import Client, Task, cluster, finished
from recording.store import load_recording
from recording.verify_set import verify_set
from simulator.family import load_family
from simulator.generate import generate
from simulator.order import Order

app = App(help=__doc__)
Check = Literal["workers", "killed_worker", "killed_sweep", "killed_generate", "overhead", "cost"]
CHECKS: tuple[Check, ...] = ("workers", "killed_worker", "killed_sweep", "killed_generate", "overhead", "cost")
ROOT = Path(__file__).parents[1]
SWEEP = """
name = "scale"
scenes = ["wall"]
frames = 30
seeds = [1, 2]
settings = {flow = "dis"}
[axes]
eps1 = [1.0, 1.5]
eps6 = [0.1, 0.15, 0.2]
"""
MILLION = 1_000_000


@app.default
def main(
    *,
    checks: Annotated[tuple[Check, ...], Parameter(consume_multiple=True, negative="")] = CHECKS,
    kills: int = 10,
    seed: int = 1,
    json: bool = False,
) -> None:
    """Print a row a check.

    Args:
        checks: Which checks, all by default.
        kills: How often a command is killed.
        seed: Of the moments at which it is.
        json: One JSON object in place of the table.
    """
    generator = random.Random(seed)
    found: dict[Check, Callable[[Path], list[Row]]] = {
        "workers": speed_up,
        "killed_worker": killed_worker,
        "killed_sweep": lambda folder: killed_sweep(folder, kills, generator),
        "killed_generate": lambda folder: killed_generate(folder, kills, generator),
        "overhead": overhead,
        "cost": cost,
    }
    rows: list[Row] = []
    for check in checks:
        with tempfile.TemporaryDirectory() as folder:
            rows += found[check](Path(folder))
        print(*rows[-1].values(), sep=" | ", file=sys.stderr, flush=True)
    show(f"at scale, {os.cpu_count()} cores", rows, as_json=json)


def speed_up(folder: Path) -> list[Row]:
    """Eight recordings solved and scored by one worker, then by two, one thread each; all have compiled before."""
    sweep = Sweep.model_validate(
        {"name": "eight", "scenes": ["wall"], "seeds": list(range(1, 9)), "frames": 60, "axes": {"eps6": [0.15]}}
    )
    seconds = {}
    for workers in (1, 2):
        with cluster(workers=workers) as client:
            (first, *_) = subjects_of(client, sweep, folder / RECORDINGS)
            client.run(_warmed, trial_of(first, Settings(), None))
            begun = time.perf_counter()
            rows = swept(sweep, folder, client, overwrite=True)
            seconds[workers] = time.perf_counter() - begun
        if any(row["failure"] for row in rows):
            raise RuntimeError(rows[0]["failure"])
    ratio = seconds[1] / seconds[2]
    measured = f"{ratio:.2f} times: {seconds[1]:.1f} s, {seconds[2]:.1f} s"
    return [_row("two workers against one, 8 recordings", "1.7 times as fast", measured, ratio >= 1.7)]


def _warmed(trial: Trial) -> None:
    """Have everything compiled that compiles itself when it is first called, and the code read for its digest."""
    course = trial.course()
    scores(course.recording, course.motions())


def killed_worker(folder: Path) -> list[Row]:
    """A scheduler and two workers, each a process of its own; one worker is killed after a while."""
    sweep = _sweep_in(folder)
    with cluster(workers=2) as client:
        begun = time.perf_counter()
        undisturbed = _comparable(swept(sweep, folder / "undisturbed", client))
        spent = time.perf_counter() - begun
    with _processes(folder) as (client, workers):
        threading.Timer(spent / 2, workers[0].kill).start()
        rows = _comparable(swept(sweep, folder / "killed", client))
        left = len(client.scheduler_info(n_workers=-1)["workers"])
    same = rows == undisturbed and left == 1
    return [_row("one of two workers killed in the middle", "the same rows", "the same" if same else "others", same)]


def killed_sweep(folder: Path, kills: int, generator: random.Random) -> list[Row]:
    """`unocclude sweep` killed at random moments and started again, until it ends by itself."""
    _sweep_in(folder)
    arguments = ["sweep", folder / "sweep.toml", "--workers", "2"]
    spent = _ended([*arguments, "-o", folder / "undisturbed", "--cache", folder / "cache"])
    there = [*arguments, "-o", folder / "killed", "--cache", folder / "other"]
    _killed_so_often(kills, there, folder / "killed", lambda: generator.uniform(0, spent))
    _ended(there)
    rows, wanted = (_comparable(read_results(folder / name)) for name in ("killed", "undisturbed"))
    left = [path.name for path in (folder / "killed").rglob(".*")]
    same = rows == wanted and not left
    return [_row(f"sweep killed {kills} times", "the same rows, nothing left over", f"{len(rows)} rows, {left}", same)]


def killed_generate(folder: Path, kills: int, generator: random.Random) -> list[Row]:
    """`unocclude generate` killed at random moments and started again, until it ends by itself."""
    arguments = ["generate", "sparse", "--count", "12", "--size", "80x60", "--workers", "2"]
    spent = _ended([*arguments, "-o", folder / "undisturbed"])
    there = [*arguments, "-o", folder / "killed"]
    _killed_so_often(kills, there, folder / "killed", lambda: generator.uniform(0, spent))
    _ended(there)
    same = _contents(folder / "killed") == _contents(folder / "undisturbed") and verify_set(folder / "killed").passes
    files = len(_contents(folder / "killed"))
    return [_row(f"generate killed {kills} times", "the same bytes, nothing else", f"{files} files", same)]


def overhead(folder: Path, points: int = 1000) -> list[Row]:
    """A sweep all of whose scores are in the cache: what a point costs beside its work."""
    axes = {"eps6": {"from": 0.05, "to": 0.5, "steps": points}}
    sweep = Sweep.model_validate({"name": "many", "scenes": ["wall"], "seeds": [1], "frames": 20, "axes": axes})
    cache = Cache(folder=folder / "cache")
    with cluster(workers=2) as client:
        (subject,) = subjects_of(client, sweep, folder / RECORDINGS)
        first = sweep.model_copy(update={"axes": {"eps6": sweep.axes["eps6"].model_copy(update={"steps": 1})}})
        swept(first, folder, client, cache=cache)
        known = trial_of(subject, settings_at(first, points_of(first)[0], Settings()), cache)
        scores = cache.found(known.scores_key(), SCORES.read)
        for point in points_of(sweep):
            key = trial_of(subject, settings_at(sweep, point, Settings()), cache).scores_key()
            cache.keep(key, lambda path: SCORES.write(scores, path))
        begun = time.perf_counter()
        rows = swept(sweep, folder, client, cache=cache)
        milliseconds = 1000 * (time.perf_counter() - begun) / len(rows)
    return [
        _row(f"{points} points over cached stages", "below 10 ms a point", f"{milliseconds:.1f} ms", milliseconds < 10)
    ]


def cost(folder: Path, count: int = 5) -> list[Row]:
    """What a recording costs, and a million of them: core-hours, bytes, and memory of the scheduler.

    Seconds are those that a processor has worked, so that other work on the machine does not count.
    """
    family, cache = load_family("crowded"), Cache(folder=folder / "cache")
    for name, numbers in (("first", 1), ("data", count)):  # What is compiled, or found once, is not counted.
        begun = time.process_time()
        done = generate(Order(family=family, folder=folder / name), seeds=range(1, numbers + 1))
        making = (time.process_time() - begun) / len(done.recordings)
        _score(folder / name / done.recordings[0].name)
    begun = time.process_time()
    for entry in done.recordings:
        _score(folder / "data" / entry.name, cache)
    solving = (time.process_time() - begun) / len(done.recordings)
    data = sum(map(len, _contents(folder / "data").values())) / len(done.recordings)
    kept = sum(map(len, _contents(folder / "cache").values())) / len(done.recordings)
    with cluster(workers=1) as client:
        task = _bytes_a_task(client)
    frames = done.frames / len(done.recordings)
    return [
        _cost(f"a recording of {frames:.0f} frames, 320x240", making, data),
        _cost("its motions and scores; what the cache keeps", solving, kept),
        _cost("a task in the scheduler's memory", 0.0, task),
    ]


def _score(place: Path, cache: Cache | None = None) -> None:
    recording = load_recording(place)
    evaluate(recording, solve(recording, cache=cache))


def _cost(what: str, seconds: float, size: float) -> Row:
    hours, terabytes = seconds * MILLION / 3600, size * MILLION / 1e12
    measured = f"{seconds:.2f} s, {size / 1e6:.3f} MB; a million: {hours:,.0f} core-hours, {terabytes:.3f} TB"
    return _row(what, "", measured, None)


def _bytes_a_task(client: Client, tasks: int = 5000) -> float:
    """Memory that this process, where the scheduler lives, needs for a task that waits."""
    process = psutil.Process()
    before = process.memory_info().rss
    waiting = {f"waiting-{number}": Task(f"waiting-{number}", time.sleep, 0.0) for number in range(tasks)}
    largest = before
    for _ in finished(client, waiting, list(waiting)):
        largest = max(largest, process.memory_info().rss)
    return (largest - before) / tasks


def _sweep_in(folder: Path) -> Sweep:
    (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    return load_sweep(folder / "sweep.toml")


@contextmanager
def _processes(folder: Path) -> Iterator[tuple[Client, list[subprocess.Popen[bytes]]]]:
    """A client of a scheduler with two workers, each a process of its own, and the workers."""
    place = folder / "scheduler.json"
    running = [_dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", place)]
    try:
        while not place.is_file():
            time.sleep(0.05)
        running += [_dask("worker", "--scheduler-file", place, "--nthreads", "1", "--no-nanny") for _ in range(2)]
        with Client(scheduler_file=str(place)) as client:
            client.wait_for_workers(2)
            yield client, running[1:]
    finally:
        for process in running:
            process.kill()
            process.wait()


def _dask(what: str, *arguments: object) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *map(str, arguments)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen(command, cwd=ROOT, start_new_session=True, **quiet)


def _command(arguments: Sequence[object]) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "unocclude", *map(str, arguments), "--quiet"]
    return subprocess.Popen(command, cwd=ROOT, start_new_session=True, stdout=subprocess.DEVNULL)


def _ended(arguments: Sequence[object]) -> float:
    """How long the command took."""
    begun = time.perf_counter()
    if _command(arguments).wait() != 0:
        raise RuntimeError(f"expected {arguments[0]} to end well")
    return time.perf_counter() - begun


def _killed_so_often(kills: int, arguments: Sequence[object], folder: Path, moment: Callable[[], float]) -> None:
    """Kill the command so often, each time at another moment; when it was quicker it begins anew."""
    while kills:
        running = _command(arguments)
        try:
            running.wait(moment())
        except subprocess.TimeoutExpired:
            running.send_signal(signal.SIGKILL)
        if running.wait() == -signal.SIGKILL:
            kills -= 1
        else:
            shutil.rmtree(folder)


def _contents(folder: Path) -> dict[str, bytes]:
    """What its files hold."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def _comparable(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows without the times."""
    return [{name: value for name, value in row.items() if not name.startswith("seconds")} for row in rows]


def _row(check: str, wanted: str, measured: str, holds: bool | None) -> Row:
    return {"check": check, "wanted": wanted, "measured": measured, "holds": "-" if holds is None else str(holds)}


if __name__ == "__main__":
    run(app)
