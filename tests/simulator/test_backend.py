"""The backend is found by trial, never by a crash."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from recording.errors import InputError
from simulator import backend
from simulator.backend import LIBRARY_VARIABLE, find_backend, likely_library, llvm_version


@pytest.fixture
def forgetful() -> Iterator[None]:
    """Let nothing found before or here be remembered."""
    caches = (find_backend, backend._candidates)
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


@pytest.fixture
def no_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, forgetful: None) -> Path:
    """A file that is named as the LLVM library and is none."""
    path = tmp_path / "libLLVM.so.19.1"
    path.write_text("no library")
    monkeypatch.setenv(LIBRARY_VARIABLE, str(path))
    return path


def test_a_file_that_is_no_library_falls_back_and_says_why(no_library: Path) -> None:
    found = find_backend("auto")
    assert found.name == "scalar"
    assert found.library is None
    assert str(no_library) in found.reason
    assert "libllvm19" in found.reason
    assert "\n" not in found.reason


def test_llvm_that_cannot_be_had_is_an_input_error_with_advice(no_library: Path) -> None:
    with pytest.raises(InputError, match="libllvm19") as error:
        find_backend("llvm")
    assert str(no_library) in str(error.value)
    assert "\n" not in str(error.value)


def test_without_any_library_the_advice_stands_alone(monkeypatch: pytest.MonkeyPatch, forgetful: None) -> None:
    monkeypatch.delenv(LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr(backend, "_installed_libraries", lambda: iter(()))
    assert likely_library() is None
    found = find_backend("auto")
    assert found.name == "scalar"
    assert "no LLVM library was found" in found.reason


def test_scalar_is_had_for_the_asking() -> None:
    assert find_backend("scalar").name == "scalar"


def test_auto_takes_llvm_where_llvm_works() -> None:
    found = find_backend("auto")
    assert found == find_backend("llvm")
    assert found.library is not None
    assert found.library in found.reason


def test_a_process_that_aborts_is_a_failure_not_a_crash(monkeypatch: pytest.MonkeyPatch, forgetful: None) -> None:
    monkeypatch.setattr(backend, "_PROBE", "import os; os.abort()")
    monkeypatch.setenv(LIBRARY_VARIABLE, "libLLVM.so.19.1")
    assert "aborts the process (signal 6)" in find_backend("auto").reason


def test_a_process_that_hangs_is_a_failure(monkeypatch: pytest.MonkeyPatch, forgetful: None) -> None:
    monkeypatch.setattr(backend, "_PROBE", "import time; time.sleep(60)")
    monkeypatch.setattr(backend, "_PROBE_SECONDS", 0.2)
    monkeypatch.setenv(LIBRARY_VARIABLE, "libLLVM.so.19.1")
    assert "no answer" in find_backend("auto").reason


def test_the_newest_version_comes_first_and_the_too_old_never(monkeypatch: pytest.MonkeyPatch, forgetful: None) -> None:
    names = ["/l/libLLVM-14.so.1", "/l/libLLVM-15.so.1", "/l/libLLVM.so", "/l/libLLVM.so.19.1", "/l/libLLVM-18.so.1"]
    monkeypatch.delenv(LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr(backend, "_installed_libraries", lambda: iter(names))
    assert backend._candidates() == [
        "/l/libLLVM.so.19.1",
        "/l/libLLVM-18.so.1",
        "/l/libLLVM-15.so.1",
        "/l/libLLVM.so",  # It does not tell its version.
    ]


@pytest.mark.parametrize(
    ("library", "version"),
    [
        ("libLLVM.so.19.1", 19),
        ("/usr/lib/libLLVM-15.so.1", 15),
        ("/usr/lib/libLLVM-14.0.6.so.1", 14),
        ("/opt/homebrew/opt/llvm@18/lib/libLLVM.dylib", 18),
        ("/usr/lib/llvm-16/lib/libLLVM.so.1", 16),
        ("libLLVM.so", None),
    ],
)
def test_version_is_read_from_the_name(library: str, version: int | None) -> None:
    assert llvm_version(library) == version


def test_scalar_stays_silent_about_the_llvm_it_does_not_need(no_library: Path) -> None:
    code = (
        "from simulator.backend import Backend; from simulator.raycast import casts_known_answer;"
        "print(casts_known_answer(Backend(name='scalar', reason='asked for')))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2]
    )
    assert (done.stdout.strip(), done.stderr) == ("True", "")
