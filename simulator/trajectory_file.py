"""Recorded people: the path of one of them from a text file (`simulator.trajectory_rows`)."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from recording.checks import Frozen, validated
from recording.errors import InputError
from simulator.source_file import file_inside
from simulator.trajectory_rows import METRES, Row, beginning, by_frames, rows_of, smoothed, turned
from simulator.walk_record import Times, Waypoints, even_knots, recorded

_LONGEST_S = 86_400.0


class Trajectory(Frozen):
    """Which recorded person, and how the file is to be read."""

    file: str
    """Path from the scene's file; it stays in that file's folder or below."""
    id: int
    """The person's number in the file."""
    fps: Annotated[float, Field(ge=1e-3, le=1e6)]
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


def recorded_walk(trajectory: Trajectory, folder: Path) -> tuple[Waypoints, Times]:
    """Way-points (metres) and when each is passed (seconds after the scene begins), smooth and evenly spaced.

    A smoothing spline leaves what is slow and straight as it is, whatever the file's frame rate, and takes away half
    of a movement of `QUICKEST_HZ`, most of a quicker one; it bridges missing frames.
    """
    path = file_inside(folder, trajectory.file)
    rows = rows_of(path)
    own = by_frames(path, [row for row in rows if row[1][0] == trajectory.id])
    if len(own) < 2:
        raise InputError(
            f"{path}: expected two rows at least of id {trajectory.id}, got {len(own)}; its ids: {_ids(rows)}"
        )
    frames = [row[1][1] for row in rows]
    time = (own[:, 1] - beginning(path, (min(frames), max(frames)), trajectory.first_frame)) / trajectory.fps
    if time[-1] - time[0] > _LONGEST_S:
        raise InputError(f"{path}: expected id {trajectory.id} for a day at the most, got {time[-1] - time[0]:.3g} s")
    places = own[:, 2:] * METRES[trajectory.unit]
    knots = even_knots(time[0], time[-1])
    on_scene = turned(smoothed(time, places, knots), trajectory.turn_deg) + np.array(trajectory.shift)
    return recorded(knots, on_scene)


def _ids(rows: list[Row]) -> str:
    """Some of the ids of a file, to be named in an error."""
    ids = sorted({row[1][0] for row in rows})
    return ", ".join(f"{one:g}" for one in ids[:10]) + (", ..." if len(ids) > 10 else "")
