"""Text files of tracked people, as pedestrian data sets publish them: their rows, and smooth places from them.

A line says `id frame x y` or `id frame x y z`, separated by blanks, tabs, commas or semicolons; `#` begins a comment,
and the first line may name the columns. Frames need not be sorted, and some may be missing.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.interpolate import make_smoothing_spline

from recording.checks import text_of
from recording.errors import InputError

QUICKEST_HZ = 1.0
"""Half of a movement as quick as this is smoothed away: what is quicker is the tracker's noise or the gait's sway."""
METRES = {"m": 1.0, "cm": 0.01}
"""Of the units that a file may be written in."""
_SMOOTHED_FROM = 5  # Rows: what the smoothing spline needs.
_LARGEST = 1e9  # Of any number in a row: places in centimetres of a country, frames of years.
_COLUMNS = ("id", "frame", "x", "y")

Row = tuple[int, tuple[float, float, float, float]]
"""The line's number in the file; id, frame, x and y."""


def rows_of(path: Path) -> list[Row]:
    """The rows of all people: one at least."""
    lines = text_of(path, "text file of trajectories").splitlines()
    filled = [(number, cells) for number, line in enumerate(lines, start=1) if (cells := _cells(line))]
    columns = list(range(len(_COLUMNS)))
    if filled and not any(map(_is_number, filled[0][1])):
        columns = _named_columns(filled.pop(0)[1]) or columns
    if not filled:
        raise InputError(f"{path}: expected lines 'id frame x y', got none")
    return [(number, _numbers(path, number, cells, columns)) for number, cells in filled]


def _cells(line: str) -> list[str]:
    """What stands in a line before its comment."""
    return line.split("#", maxsplit=1)[0].replace(",", " ").replace(";", " ").split()


def _named_columns(cells: list[str]) -> list[int] | None:
    """Where id, frame, x and y stand, if these cells name all of them."""
    names = [cell.strip("\"'").lower().split("/")[0] for cell in cells]
    return [names.index(name) for name in _COLUMNS] if set(_COLUMNS) <= set(names) else None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _numbers(path: Path, number: int, cells: list[str], columns: list[int]) -> tuple[float, float, float, float]:
    """Id, frame, x and y of a line."""
    try:
        person, frame, x, y = (float(cells[column]) for column in columns)
    except (ValueError, IndexError):
        raise InputError(
            f"{path}, line {number}: expected numbers 'id frame x y [z]', got {' '.join(cells)!r}"
        ) from None
    if not np.isfinite([person, frame, x, y]).all():
        raise InputError(f"{path}, line {number}: expected finite numbers, got {' '.join(cells)!r}: leave the line out")
    if np.max(np.abs([person, frame, x, y])) > _LARGEST:
        raise InputError(f"{path}, line {number}: expected numbers up to {_LARGEST:g}, got {' '.join(cells)!r}")
    return person, frame, x, y


def beginning(path: Path, frames: tuple[float, float], wish: float | None) -> float:
    """The file's frame in which a scene begins: the one wished for, if the file, first to last frame, has it."""
    first, last = frames
    if wish is not None and not first <= wish <= last:
        raise InputError(f"{path}: expected a first_frame from {first:g} to {last:g}, the file's own, got {wish:g}")
    return first if wish is None else wish


def turned(places: Float[np.ndarray, "*shape 2"], turn_deg: float) -> Float[np.ndarray, "*shape 2"]:
    """The places turned about the origin, from x towards y."""
    turn = np.radians(turn_deg)
    scene_from_file = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return places @ scene_from_file.T


def by_frames(path: Path, own: list[Row]) -> Float[np.ndarray, "row 4"]:
    """The rows of one person, by growing frames."""
    own = sorted(own, key=lambda row: row[1][1])
    for (_, before), (line, after) in pairwise(own):
        if before[1] == after[1]:
            raise InputError(
                f"{path}, line {line}: expected every frame of id {after[0]:g} once, got {after[1]:g} again"
            )
    return np.array([values for _, values in own]).reshape(-1, 4)


def smoothed(
    time: Float[np.ndarray, "row"], places: Float[np.ndarray, "row 2"], knots: Float[np.ndarray, "knot"]
) -> Float[np.ndarray, "knot 2"]:
    """The places at the knots.

    Of rows at a rate r, the spline that minimises sum(error^2) + penalty * integral(second derivative^2) leaves
    1 / (1 + penalty / r * w^4) of a movement of the angular frequency w.
    """
    if len(time) < _SMOOTHED_FROM:
        return np.stack([np.interp(knots, time, axis) for axis in places.T], axis=-1)
    rate = 1 / float(np.median(np.diff(time)))
    penalty = rate / (2 * np.pi * QUICKEST_HZ) ** 4
    return make_smoothing_spline(time, places, lam=penalty)(knots)
