"""`unocclude export`: exit status 0 and what it says, or 2 and one line."""

from pathlib import Path

import pytest
from billboards import squares, true_motions

import exporting.export
import unocclude


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("recordings") / "squares"
    unocclude.save_recording(squares(), folder)
    recording = unocclude.load_recording(folder)
    unocclude.save_motions(true_motions(recording), folder / "motions.parquet")
    return folder


def exported(*arguments: object) -> int:
    """The exit status."""
    try:
        unocclude.main(["export", *map(str, arguments)])
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


def test_it_takes_the_motions_beside_the_recording(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exported(place, "--format", "mot", "-o", tmp_path / "o") == 0
    assert (tmp_path / "o" / "two_squares.txt").is_file()
    assert "4 files" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--format", "obj", "-o", "{new}"), "obj"),
        (("--format", "ply", "-o", "{place}", "--overwrite"), "something else"),
        (("{new}/none.parquet", "--format", "ply", "-o", "{new}"), "no such file"),
    ],
)
def test_a_wrong_argument_is_one_line(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], sentence: str
) -> None:
    words = [word.format(place=place, new=tmp_path / "new") for word in arguments]
    assert exported(place, *words) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.count("\n") == 1
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(("name", "package"), [("usd", "pxr"), ("rerun", "rerun")])
def test_a_missing_package_is_named_with_its_extra(
    place: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    package: str,
) -> None:
    monkeypatch.setattr(exporting.export, "find_spec", lambda wanted: None if wanted == package else object())
    assert exported(place, "--format", name, "-o", tmp_path / "o") == 2
    assert f"pip install 'unocclude[{name}]'" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
