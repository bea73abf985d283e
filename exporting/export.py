"""A recording and its motions to a folder in another tool's format."""

import json
import os
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from exporting.motchallenge import write_motchallenge
from exporting.ply import write_ply
from exporting.source import Source
from exporting.tapvid3d import write_tapvid3d
from recording.atomic import whole_folder
from recording.errors import InputError
from recording.motions import Motions
from recording.recording import Recording
from recording.version import VERSION

FormatName = Literal["ply", "tapvid3d", "mot", "usd", "rerun"]
ABOUT = "export.json"
"""Stands in every exported folder and says what it was made from."""


def export(
    recording: Recording,
    motions: Motions | None = None,
    *,
    folder: str | os.PathLike[str],
    format: FormatName,
    overwrite: bool = False,
) -> None:
    """Write the recording, and its motions if there are any, into a new folder in the format (docs/exporting.md).

    Frames are read and written one by one. The folder appears whole or not at all; `overwrite` replaces one that an
    export left, no other. That the motions are of this recording is for the caller to know.
    """
    place = Path(folder)
    if place.is_dir() and any(place.iterdir()) and not (place / ABOUT).is_file():
        raise InputError(f"{place}: expected a new folder or an export to replace, got a folder of something else")
    source, write = Source(recording=recording, motions=motions), _WRITERS[format]
    with whole_folder(place, overwrite=overwrite) as partial:
        write(source, partial)
        about = {"format": {"name": "unocclude-export", "kind": format}, **_made_from(source)}
        (partial / ABOUT).write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")


def _made_from(source: Source) -> dict[str, object]:
    about, making = source.recording.metadata, source.motions and source.motions.making
    return {
        "recording": {"name": about.name, "digest": source.digest, "seed": about.seed, "frames": about.frames},
        "motions": making and {"version": making.version, "settings": making.settings},
        "made_by": f"unocclude {VERSION}",
    }


def _write_usd(source: Source, folder: Path) -> None:
    _require("pxr", extra="usd")
    from exporting.usd import write_usd  # noqa: PLC0415 - OpenUSD is optional.

    write_usd(source, folder)


def _write_rerun(source: Source, folder: Path) -> None:
    _require("rerun", extra="rerun")
    from exporting.rerun_log import write_rerun  # noqa: PLC0415 - Rerun is optional, and slow to import.

    write_rerun(source, folder)


def _require(package: str, *, extra: str) -> None:
    if find_spec(package) is None:
        raise InputError(
            f"{extra}: expected the package {package}, which is not installed: run pip install 'unocclude[{extra}]'"
        )


_WRITERS: dict[FormatName, Callable[[Source, Path], None]] = {
    "ply": write_ply,
    "tapvid3d": write_tapvid3d,
    "mot": write_motchallenge,
    "usd": _write_usd,
    "rerun": _write_rerun,
}
