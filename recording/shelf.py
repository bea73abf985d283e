"""Where a data set is kept: in a folder, or at a URL that fsspec knows, such as `s3://bucket/data`.

Either way a recording is made in a folder of this machine, or at least of the same disk, and stands on the shelf when
all of it does: a folder by one rename; at a URL `recording.json` comes last, and what has none is no recording.
"""

import os
import shutil
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol, runtime_checkable
from uuid import uuid4

import fsspec

from recording.atomic import whole_file
from recording.errors import InputError

_LAST = "recording.json"
_MAKING = ".making"
"""The folder of what is being made, in that of a data set."""


@runtime_checkable
class Shelf(Protocol):
    """A place for recordings by name, and for files that tell of them."""

    def holds(self, name: str) -> bool:
        """Whether something stands there under the name."""

    def fetched(self, name: str) -> AbstractContextManager[Path]:
        """What stands there under the name, as a path of this machine within a block."""

    def making(self, name: str) -> AbstractContextManager[Path]:
        """A path for a recording to be made at; it stands there under the name when the block ends well.

        What stood there before goes then. Two who make the same at once do not disturb each other.
        """

    def write(self, name: str, text: str) -> None:
        """Put a file there, in place of an old one."""

    def tidy(self) -> None:
        """Remove what killed runs have left; nobody must be making anything."""


def shelf_at(place: str | Path) -> Shelf:
    """The shelf in a folder, or at a URL."""
    return _Remote(place) if isinstance(place, str) and "://" in place else _Folder(Path(place))


class _Folder:
    """A shelf in a folder, which several machines may share."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def holds(self, name: str) -> bool:
        return (self._path / name).exists()

    @contextmanager
    def fetched(self, name: str) -> Iterator[Path]:
        yield self._path / name

    @contextmanager
    def making(self, name: str) -> Iterator[Path]:
        own = self._path / _MAKING / uuid4().hex
        try:
            own.mkdir(parents=True)
            yield own / name
            if (own / name).is_dir():
                _put(own / name, self._path / name, own / "old")
        except OSError as error:
            raise InputError(f"{self._path / name}: cannot be written: {error.strerror}") from error
        finally:
            shutil.rmtree(own, ignore_errors=True)

    def write(self, name: str, text: str) -> None:
        with whole_file(self._path / name, overwrite=True) as partial:
            partial.write_text(text, encoding="utf-8")

    def tidy(self) -> None:
        shutil.rmtree(self._path / _MAKING, ignore_errors=True)
        with suppress(OSError):  # It holds something, or is not there.
            self._path.rmdir()


class _Remote:
    """A shelf at a URL."""

    def __init__(self, url: str) -> None:
        self._url = url.rstrip("/")

    def holds(self, name: str) -> bool:
        system, root = self._opened()
        return bool(system.exists(f"{root}/{name}/{_LAST}") or system.isfile(f"{root}/{name}"))

    @contextmanager
    def fetched(self, name: str) -> Iterator[Path]:
        system, root = self._opened()
        with TemporaryDirectory() as folder:
            system.get(f"{root}/{name}", f"{folder}/{name}", recursive=True)
            yield Path(folder) / name

    @contextmanager
    def making(self, name: str) -> Iterator[Path]:
        system, root = self._opened()
        with TemporaryDirectory() as folder:
            own = Path(folder) / name
            yield own
            if system.exists(f"{root}/{name}/{_LAST}"):
                system.rm(f"{root}/{name}", recursive=True)
            files = [path for path in sorted(own.rglob("*")) if path.is_file() and path.name != _LAST]
            for path in (*files, *own.glob(_LAST)):
                goal = f"{root}/{path.relative_to(folder).as_posix()}"
                system.makedirs(goal.rpartition("/")[0], exist_ok=True)
                system.put_file(os.fspath(path), goal)

    def write(self, name: str, text: str) -> None:
        system, root = self._opened()
        system.makedirs(root, exist_ok=True)
        system.pipe_file(f"{root}/{name}", text.encode())

    def tidy(self) -> None:
        """Nothing to do: what is being made is not there."""

    def _opened(self) -> tuple[Any, str]:
        """The file system, without what it remembers of earlier looks, and the path in it."""
        try:
            system, root = fsspec.core.url_to_fs(self._url)
        except (ImportError, ValueError) as error:  # The package of that kind of URL, or the kind.
            raise InputError(f"{self._url}: expected a URL that fsspec can open here, but {error}") from None
        system.invalidate_cache()
        return system, root.rstrip("/")


def _put(new: Path, place: Path, aside: Path) -> None:
    """Put a recording into its place by one rename; what stood there goes."""
    try:
        new.rename(place)
    except OSError:
        if not place.exists():
            raise
        place.rename(aside)
        new.rename(place)
