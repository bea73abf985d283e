"""The command: wrong input is one line and exit status 2, whatever is asked for; else it serves until it is stopped."""

import importlib.util
import socket
from dataclasses import replace
from pathlib import Path

import pytest

import unocclude
from recording.corrections import Corrections, save_corrections
from recording.motions import Motions
from recording.recording import Recording
from viewer.viewer import Viewer


@pytest.fixture(scope="module")
def folder(scene: Recording, solved: Motions, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recording on disk, with its motions."""
    place = tmp_path_factory.mktemp("recordings") / "passing_by"
    unocclude.save_recording(scene, place)
    unocclude.save_motions(solved, place / "motions.parquet")
    return place


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The line with which a command line ends, whose exit status is 2."""
    with pytest.raises(SystemExit) as stop:
        unocclude.main(["view", *map(str, arguments)])
    assert stop.value.code == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert len(shown.err.strip().splitlines()) == 1
    return shown.err


def test_a_port_in_use_is_one_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        assert "cannot be listened on" in refusal(capsys, folder, "--port", holder.getsockname()[1])


def test_without_viser_it_says_what_to_install(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("commands.viewing.find_spec", lambda name: None)
    assert "pip install 'unocclude[view]'" in refusal(capsys, folder)
    assert importlib.util.find_spec("viser") is not None


def test_what_is_no_recording_or_no_port_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "recording.json" in refusal(capsys, tmp_path)
    refusal(capsys, tmp_path, "--port", "70000")


def test_motions_of_another_recording_are_refused(
    folder: Path, tmp_path: Path, solved: Motions, capsys: pytest.CaptureFixture[str]
) -> None:
    foreign = replace(solved, making=replace(solved.making, recording_digest="0" * 64))
    unocclude.save_motions(foreign, tmp_path / "other.parquet")
    assert "motions of another" in refusal(capsys, folder, tmp_path / "other.parquet")


def test_corrections_of_another_recording_are_refused_where_they_are_asked_for(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    foreign = tmp_path / "other.toml"
    save_corrections(Corrections(recording_digest="0" * 64), foreign)
    assert "another one" in refusal(capsys, folder, "--corrections", foreign)


def test_it_serves_until_it_is_stopped(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    served: list[str] = []

    def run(viewer: Viewer) -> None:
        served.append(viewer.address)
        viewer.session.judged.connect(viewer.stop)  # Nothing is left to be done in the background.
        original(viewer)

    original = Viewer.run
    monkeypatch.setattr(Viewer, "run", run)
    with pytest.raises(SystemExit) as stop:
        unocclude.main(["view", str(folder), "--port", "0"])
    assert stop.value.code == 0
    assert served[0].startswith("http://127.0.0.1:")
    assert served[0] in capsys.readouterr().err
