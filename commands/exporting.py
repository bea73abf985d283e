"""Recordings and motions for other tools: export."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.filesize import decimal

from commands.common import WRITING, Output, Writing
from evaluation.scores import check_belongs
from exporting.export import FormatName, export
from recording.parquet import load_motions
from recording.store import load_recording


def export_command(
    recording: Path,
    motions: Path | None = None,
    *,
    format_: Annotated[FormatName, Parameter(name="--format")],
    output: Output,
    common: Writing = WRITING,
) -> None:
    """Write a recording and its motions in another tool's format, into a new folder (docs/exporting.md).

    Example: `unocclude export recordings/wall --format usd -o wall-usd`

    Formats:

    * `ply`: a point cloud a frame
    * `usd`: an animation for Blender
    * `rerun`: depth, points and truth for the Rerun viewer
    * `tapvid3d`: tracks of points, found and true
    * `mot`: places in 3D as MOTChallenge text, found and true

    Args:
        recording: The recording's folder.
        motions: The Parquet file; `motions.parquet` in the recording's folder by default, if there is one.
        format_: Which format; `usd` and `rerun` want the extra of that name.
        output: The folder to write. With `--overwrite` one that an export left is replaced.
    """
    truth = load_recording(recording)
    beside = recording / "motions.parquet"
    place = motions or (beside if beside.is_file() else None)
    answer = load_motions(place) if place is not None else None
    if answer is not None and (warning := check_belongs(truth, answer)):
        common.say(f"warning: {warning}")
    with common.progress():
        export(truth, answer, folder=output, format=format_, overwrite=common.overwrite)
    written = [path for path in output.rglob("*") if path.is_file()]
    common.say(f"written {output}: {len(written)} files, {decimal(sum(path.stat().st_size for path in written))}")
