"""What a sweep has done so far, in a file that a killed sweep leaves behind and the next call goes on with."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from pydantic import TypeAdapter, ValidationError

from recording.atomic import whole_file

_NAME = ".unfinished.jsonl"


@dataclass(frozen=True, kw_only=True)
class Done:
    """What became of a trial."""

    key: str
    scores: dict[str, float | None] | None = None
    """By dotted key."""
    failure: str | None = None
    """Why there are no scores."""


_READER = TypeAdapter(Done)


@dataclass(frozen=True, kw_only=True)
class Journal:
    """A line for each trial that is done; the last one may be cut off."""

    known: dict[str, Done]
    """By key, failures left out: they are tried again."""
    file: TextIO

    def add(self, done: Done) -> None:
        """Write down what was done; it is there before this returns, whatever happens next to this process."""
        self.file.write(json.dumps(vars(done), allow_nan=False) + "\n")
        self.file.flush()


@contextmanager
def journal(folder: Path, *, afresh: bool = False) -> Iterator[Journal]:
    """The journal in the folder, `afresh` without what it holds."""
    path = folder / _NAME
    known = {} if afresh else _known(path)
    with whole_file(path, overwrite=True) as partial:  # Without what was cut off.
        partial.write_text("".join(json.dumps(vars(done)) + "\n" for done in known.values()), encoding="utf-8")
    with path.open("a", encoding="utf-8") as file:
        yield Journal(known=known, file=file)


def remove_journal(folder: Path) -> None:
    """The sweep is complete."""
    (folder / _NAME).unlink(missing_ok=True)


def _known(path: Path) -> dict[str, Done]:
    if not path.is_file():
        return {}
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)
    done = (_done(line) for line in lines if line.endswith("\n"))
    return {one.key: one for one in done if one is not None and one.failure is None}


def _done(line: str) -> Done | None:
    """What a line says; None where it is damaged: that trial is run again."""
    try:
        return _READER.validate_json(line)
    except ValidationError:
        return None
