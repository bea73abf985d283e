"""A reader that is fuzzed."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from recording.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Target:
    """A reader of a file.

    It may refuse with an `InputError`; whatever else it raises, or that it hangs or fills the memory, is a finding.
    """

    name: str
    """The file's path in the folder that `read` is given; `read` puts what else it needs beside it."""
    read: Callable[[Path], object]
    seeds: Callable[[], list[bytes]]
    """Valid files."""

    def take(self, content: bytes, folder: Path) -> None:
        """Read the content as the file, which may be refused."""
        with suppress(InputError):
            self.take_valid(content, folder)

    def take_valid(self, content: bytes, folder: Path) -> None:
        """Read the content as the file, which may not be refused."""
        place = folder / self.name
        place.parent.mkdir(exist_ok=True)
        place.write_bytes(content)
        self.read(folder)


def saved(name: str, *saves: Callable[[Path], object]) -> list[bytes]:
    """What each of some functions writes to a path of that name."""
    found = []
    for save in saves:
        with TemporaryDirectory() as folder:
            save(Path(folder) / name)
            found.append((Path(folder) / name).read_bytes())
    return found
