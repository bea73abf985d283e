"""A long run says what it will fill, and what does not fit is refused before it."""

import shutil
from io import StringIO
from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.console import Console

from recording.errors import InputError
from recording.progress import progress_shown
from recording.space import check_room


def said(tmp_path: Path, expected_bytes: int, free: int, monkeypatch: pytest.MonkeyPatch) -> str:
    """What is printed on a console that is no terminal."""
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=free))
    text = StringIO()
    with progress_shown(Console(file=text, soft_wrap=True)):
        check_room(expected_bytes, tmp_path)
    return text.getvalue()


def test_what_is_large_is_said_and_what_is_small_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = f"about 2.4 GB will be written to {tmp_path}; 100.0 GB are free\n"
    assert said(tmp_path, 2_440_000_000, 10**11, monkeypatch) == expected
    assert said(tmp_path, 900_000_000, 10**11, monkeypatch) == ""


def test_what_does_not_fit_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"expected room for about 3\.0 GB, but 2\.5 GB are free: choose another disk"):
        said(tmp_path, 3 * 10**9, 25 * 10**8, monkeypatch)


def test_a_library_is_silent(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    check_room(1_500_000_000, tmp_path)
    assert capsys.readouterr() == ("", "")
