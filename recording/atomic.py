"""Files and folders that appear whole or not at all."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from recording.errors import InputError


@contextmanager
def whole_file(path: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """A path to write to, which becomes `path` when the block ends well and vanishes when it does not."""
    _refuse_existing(path, overwrite=overwrite)
    partial = _partial_name(path)
    with _usable(path):
        partial.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield partial
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)


@contextmanager
def whole_folder(path: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """An empty folder to fill, which becomes `path` when the block ends well and vanishes when it does not.

    What a killed run left behind under the working name is removed first. With `overwrite` an old result
    stays in its place until the new one is complete. An empty folder in that place is nothing to lose.
    """
    with _usable(path):
        _mend_exchange(path)
    _refuse_existing(path, overwrite=overwrite or (path.is_dir() and not any(path.iterdir())))
    if path.exists() and not path.is_dir():
        raise InputError(f"{path}: expected a folder to replace, got a file: choose another place")
    partial = _partial_name(path)
    with _usable(path):
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        try:
            yield partial
            if path.exists():
                _exchange(partial, path)
            else:
                partial.replace(path)
        finally:
            shutil.rmtree(partial, ignore_errors=True)


def _exchange(new: Path, path: Path) -> None:
    """Put the new folder in the old one's place; a folder cannot be replaced in one step, so two renames."""
    old = _old_name(path)
    shutil.rmtree(old, ignore_errors=True)
    path.rename(old)
    try:
        new.rename(path)
    except OSError:
        old.rename(path)
        raise
    shutil.rmtree(old)


def _mend_exchange(path: Path) -> None:
    """End what a run began that was killed between the two renames, or before it had removed the old folder."""
    old = _old_name(path)
    if path.exists():
        shutil.rmtree(old, ignore_errors=True)
    elif old.is_dir():
        old.rename(path)


def _old_name(path: Path) -> Path:
    return path.with_name(f".{path.name}.old")


def _partial_name(path: Path) -> Path:
    return path.with_name(f".{path.name}.partial")


def _refuse_existing(path: Path, *, overwrite: bool) -> None:
    if path.exists() and not overwrite:
        raise InputError(f"{path} exists already: choose another place, or pass --overwrite to replace it")


@contextmanager
def _usable(path: Path) -> Iterator[None]:
    """Turn a full, missing or forbidden disk into an error that says which file."""
    try:
        yield
    except OSError as error:
        if error.filename is None and error.strerror is None:
            raise
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error
