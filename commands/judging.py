"""Judging recordings and motions: evaluate, verify, table1, compare."""

import json
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from algorithm.settings import Preset
from commands.common import COMMON, WRITING, Common, Output, Writing
from evaluation.compare import compared
from evaluation.compare_tables import comparison_document, comparison_text, write_comparison
from evaluation.holes import hole_rows, hole_table
from evaluation.kept import Kept
from evaluation.methods import METHODS
from evaluation.remarks import remarks
from evaluation.scores import check_belongs, evidence_of, scores_of
from evaluation.summary import summary
from evaluation.table1 import PRESETS, measured_rows
from evaluation.table1_text import require_no_tables, tables_of, text_of, write_tables
from recording.errors import InputError
from recording.manifest import MANIFEST
from recording.parquet import load_motions
from recording.store import load_recording
from recording.verify import Report, verify
from recording.verify_set import SetReport, verify_set

METHODS_HELP = "Methods: " + ", ".join(METHODS)


def evaluate_command(
    recording: Path,
    motions: Path | None = None,
    *,
    holes: Annotated[bool, Parameter(negative="")] = False,
    json_: Annotated[bool, Parameter(name="--json")] = False,
    common: Common = COMMON,
) -> None:
    """Score motions against the truth.

    Example: `unocclude evaluate recordings/wall --json`

    Args:
        recording: The recording's folder.
        motions: The Parquet file; `motions.parquet` in the recording's folder by default.
        holes: Each hole by itself too: what hides, and the errors beside those of a straight line through it.
        json_: One JSON object in place of a table.
    """
    truth, answer = load_recording(recording), load_motions(motions or recording / "motions.parquet")
    warning = check_belongs(truth, answer)
    if warning is not None:
        common.say(f"warning: {warning}")
    if all(frame.labels is None for frame in truth.frames[:1]):
        common.say("warning: the recording holds no truth to score against: import it with --masks")
    with common.progress():
        evidence = evidence_of(truth, answer)
        found = scores_of(evidence)
        rows = hole_rows(evidence) if holes else []
    if json_:
        print(json.dumps(found | ({"hole_list": [asdict(row) for row in rows]} if holes else {}), allow_nan=False))
    else:
        print(summary(found, remarks(truth, answer)) + (f"\n\n{hole_table(rows)}" if holes else ""))


def verify_command(
    recording: Path,
    *,
    digest: Annotated[bool, Parameter(negative="")] = False,
    workers: Annotated[int | None, Parameter(validator=Number(gte=1))] = None,
    common: Common = COMMON,
) -> None:
    """Check a simulated recording, or a whole data set, against itself; exit status 1 where a bound is passed.

    Example: `unocclude verify recordings/wall`

    Its last line is the recording's digest, by which motions and corrections say which recording they are of.

    Args:
        recording: The recording's folder, or that of a data set with its `manifest.json`.
        digest: Print the digest alone, of any recording, and check nothing.
        workers: Processes that verify the recordings of a data set, one for each core by default.
    """
    with common.progress():
        if digest:
            print(load_recording(recording).digest())
            return
        if (recording / MANIFEST).is_file():
            found: Report | SetReport = verify_set(recording, workers=workers or os.cpu_count() or 1)
            text = found.text
        else:
            one = load_recording(recording)
            found = verify(one)
            text = f"{found.text}\ndigest: {one.digest()}"
    print(text)
    if not found.passes:
        sys.exit(1)


def table1_command(
    *,
    scenes: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = ("all",),
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    preset: Preset | None = None,
    counts_only: Annotated[bool, Parameter(negative="")] = False,
    size: str | None = None,
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    common: Writing = WRITING,
) -> None:
    """Print Table 1 of the paper beside ours: what the scenes hold, and what is found in them.

    Example: `unocclude table1 --scenes wall house -o table1`

    Args:
        scenes: Names of scenes, or `all`.
        output: Folder for `table1.csv`, `table1.md` and `table1.tex`, and to keep recordings and motions in: the next
            call with the same folder uses them again, and with --overwrite replaces the tables.
        preset: Settings to solve with; both presets, one after the other, by default.
        counts_only: Count what the recordings hold and solve nothing.
        size: Picture size in place of the scenes' own, such as `2x`.
        workers: Processes that cast, or that solve; with several, the times are those of scenes that share the machine.
    """
    presets = () if counts_only else (preset,) if preset else PRESETS
    if output is not None:
        require_no_tables(output, overwrite=common.overwrite)
    with common.progress(), TemporaryDirectory() as passing:
        kept = Kept(folder=output or Path(passing), size=size, workers=workers, overwrite=common.overwrite)
        rows = measured_rows(scenes, kept, presets)
    if output is not None:
        write_tables(rows, output, overwrite=common.overwrite)
    print(text_of(tables_of(rows)))


def compare_command(
    *recordings: Path,
    methods: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = tuple(METHODS),
    motions: Annotated[tuple[str, ...], Parameter(negative="")] = (),
    output: Output = Path("comparison"),
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    json_: Annotated[bool, Parameter(name="--json")] = False,
    common: Writing = WRITING,
) -> None:
    """Score methods side by side: our presets, the baselines, and ours with one stage that knows the truth.

    Example: `unocclude compare recordings/wall recordings/house --methods default,tracker -o comparison`

    Args:
        recordings: Folders of recordings, or of data sets with a `manifest.json`.
        methods: Names of methods, separated by commas or blanks.
        motions: `NAME=FOLDER`, a method from elsewhere: the folder holds `<recording>.parquet` or
            `<recording>/motions.parquet` for every recording. May be given several times.
        output: Folder for the tables, the plot, and every outcome: the same call again goes on where it ended, and
            makes again what depends on something that has changed. With `--overwrite` all is made again.
        workers: Processes at work at the same time.
        json_: One JSON object in place of tables.
    """
    elsewhere = _folders_by_name(motions)
    names = [name for text in methods for name in text.split(",") if name]
    with common.progress():
        outcomes = compared(
            recordings, output, methods=names, elsewhere=elsewhere, workers=workers, overwrite=common.overwrite
        )
    write_comparison(outcomes, output)
    print(json.dumps(comparison_document(outcomes), allow_nan=False) if json_ else comparison_text(outcomes))
    for outcome in outcomes:
        if outcome.failure is not None:
            common.say(f"warning: {outcome.method} failed on {outcome.recording}: {outcome.failure}")


def _folders_by_name(texts: Sequence[str]) -> dict[str, Path]:
    """The methods from elsewhere as the command line has them."""
    folders: dict[str, Path] = {}
    for text in texts:
        name, _, folder = text.partition("=")
        if not re.fullmatch(r"[A-Za-z0-9][\w.-]*", name) or not folder:
            raise InputError(f"--motions: expected NAME=FOLDER with a name of letters, digits, '_', '-', got {text!r}")
        if name in folders:
            raise InputError(f"--motions: expected every name once, got {name!r} several times")
        folders[name] = Path(folder)
    return folders
