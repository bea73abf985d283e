"""Whole or not at all, whatever happens in between."""

from pathlib import Path

import pytest

from recording.atomic import whole_file, whole_folder
from recording.errors import InputError


class Interrupted(Exception):
    """Something that nobody foresaw."""


def write_half_a_file(path: Path, failure: type[BaseException]) -> None:
    with whole_file(path, overwrite=True) as partial:
        partial.write_text("half")
        raise failure


def write_half_a_folder(path: Path, failure: type[BaseException]) -> None:
    with whole_folder(path, overwrite=True) as partial:
        (partial / "a").write_text("half")
        raise failure


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_file_appears_when_the_block_ends(tmp_path: Path) -> None:
    path = tmp_path / "new" / "result.txt"
    with whole_file(path) as partial:
        partial.write_text("whole")
        assert not path.exists()
    assert path.read_text() == "whole"
    assert names(path.parent) == ["result.txt"]


def test_a_folder_appears_when_the_block_ends(tmp_path: Path) -> None:
    path = tmp_path / "new" / "result"
    with whole_folder(path) as partial:
        (partial / "a").write_text("whole")
        assert not path.exists()
    assert (path / "a").read_text() == "whole"
    assert names(path.parent) == ["result"]


def test_a_failure_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(Interrupted):
        write_half_a_file(tmp_path / "result", Interrupted)
    assert names(tmp_path) == []


def test_a_failure_leaves_no_folder(tmp_path: Path) -> None:
    with pytest.raises(Interrupted):
        write_half_a_folder(tmp_path / "result", Interrupted)
    assert names(tmp_path) == []


def test_an_interrupt_leaves_nothing_either(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        write_half_a_folder(tmp_path / "result", KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        write_half_a_file(tmp_path / "file", KeyboardInterrupt)
    assert names(tmp_path) == []


@pytest.mark.parametrize("whole", [whole_file, whole_folder])
def test_an_existing_result_is_refused_before_any_work(tmp_path: Path, whole) -> None:
    (tmp_path / "result").mkdir()
    (tmp_path / "result" / "old").touch()
    with pytest.raises(InputError, match=r"result exists already.*--overwrite"), whole(tmp_path / "result"):
        pytest.fail("the block must not run")


def test_an_empty_folder_is_nothing_to_lose(tmp_path: Path) -> None:
    (tmp_path / "result").mkdir()
    with whole_folder(tmp_path / "result") as partial:
        (partial / "new").touch()
    assert [path.name for path in tmp_path.rglob("*")] == ["result", "new"]


def test_overwriting_replaces_a_file(tmp_path: Path) -> None:
    path = tmp_path / "result"
    path.write_text("old")
    with whole_file(path, overwrite=True) as partial:
        partial.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert names(tmp_path) == ["result"]


def test_overwriting_replaces_the_whole_folder(tmp_path: Path) -> None:
    path = tmp_path / "result"
    path.mkdir()
    (path / "old").write_text("old")
    with whole_folder(path, overwrite=True) as partial:
        (partial / "new").write_text("new")
        assert names(path) == ["old"]
    assert names(path) == ["new"]
    assert names(tmp_path) == ["result"]


def test_the_old_result_survives_a_failure(tmp_path: Path) -> None:
    path = tmp_path / "result"
    path.mkdir()
    (path / "old").write_text("old")
    with pytest.raises(Interrupted):
        write_half_a_folder(path, Interrupted)
    assert names(path) == ["old"]
    assert names(tmp_path) == ["result"]
    (tmp_path / "file").write_text("old")
    with pytest.raises(Interrupted):
        write_half_a_file(tmp_path / "file", Interrupted)
    assert (tmp_path / "file").read_text() == "old"


def test_a_folder_never_replaces_a_file(tmp_path: Path) -> None:
    path = tmp_path / "result"
    path.write_text("mine")
    with pytest.raises(InputError, match="result"), whole_folder(path, overwrite=True):
        pass
    assert path.read_text() == "mine"
    assert names(tmp_path) == ["result"]


def test_a_file_never_replaces_a_folder(tmp_path: Path) -> None:
    (tmp_path / "result").mkdir()
    with pytest.raises(InputError, match="result"), whole_file(tmp_path / "result", overwrite=True) as partial:
        partial.write_text("new")
    assert names(tmp_path) == ["result"]


def test_what_a_killed_run_left_behind_is_removed(tmp_path: Path) -> None:
    path = tmp_path / "result"
    with whole_folder(path) as partial:
        left = partial.name
    (tmp_path / left).mkdir()
    (tmp_path / left / "rubbish").write_text("half")
    with whole_folder(path, overwrite=True) as partial:
        (partial / "new").write_text("new")
    assert names(path) == ["new"]
    assert names(tmp_path) == ["result"]


@pytest.mark.parametrize("whole", [whole_file, whole_folder])
def test_a_place_that_cannot_be_written_is_named(tmp_path: Path, whole) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(InputError, match=r"file.*cannot be written") as refused, whole(tmp_path / "file" / "result"):
        pytest.fail("the block must not run")
    assert "\n" not in str(refused.value)
