"""Sweeps, searches, caches and clusters from the command line."""

import json
from pathlib import Path

import pandas as pd
import pytest
from small_scenes import PASSING

import unocclude
from simulator.simulate import prepared, write_simulation

SWEEP = 'name = "two"\nrecordings = ["small"]\nsettings = {flow = "dis"}\n[axes]\neps6 = [0.1, 0.2]\neps2 = [0.1]\n'


def run(*arguments: object) -> int:
    """The exit status of a command line."""
    try:
        unocclude.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording and a sweep over it."""
    folder = tmp_path_factory.mktemp("sweeps")
    (folder / "small.toml").write_text(PASSING, encoding="utf-8")
    write_simulation(prepared(folder / "small.toml"), folder / "small", backend="scalar")
    (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    return folder


def test_a_sweep_leaves_a_table_a_summary_and_pictures(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("sweep", folder / "sweep.toml", "-o", tmp_path / "out", "--workers", 1) == 0
    said = capsys.readouterr()
    assert "Best worth: " in said.out
    assert "dashboard: http://127.0.0.1:" in said.err
    assert "2 rows, 0 failed" in said.err
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {
        *("results.parquet", "summary.md", "summary.json"),
        *("curves.png", "curves.svg", "pairs.png", "pairs.svg"),
    }
    assert len(pd.read_parquet(tmp_path / "out" / "results.parquet")) == 2
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["rows"] == 2


def test_a_search_leaves_a_study_and_settings_to_solve_with(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("--trials", 2, "--workers", 1, "--quiet", "--json")
    assert run("tune", folder / "sweep.toml", "-o", tmp_path / "out", *arguments) == 0
    said = capsys.readouterr()
    assert len(json.loads(said.out)["trials"]) == 2
    assert said.err == ""
    assert (tmp_path / "out" / "study.log").is_file()
    best = ("--settings", tmp_path / "out" / "best.toml", "-o", tmp_path / "motions.parquet")
    assert run("solve", folder / "small", *best) == 0


def test_solve_uses_the_cache_unless_told_not_to(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def solved(*arguments: object) -> None:
        assert run("solve", folder / "small", "-o", tmp_path / "m.parquet", "--overwrite", *arguments) == 0

    def kept() -> list[str]:
        return sorted(path.name for path in (tmp_path / "cache").rglob("*-*"))

    solved("--no-cache", "--cache", tmp_path / "cache")
    assert kept() == []
    solved("--cache", tmp_path / "cache")
    first = kept()
    assert [name.partition("-")[0] for name in first] == ["flow", "segments", "trajectories"]
    solved("--cache", tmp_path / "cache", "--set", "eps6=0.3")
    assert kept() == first
    solved("--cache", tmp_path / "cache", "--set", "eps2=0.05")
    assert [name.partition("-")[0] for name in kept()] == [
        *("flow", "segments", "segments", "trajectories", "trajectories")
    ]
    assert "without the cache" in capsys.readouterr().err


WRONG = {
    "no such sweep": ("sweep", "{empty}/sweep.toml", "-o", "{empty}/out"),
    "a recording in place of a sweep": ("sweep", "{folder}/small/recording.json", "-o", "{empty}/out"),
    "no such scheduler": ("sweep", "{folder}/sweep.toml", "-o", "{empty}/out", "--scheduler", "tcp://127.0.0.1:1"),
    "no address": ("sweep", "{folder}/sweep.toml", "-o", "{empty}/out", "--scheduler", "elsewhere:frob"),
    "no trials": ("tune", "{folder}/sweep.toml", "-o", "{empty}/out", "--trials", "0"),
    "no cache": ("solve", "{folder}/small", "-o", "{empty}/m.parquet", "--cache-gb", "0"),
    "no such kind of URL": ("generate", "crowded", "--count", "1", "-o", "frob://bucket/data"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_input_gets_one_line_and_status_2(
    what: str, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("recording.cluster._PATIENCE_SECONDS", 0.5)
    assert run(*(str(part).format(folder=folder, empty=tmp_path) for part in WRONG[what])) == 2
    output = capsys.readouterr()
    assert output.err.startswith("unocclude: ")
    assert output.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["sweep", "tune"])
def test_every_command_has_help_with_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, "--help") == 0
    assert f"Example: unocclude {command}" in " ".join(capsys.readouterr().out.split())
