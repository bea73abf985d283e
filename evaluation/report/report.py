"""The page of any folder of results."""

from collections.abc import Callable, Mapping
from pathlib import Path

from evaluation.report.page import Page
from evaluation.report.paper_table import TABLE1, table1_page
from evaluation.report.side_by_side import COMPARISON, comparison_page
from evaluation.report.solved import solved_page
from evaluation.report.swept import SUMMARY, sweep_page
from evaluation.scores import check_belongs
from recording.checks import lack_of
from recording.errors import InputError
from recording.motions import Motions
from recording.parquet import load_motions
from recording.recording import Recording
from recording.store import load_recording

RECORDING = "recording.json"
_PAGES: Mapping[str, Callable[[Path], Page]] = {
    COMPARISON: comparison_page,
    SUMMARY: sweep_page,
    TABLE1: table1_page,
}
"""By the file that makes a folder what it is."""


def is_recording(folder: Path) -> bool:
    """Whether the folder holds a recording."""
    return (folder / RECORDING).is_file()


def load_solved(folder: Path, motions: Path | None = None) -> tuple[Recording, Motions]:
    """A recording and its motions, by default those in its folder; InputError where they do not belong together."""
    place = motions or folder / "motions.parquet"
    if not is_recording(folder):
        raise InputError(f"{folder}: expected a recording, but {lack_of(RECORDING, folder)}")
    if not place.is_file():
        raise InputError(f"{place}: expected motions, but there are none: run 'unocclude solve {folder}' first")
    recording, found = load_recording(folder), load_motions(place)
    check_belongs(recording, found)
    return recording, found


def report_page(folder: Path, motions: Path | None = None) -> Page:
    """The page of a solved recording, a comparison, a sweep or Table 1, whichever the folder holds."""
    if is_recording(folder):
        return solved_page(*load_solved(folder, motions))
    if motions is not None:
        raise InputError(f"{folder}: expected a recording beside the motions, but {lack_of(RECORDING, folder)}")
    page = next((make for name, make in _PAGES.items() if (folder / name).is_file()), None)
    if page is None:
        what = lack_of(" or ".join((RECORDING, *_PAGES)), folder)
        raise InputError(f"{folder}: expected a recording or what compare, sweep or table1 left, but {what}")
    return page(folder)
