"""Recorded people: the path of one of them from a text file, as pedestrian data sets publish them.

A line says `id frame x y` or `id frame x y z`, separated by blanks, tabs, commas or semicolons; `#` begins a comment,
and the first line may name the columns. Frames need not be sorted, and some may be missing.
"""

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from jaxtyping import Float
from pydantic import Field
from scipy.interpolate import make_smoothing_spline

from recording.checks import Frozen, validated
from recording.errors import InputError

QUICKEST_HZ = 1.0
"""Half of a movement as quick as this is smoothed away: what is quicker is the tracker's noise or the gait's sway."""
KNOT_S = 0.2
"""Between the way-points made from a file."""
_SMOOTHED_FROM = 5  # Rows: what the smoothing spline needs.
_DIGITS = 4  # A tenth of a millimetre: the resolved scene stays readable.
_COLUMNS = ("id", "frame", "x", "y")

Row = tuple[int, tuple[float, float, float, float]]
"""The line's number in the file; id, frame, x and y."""


class Trajectory(Frozen):
    """Which recorded person, and how the file is to be read."""

    file: str
    """Path from the scene's file; it stays in that file's folder or below."""
    id: int
    """The person's number in the file."""
    fps: Annotated[float, Field(gt=0)]
    """The file's frames a second."""
    unit: Literal["m", "cm"] = "m"
    """Of x and y."""
    first_frame: float | None = None
    """The file's frame in which the scene begins; by default the first one in the file."""
    shift: tuple[float, float] = (0.0, 0.0)
    """Added to x and y after the turn, metres."""
    turn_deg: float = 0.0
    """By how much the file's ground is turned about its origin, from x towards y, degrees."""


def with_recorded_walks(document: dict[str, Any], *, place: Path) -> dict[str, Any]:
    """The scene's document with way-points and times in place of every `trajectory` of its people.

    So a scene, once it is loaded, stands for itself: a recording of it needs no other file. `place` is the scene's
    file. What else may be wrong with the document is left to the schema.
    """
    people = document.get("people")
    if not isinstance(people, list):
        return document
    return document | {"people": [_with_walk(person, place, number) for number, person in enumerate(people)]}


def _with_walk(person: Any, place: Path, number: int) -> Any:
    """The person with the walk that was recorded, if the person names one."""
    if not isinstance(person, dict) or "trajectory" not in person:
        return person
    source = f"{place}: people.{number}.trajectory"
    others = [key for key in ("waypoints", "speed", "times") if key in person]
    if others:
        raise InputError(f"{source}: expected it in place of {', '.join(map(repr, others))}, got both: keep one")
    waypoints, times = recorded_walk(validated(Trajectory, person["trajectory"], source=source), place.parent)
    return {key: value for key, value in person.items() if key != "trajectory"} | {
        "waypoints": waypoints,
        "times": times,
    }


def recorded_walk(trajectory: Trajectory, folder: Path) -> tuple[list[tuple[float, float]], list[float]]:
    """Way-points (metres) and when each is passed (seconds after the scene begins), smooth and evenly spaced.

    A smoothing spline leaves what is slow and straight as it is, whatever the file's frame rate, and takes away half
    of a movement of `QUICKEST_HZ`, most of a quicker one; it bridges missing frames.
    """
    path = file_inside(folder, trajectory.file)
    rows = _rows(path)
    if not rows:
        raise InputError(f"{path}: expected lines 'id frame x y', got none")
    own = _one_person(path, rows, trajectory.id)
    begin = min(row[1][1] for row in rows) if trajectory.first_frame is None else trajectory.first_frame
    time = (own[:, 1] - begin) / trajectory.fps
    places = own[:, 2:] * (0.01 if trajectory.unit == "cm" else 1.0)
    knots = np.linspace(time[0], time[-1], max(2, round(float(time[-1] - time[0]) / KNOT_S) + 1))
    smooth = _on_scene(_smoothed(time, places, knots), trajectory)
    waypoints = [(round(float(x), _DIGITS), round(float(y), _DIGITS)) for x, y in smooth]
    return waypoints, [round(float(knot), _DIGITS) for knot in knots]


def file_inside(folder: Path, file: str) -> Path:
    """The file's path; refused where it leads out of the folder."""
    path = (folder / file).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise InputError(f"file {file!r}: expected one in the scene's folder {folder} or below: copy it there")
    return path


def _rows(path: Path) -> list[Row]:
    """The rows of all people."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or "no UTF-8"
        raise InputError(f"{path}: expected a readable text file of trajectories, got: {reason}") from None
    filled = [(number, cells) for number, line in enumerate(lines, start=1) if (cells := _cells(line))]
    columns = list(range(len(_COLUMNS)))
    if filled and not any(map(_is_number, filled[0][1])):
        columns = _named_columns(filled.pop(0)[1]) or columns
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
    return person, frame, x, y


def _one_person(path: Path, rows: list[Row], person: int) -> Float[np.ndarray, "row 4"]:
    """The rows of one person, by growing frames."""
    own = sorted((row for row in rows if row[1][0] == person), key=lambda row: row[1][1])
    if len(own) < 2:
        ids = sorted({row[1][0] for row in rows})
        known = ", ".join(f"{one:g}" for one in ids[:10]) + (", ..." if len(ids) > 10 else "")
        raise InputError(f"{path}: expected two rows at least of id {person}, got {len(own)}; its ids: {known}")
    for (_, before), (line, after) in pairwise(own):
        if before[1] == after[1]:
            raise InputError(f"{path}, line {line}: expected every frame of id {person} once, got {after[1]:g} again")
    return np.array([values for _, values in own])


def _smoothed(
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
    return np.stack([make_smoothing_spline(time, axis, lam=penalty)(knots) for axis in places.T], axis=-1)


def _on_scene(places: Float[np.ndarray, "knot 2"], trajectory: Trajectory) -> Float[np.ndarray, "knot 2"]:
    """The places turned and shifted onto the scene's ground."""
    turn = np.radians(trajectory.turn_deg)
    scene_from_file = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return places @ scene_from_file.T + np.array(trajectory.shift)
