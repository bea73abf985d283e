"""Fuzz one reader with Atheris for some minutes: `python fuzz/run.py frame --minutes 10`.

Valid files are changed, and what reaches new code is changed further. A finding ends the run, is written to
`fuzz/findings/` and belongs, made small, into `fuzz/corpus/<reader>/`, which the tests read.
"""

import argparse
import os
import sys
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris

os.environ["NUMBA_DISABLE_JIT"] = "1"  # Numba does not compile what the fuzzer has changed.
_LIBRARIES = ("json", "pypcd4", "rosbags", "ruamel", "tomllib", "trimesh", "yaml", "zipfile")
"""That read in Python: the fuzzer sees which lines a file reaches."""

with atheris.instrument_imports(
    include=["algorithm", "evaluation", "importing", "recording", "simulator", *_LIBRARIES]
):
    ROOT = Path(__file__).resolve().parents[1]
    sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "importing")]
    from fuzz.targets import TARGETS

HERE = Path(__file__).resolve().parent
_OPTIONS = ("-timeout=20", "-rss_limit_mb=3000", "-max_len=20000", "-print_final_stats=1", "-verbosity=0")


def main() -> None:
    """Fuzz the reader that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reader", choices=TARGETS)
    parser.add_argument("--minutes", type=float, default=10.0)
    chosen = parser.parse_args()
    target = TARGETS[chosen.reader]
    (HERE / "findings").mkdir(exist_ok=True)
    with TemporaryDirectory() as passing:
        seeds, folder = Path(passing) / "seeds", Path(passing) / "folder"
        seeds.mkdir()
        folder.mkdir()
        for number, content in enumerate(target.seeds()):
            (seeds / str(number)).write_bytes(content)

        findings = f"-artifact_prefix={HERE / 'findings' / chosen.reader}-"
        known = [str(place) for place in (HERE / "corpus" / chosen.reader,) if place.is_dir()]
        seconds = f"-max_total_time={round(60 * chosen.minutes)}"
        atheris.Setup(
            [sys.argv[0], *_OPTIONS, seconds, findings, str(seeds), *known], partial(target.take, folder=folder)
        )
        atheris.Fuzz()


if __name__ == "__main__":
    main()
