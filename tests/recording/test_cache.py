"""What is kept is found again, by whoever asks; what is not used goes; nothing is ever found in part."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from recording.cache import Cache, Form, kept, key_of

FORM = Form(read=Path.read_bytes, write=lambda value, path: path.write_bytes(value))
WRITER = """
import sys
from pathlib import Path
from recording.cache import Cache
cache = Cache(folder=Path(sys.argv[1]), limit_bytes=40_000)
for number in range(400):
    key = f"number-{number % 20:04d}"
    found = cache.found(key, Path.read_bytes)
    assert found is None or found == key.encode() * 500, key
    cache.keep(key, lambda path: path.write_bytes(key.encode() * 500))
"""


def files(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file()]


def test_what_was_made_is_made_once(tmp_path: Path) -> None:
    cache, made = Cache(folder=tmp_path), []

    def make() -> bytes:
        made.append(1)
        return b"result"

    assert [kept(cache, "key-00", make, FORM) for _ in range(3)] == [b"result"] * 3
    assert len(made) == 1
    assert cache.holds("key-00")
    assert not cache.holds("key-01")


def test_without_a_cache_it_is_made_each_time() -> None:
    assert [kept(None, "key", lambda: b"result", FORM) for _ in range(2)] == [b"result"] * 2


def test_a_key_says_what_it_was_made_of_and_not_in_which_order() -> None:
    assert key_of("kind", {"a": 1.0, "b": [2]}) == key_of("kind", {"b": [2], "a": 1.0})
    assert len({key_of("kind", {"a": 1.0}), key_of("kind", {"a": 2.0}), key_of("other", {"a": 1.0})}) == 3


def test_a_key_is_the_same_in_another_process() -> None:
    program = "from recording.cache import key_of; print(key_of('kind', {'b': [2, 'x'], 'a': 0.1}))"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert said.strip() == key_of("kind", {"a": 0.1, "b": [2, "x"]})


def test_what_was_not_used_for_the_longest_time_goes_first(tmp_path: Path) -> None:
    cache = Cache(folder=tmp_path, limit_bytes=3500)
    for number in range(3):
        cache.keep(f"key-{number:02d}", lambda path: path.write_bytes(bytes(1000)))
        past = time.time() - 100 + number
        os.utime(tmp_path / f"{number:02d}" / f"key-{number:02d}", (past, past))
    assert cache.found("key-00", Path.read_bytes) is not None  # Used just now: it stays.
    cache.keep("key-03", lambda path: path.write_bytes(bytes(1000)))
    assert [cache.holds(f"key-{number:02d}") for number in range(4)] == [True, False, True, True]


def test_a_damaged_file_counts_as_missing_and_goes(tmp_path: Path) -> None:
    cache = Cache(folder=tmp_path)
    cache.keep("key-00", lambda path: path.write_bytes(b"cut"))

    def read(path: Path) -> bytes:
        raise ValueError(f"{path} is cut")

    assert cache.found("key-00", read) is None
    assert not cache.holds("key-00")


def test_what_fails_while_it_is_written_leaves_nothing(tmp_path: Path) -> None:
    def write(path: Path) -> None:
        path.write_bytes(b"half")
        raise RuntimeError

    with pytest.raises(RuntimeError):
        Cache(folder=tmp_path).keep("key-00", write)
    assert files(tmp_path) == []


def test_a_folder_that_cannot_be_written_keeps_nothing_and_stops_nobody(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    cache = Cache(folder=tmp_path / "file")
    assert kept(cache, "key-00", lambda: b"result", FORM) == b"result"


def test_what_a_killed_process_left_goes_when_it_is_old(tmp_path: Path) -> None:
    (tmp_path / "00").mkdir()
    old, new = tmp_path / "00" / ".key-00.abandoned", tmp_path / "00" / ".key-00.at-work"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (0, 0))
    Cache(folder=tmp_path).keep("key-01", lambda path: path.write_bytes(b"whole"))
    assert (old.exists(), new.exists()) == (False, True)


def test_several_processes_find_whole_results_and_keep_within_bounds(tmp_path: Path) -> None:
    writers = [subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path)]) for _ in range(3)]
    assert [writer.wait() for writer in writers] == [0, 0, 0]
    assert sum(path.stat().st_size for path in files(tmp_path)) <= 40_000 * (1 + 3 / 64) + 3 * 5_500
    assert not [path for path in files(tmp_path) if path.name.startswith(".")]
