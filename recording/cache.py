"""Results that were made before, kept on disk under what they were made of, for any number of processes."""

import contextlib
import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Generic, TypeVar
from uuid import uuid4

from recording.errors import DAMAGED

Value = TypeVar("Value")
GIGABYTE = 10**9
_SHARE = 64
"""A process looks at the whole folder when it has added this fraction of the limit."""
_ABANDONED_SECONDS = 86400.0
"""A file that is not complete after so long has nobody who writes it."""
_added: dict[Path, int] = {}
"""Bytes that this process has added to a folder since it last looked at all of it."""


@dataclass(frozen=True, kw_only=True)
class Cache:
    """A folder of results by key, bounded in size: what was not used for the longest time goes first.

    Each file appears whole or not at all, so that several processes may share the folder, on one machine or on a
    shared disk; two that make the same result at once both write it, and either may win. What cannot be kept, for a
    full or forbidden disk, is not kept; a damaged file is removed and counts as missing. The folder may exceed its
    limit by what each process adds between two looks at all of it, a 64th of the limit.
    """

    folder: Path
    limit_bytes: int = 10 * GIGABYTE

    def found(self, key: str, read: Callable[[Path], Value]) -> Value | None:
        """What is kept under the key, read from its file; None where nothing is."""
        path = self._path(key)
        try:
            value = read(path)
            os.utime(path)  # Used just now; disks are often mounted without times of access.
        except FileNotFoundError:
            return None
        except DAMAGED:
            with contextlib.suppress(OSError):
                path.unlink()
            return None
        return value

    def keep(self, key: str, write: Callable[[Path], None]) -> None:
        """Keep what is written under the key."""
        path = self._path(key)
        partial = path.with_name(f".{path.name}.{uuid4().hex}")
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            try:
                write(partial)
                size = partial.stat().st_size
                partial.replace(path)
            finally:
                partial.unlink(missing_ok=True)
            self._added(size)

    def holds(self, key: str) -> bool:
        """Whether something is kept under the key."""
        return self._path(key).is_file()

    def _path(self, key: str) -> Path:
        """The file of a key; folders by the key's last letters, so that none grows large."""
        return self.folder / key[-2:] / key

    def _added(self, size: int) -> None:
        added = _added.get(self.folder, self.limit_bytes) + size  # The first addition is always looked at.
        _added[self.folder] = added
        if added > self.limit_bytes // _SHARE:
            _added[self.folder] = 0
            self._shrink()

    def _shrink(self) -> None:
        """Remove abandoned files, then those that were not used for the longest time, until the rest is in bounds."""
        files = sorted(self._files())
        total = sum(size for _, size, _ in files)
        abandoned = time.time() - _ABANDONED_SECONDS
        for used, size, path in files:
            partial = path.name.startswith(".")
            if (partial and used < abandoned) or (not partial and total > self.limit_bytes):
                with contextlib.suppress(OSError):
                    path.unlink()
                total -= size

    def _files(self) -> Iterator[tuple[float, int, Path]]:
        """The last use, the size and the path of every file."""
        for path in self.folder.glob("??/*"):
            with contextlib.suppress(FileNotFoundError):  # Another process may have been quicker.
                state = path.stat()
                yield state.st_mtime, state.st_size, path


@dataclass(frozen=True, kw_only=True)
class Form(Generic[Value]):
    """How a kind of result becomes a file, and the file the same result."""

    read: Callable[[Path], Value]
    write: Callable[[Value, Path], None]


def kept(cache: Cache | None, key: str, make: Callable[[], Value], form: Form[Value]) -> Value:
    """What is kept under the key, else what `make` makes, which is then kept; without a cache it is made."""
    if cache is None:
        return make()
    value = cache.found(key, form.read)
    if value is None:
        value = make()
        cache.keep(key, partial(form.write, value))
    return value


def key_of(kind: str, document: dict[str, Any]) -> str:
    """A key for what is made of nothing but the document: the kind, and SHA-256 of canonical JSON."""
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return f"{kind}-{hashlib.sha256(text.encode()).hexdigest()}"
