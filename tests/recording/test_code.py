"""A digest of code covers what the code imports, and nothing else."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from recording import code
from recording.code import code_digest, imported_modules


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A program of three modules, a importing b, in place of this one."""
    folder = tmp_path / "algorithm"
    folder.mkdir()
    (folder / "a.py").write_text("import numpy\nfrom algorithm.b import name\n")
    (folder / "b.py").write_text("name = 1\n")
    (folder / "c.py").write_text("other = 1\n")
    monkeypatch.setattr(code, "_ROOT", tmp_path)
    forget()
    yield folder
    forget()


def forget() -> None:
    code_digest.cache_clear()
    imported_modules.cache_clear()


def changed(source: Path, name: str, **chosen: tuple[str, ...]) -> bool:
    """Whether the digest of a changes with a comment in a module."""
    before = code_digest("algorithm.a", **chosen)
    (source / f"{name}.py").write_text((source / f"{name}.py").read_text() + "# A comment.\n")
    forget()
    return code_digest("algorithm.a", **chosen) != before


@pytest.mark.parametrize(("name", "counts"), [("a", True), ("b", True), ("c", False)])
def test_what_a_module_imports_counts(name: str, counts: bool, source: Path) -> None:
    assert changed(source, name) is counts


def test_what_is_set_apart_does_not_count(source: Path) -> None:
    assert not changed(source, "b", apart=("algorithm.b",))


def test_a_module_may_count_alone(source: Path) -> None:
    assert changed(source, "c", alone=("algorithm.c",))


def test_the_digest_is_the_same_in_another_process() -> None:
    program = "from recording.code import code_digest; print(code_digest('evaluation.scores'))"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert said.strip() == code_digest("evaluation.scores")
