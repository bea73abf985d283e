"""Recordings stand on a shelf whole or not at all, in a folder or at a URL."""

import shutil
from pathlib import Path
from uuid import uuid4

import pytest

from recording.errors import InputError
from recording.shelf import Shelf, shelf_at


@pytest.fixture(params=["folder", "memory", "file"])
def shelf(request: pytest.FixtureRequest, tmp_path: Path) -> Shelf:
    places = {"folder": tmp_path / "set", "memory": f"memory://{uuid4().hex}", "file": f"file://{tmp_path}/set"}
    return shelf_at(places[request.param])


def put(shelf: Shelf, text: str = "first", failure: type[BaseException] | None = None) -> None:
    with shelf.making("one") as place:
        (place / "frames").mkdir(parents=True)
        (place / "frames" / "0.exr").write_text(text)
        (place / "recording.json").write_text(text)
        if failure is not None:
            raise failure


def test_what_was_made_stands_there(shelf: Shelf) -> None:
    assert not shelf.holds("one")
    put(shelf)
    assert shelf.holds("one")
    with shelf.fetched("one") as place:
        assert (place / "recording.json").read_text() == (place / "frames" / "0.exr").read_text() == "first"


def test_what_is_made_again_takes_the_old_ones_place(shelf: Shelf) -> None:
    for text in ("first", "second"):
        put(shelf, text)
    with shelf.fetched("one") as place:
        assert (place / "frames" / "0.exr").read_text() == "second"


def test_what_fails_leaves_nothing_and_the_old_one_stays(shelf: Shelf) -> None:
    with pytest.raises(RuntimeError):
        put(shelf, "broken", RuntimeError)
    assert not shelf.holds("one")
    put(shelf)
    with pytest.raises(RuntimeError):
        put(shelf, "broken", RuntimeError)
    with shelf.fetched("one") as place:
        assert (place / "recording.json").read_text() == "first"


def test_two_who_make_the_same_do_not_disturb_each_other(shelf: Shelf) -> None:
    with shelf.making("one") as slow:
        (slow / "frames").mkdir(parents=True)
        put(shelf, "quick")
        (slow / "frames" / "0.exr").write_text("slow")
        (slow / "recording.json").write_text("slow")
    with shelf.fetched("one") as place:
        assert (place / "recording.json").read_text() == (place / "frames" / "0.exr").read_text() == "slow"


def test_a_file_is_written_and_replaced(shelf: Shelf) -> None:
    for text in ("old", "new"):
        shelf.write("manifest.json", text)
    assert shelf.holds("manifest.json")
    with shelf.fetched("manifest.json") as path:
        assert path.read_text() == "new"


def test_what_killed_runs_left_is_removed(tmp_path: Path) -> None:
    shelf = shelf_at(tmp_path / "set")
    put(shelf)
    left = tmp_path / "set" / ".making" / "somebody" / "one"
    shutil.copytree(tmp_path / "set" / "one", left)
    shelf.tidy()
    assert [path.name for path in (tmp_path / "set").iterdir()] == ["one"]


def test_a_url_of_an_unknown_kind_is_refused() -> None:
    with pytest.raises(InputError, match="expected a URL that fsspec can open here"):
        shelf_at("frob://bucket/data").holds("one")
