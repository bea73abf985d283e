"""A sweep ends with the same rows whatever happens to it, and what fails stops nothing else."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow.parquet as pq
import pytest

from evaluation.sweeps import run
from evaluation.sweeps.journal import Done, journal
from evaluation.sweeps.plan import Sweep, load_sweep
from evaluation.sweeps.run import swept
from evaluation.sweeps.table import RESULTS, Row
from recording.cache import Cache
from recording.cluster import Client, Finished, cluster
from recording.errors import InputError
from recording.store import load_recording, save_recording

SWEEP = """
name = "six"
recordings = ["small"]
settings = {{flow = "dis"}}
[axes]
eps1 = [1.0, 1.5]
eps6 = {{from = 0.1, to = 0.2, steps = {steps}}}
"""


def sweep_at(small: Path, steps: int = 3) -> Sweep:
    path = small.parent / f"sweep-{steps}.toml"
    path.write_text(SWEEP.format(steps=steps), encoding="utf-8")
    return load_sweep(path)


def without_seconds(rows: list[Row]) -> list[Row]:
    return [{name: value for name, value in row.items() if not name.startswith("seconds")} for row in rows]


@pytest.fixture(scope="module")
def undisturbed(small: Path, client: Client, tmp_path_factory: pytest.TempPathFactory) -> list[Row]:
    return without_seconds(swept(sweep_at(small), tmp_path_factory.mktemp("sweep"), client))


def test_the_results_are_one_table_for_every_reader(small: Path, client: Client, tmp_path: Path) -> None:
    rows = swept(sweep_at(small), tmp_path, client)
    table = pd.read_parquet(tmp_path / RESULTS)
    assert len(table) == len(rows) == 6
    assert {"settings.eps1", "settings.flow", "identity.hota", "seconds.flow", "worth", "failure"} <= set(table.columns)
    assert table["settings.eps6"].tolist() == [0.1, 0.15, 0.2] * 2
    assert table["settings.flow"].unique().tolist() == ["dis"]
    assert table["settings.shortest_frames"].dtype == "int64"
    assert table["failure"].isna().all()
    assert table["worth"].notna().all()
    assert list(tmp_path.iterdir()) == [tmp_path / RESULTS]
    assert b'"name": "six"' in pq.read_metadata(tmp_path / RESULTS).metadata[b"unocclude"]


def test_the_same_call_again_does_nothing_and_a_larger_one_only_the_rest(
    small: Path, client: Client, tmp_path: Path, undisturbed: list[Row], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def counted(client: Client, graph: dict[str, Any], wanted: list[str]) -> Any:
        asked.append(len(wanted))
        return run_finished(client, graph, wanted)

    run_finished = run.finished
    monkeypatch.setattr(run, "finished", counted)
    assert without_seconds(swept(sweep_at(small), tmp_path, client)) == undisturbed
    assert without_seconds(swept(sweep_at(small), tmp_path, client)) == undisturbed
    assert len(swept(sweep_at(small, steps=5), tmp_path, client)) == 10
    assert asked == [6, 0, 4]
    assert len(swept(sweep_at(small), tmp_path, client, overwrite=True)) == 6
    assert asked[-1] == 6


def test_a_journal_that_was_cut_off_loses_its_last_line_only(tmp_path: Path) -> None:
    for number in range(3):
        with journal(tmp_path) as written:
            assert list(written.known) == [f"key-{done}" for done in range(number)]
            written.add(Done(key=f"key-{number}", scores={"worth": 0.5}))
            written.add(Done(key="failed", failure="ValueError: no"))
        path = next(tmp_path.iterdir())
        path.write_bytes(path.read_bytes() + b'{"key": "cut')


def test_a_trial_that_fails_has_its_error_in_its_row_and_is_tried_again(
    small: Path, client: Client, tmp_path: Path, undisturbed: list[Row], monkeypatch: pytest.MonkeyPatch
) -> None:
    run_finished = run.finished

    def failing(client: Client, graph: dict[str, Any], wanted: list[str]) -> Any:
        for number, one in enumerate(run_finished(client, graph, wanted)):
            yield Finished(key=one.key, failure="ValueError: no") if number == 2 else one

    with monkeypatch.context() as changed:
        changed.setattr(run, "finished", failing)
        rows = swept(sweep_at(small), tmp_path, client)
    assert sorted(row["failure"] or "" for row in rows) == [""] * 5 + ["ValueError: no"]
    assert sum(row["worth"] is None for row in rows) == 1
    assert without_seconds(swept(sweep_at(small), tmp_path, client)) == undisturbed


def test_scenes_are_simulated_once(scene: Path, client: Client, tmp_path: Path) -> None:
    sweep = Sweep.model_validate(
        {"name": "own", "scenes": [str(scene)], "seeds": [1, 2], "axes": {"eps6": [0.1]}, "settings": {"flow": "dis"}}
    )
    rows = swept(sweep, tmp_path, client)
    assert [(row["recording"], row["scene"], row["seed"]) for row in rows] == [
        ("small-000001", "small", 1),
        ("small-000002", "small", 2),
    ]
    made = {path: path.stat().st_mtime_ns for path in (tmp_path / "recordings").rglob("*.exr")}
    swept(sweep, tmp_path, client)
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "recordings").rglob("*.exr")} == made


def test_a_recording_that_has_changed_is_scored_again(small: Path, client: Client, tmp_path: Path) -> None:
    save_recording(load_recording(small), tmp_path / "data" / "small")
    sweep = Sweep.model_validate(
        {
            "name": "own",
            "recordings": [str(tmp_path / "data" / "small")],
            "axes": {"eps6": [0.1]},
            "settings": {"flow": "dis"},
        }
    )
    (first,) = swept(sweep, tmp_path / "out", client)
    path = tmp_path / "data" / "small" / "frames"
    (path / "000000.exr").write_bytes((path / "000001.exr").read_bytes())
    (second,) = swept(sweep, tmp_path / "out", client)
    assert first["key"] != second["key"]


def test_what_is_no_recording_is_refused(client: Client, tmp_path: Path) -> None:
    sweep = Sweep.model_validate({"name": "own", "recordings": [str(tmp_path)], "axes": {"eps6": [0.1]}})
    with pytest.raises(InputError, match="expected a recording or a data set"):
        swept(sweep, tmp_path / "out", client)


def test_a_sweep_that_was_killed_goes_on_and_ends_the_same(
    small: Path, undisturbed: list[Row], client: Client, tmp_path: Path
) -> None:
    sweep_at(small)
    command = [sys.executable, "-m", "unocclude", "sweep", str(small.parent / "sweep-3.toml"), "-o", str(tmp_path)]
    environment = os.environ | {"UNOCCLUDE_CACHE": str(tmp_path / "cache")}
    running = subprocess.Popen([*command, "--workers", "1", "--quiet"], env=environment, start_new_session=True)
    lines = tmp_path / ".unfinished.jsonl"
    while running.poll() is None and not (lines.is_file() and lines.read_text(encoding="utf-8").count("\n") >= 2):
        time.sleep(0.02)
    running.send_signal(signal.SIGKILL)
    assert running.wait() == -signal.SIGKILL
    assert not (tmp_path / RESULTS).exists()
    rows = swept(sweep_at(small), tmp_path, client, cache=Cache(folder=tmp_path / "cache"))
    assert without_seconds(rows) == undisturbed
    assert not lines.exists()


def dask(*arguments: object) -> subprocess.Popen[bytes]:
    """A scheduler or a worker, in a process of its own."""
    command = [sys.executable, "-m", "distributed.cli.dask_" + str(arguments[0]), *map(str, arguments[1:])]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, start_new_session=True)


def test_a_worker_that_is_killed_changes_nothing(
    small: Path, undisturbed: list[Row], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "scheduler.json"
    running = [dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", place)]
    run_finished = run.finished

    def killing(client: Client, graph: dict[str, Any], wanted: list[str]) -> Any:
        for one in run_finished(client, graph, wanted):
            running[1].kill()  # As soon as the first result is there.
            yield one

    try:
        while not place.is_file():
            time.sleep(0.05)
        running += [dask("worker", "--scheduler-file", place, "--nthreads", "1", "--no-nanny") for _ in range(2)]
        with cluster(json.loads(place.read_text(encoding="utf-8"))["address"]) as client:
            client.wait_for_workers(2, timeout=60)
            monkeypatch.setattr(run, "finished", killing)
            rows = swept(sweep_at(small), tmp_path / "out", client)
    finally:
        for process in running:
            process.kill()
            process.wait()
    assert without_seconds(rows) == undisturbed
