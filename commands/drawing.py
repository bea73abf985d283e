"""Drawing recordings and motions: draw, contact-sheet, figure."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from algorithm.settings import Preset
from commands.common import WRITING, Output, Writing
from evaluation.contact_sheet import draw_contact_sheet
from evaluation.figures.catalogue import FIGURES, chosen_figures, draw_figures
from evaluation.kept import Kept
from evaluation.picture import draw_overview
from evaluation.scores import check_belongs
from recording.errors import InputError
from recording.parquet import load_motions
from recording.store import load_recording

FIGURES_HELP = "Figures: " + ", ".join(FIGURES)


def draw_command(recording: Path, motions: Path | None = None, *, output: Output, common: Writing = WRITING) -> None:
    """Draw a solved recording: frames, segments, representatives, completed motion.

    Example: `unocclude draw recordings/wall -o wall.png`

    Args:
        recording: The recording's folder.
        motions: The Parquet file; `motions.parquet` in the recording's folder by default.
        output: The picture, PNG or SVG by its ending.
    """
    truth, answer = load_recording(recording), load_motions(motions or recording / "motions.parquet")
    check_belongs(truth, answer)
    draw_overview(truth, answer, output, overwrite=common.overwrite)
    common.say(f"drawn {output}")


def contact_sheet_command(recording: Path, *, output: Output, common: Writing = WRITING) -> None:
    """Draw six frames of a recording: depth, objects, and why returns are missing.

    Example: `unocclude contact-sheet recordings/wall -o sheet.png`

    Args:
        recording: The recording's folder.
        output: The picture, PNG or SVG by its ending.
    """
    draw_contact_sheet(load_recording(recording), output, overwrite=common.overwrite)
    common.say(f"drawn {output}")


def figure_command(
    *numbers: str,
    output: Output,
    preset: Preset = "default",
    size: str | None = None,
    frames: int | None = None,
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    common: Writing = WRITING,
) -> None:
    """Draw figures of the paper from our recordings and motions, as PNG and SVG.

    Example: `unocclude figure 3 10 -o figures`

    Args:
        numbers: The paper's numbers, or `all`.
        output: Folder for the pictures, and to keep recordings and motions in: the next call with the same folder, of
            `table1` too, uses them again.
        preset: Settings to solve with.
        size: Picture size in place of the scenes' own, such as `2x`.
        frames: Number of frames in place of the scenes' own.
        workers: Processes that cast, or that solve.
    """
    if not numbers:
        raise InputError("expected at least one figure, got none: try 'unocclude figure 3 -o figures'")
    with common.progress():
        kept = Kept(folder=output, size=size, frames=frames, workers=workers, overwrite=common.overwrite)
        drawn = draw_figures(chosen_figures(numbers), kept, preset, folder=output, overwrite=common.overwrite)
    common.say(f"drawn {', '.join(map(str, drawn))}")
