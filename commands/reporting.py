"""Results to look at: report."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from commands.common import WRITING, Writing
from evaluation.figures.stages import Solved
from evaluation.report.page import write_page
from evaluation.report.report import load_solved, report_page
from evaluation.report.video import require_video, write_video
from recording.errors import InputError


def report_command(
    folder: Path,
    motions: Path | None = None,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    video: Path | None = None,
    common: Writing = WRITING,
) -> None:
    """Make one self-contained page of a solved recording, or of what `compare`, `sweep` or `table1` left in a folder.

    Example: `unocclude report recordings/wall -o wall.html`

    The failures stand first; of a recording there is a view in 3D with a time slider. The page loads nothing.

    Args:
        folder: The recording's folder, or the other commands' output.
        motions: The Parquet file of a recording; `motions.parquet` in its folder by default.
        output: The page to write; `report.html` in the folder by default.
        video: Write a video of the solved recording, `.mp4` or `.gif`; the page then only where `--output` asks for it.
    """
    page = output or (folder / "report.html" if video is None else None)
    for place in (page, video):
        if place is not None and place.exists() and not common.overwrite:
            raise InputError(f"{place} exists already: choose another place, or pass --overwrite to replace it")
    if page is not None and page.suffix not in (".html", ".htm"):
        raise InputError(f"{page}: expected a page that ends in .html; a video is asked for with --video")
    with common.progress():
        if video is not None:
            require_video(video)
            recording, found = load_solved(folder, motions)
            write_video(Solved(recording=recording, motions=found), video, overwrite=common.overwrite)
            common.say(f"written {video}")
        if page is not None:
            write_page(report_page(folder, motions), page, overwrite=common.overwrite)
            common.say(f"written {page}: {page.stat().st_size / 1e6:.1f} MB")
