"""The readers that are fuzzed: valid files are read, and files changed at random are read or refused."""

import re
from pathlib import Path

import numpy as np
import pytest

from fuzz.targets import TARGETS

ROOT = Path(__file__).parents[2]

CHANGED = 60


def changed(content: bytes, generator: np.random.Generator) -> bytes:
    """The file with some bytes set, cut out or doubled."""
    data = bytearray(content)
    for _ in range(generator.integers(1, 5)):
        first, length = int(generator.integers(0, len(data) + 1)), int(generator.integers(1, 9))
        kind = generator.integers(3)
        part = generator.bytes(length) if kind == 0 else b"" if kind == 1 else bytes(data[first : first + length]) * 2
        data[first : first + length] = part
    return bytes(data)


@pytest.mark.filterwarnings("ignore")  # What a library warns of is not what is tested here.
@pytest.mark.usefixtures("_without_type_checks")
@pytest.mark.parametrize("reader", TARGETS)
def test_a_reader_reads_or_refuses(reader: str, tmp_path: Path) -> None:
    """Anything but an `InputError` that a reader raises fails this; so does one at a valid file."""
    target, generator = TARGETS[reader], np.random.default_rng(1)
    seeds = target.seeds()
    for content in seeds:
        target.take_valid(content, tmp_path)
    known = ROOT / "fuzz" / "corpus" / reader
    found = [path.read_bytes() for path in sorted(known.iterdir())] if known.is_dir() else []
    for content in [*found, *(changed(seeds[0], generator) for _ in range(CHANGED))]:
        target.take(content, tmp_path)


def test_make_fuzzes_every_reader() -> None:
    (line,) = re.findall(r"^READERS \?= ((?:.*\\\n)*.*)", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(line.replace("\\", "").split()) == sorted(TARGETS)
