"""Recorded crowds: a trajectory file's people, in a window of time and on a place of ground that suit a scene.

What the settings leave open is chosen: the file's frame in which the scene begins, how the file's ground lies before
the camera, and who of the people takes part.
"""

from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from jaxtyping import Float
from pydantic import Field, PositiveInt, model_validator

from recording.camera import Camera
from recording.checks import Frozen
from recording.errors import InputError
from simulator.body import body_names
from simulator.body_name import BodyName
from simulator.casting import Surroundings, Walks, cast_of
from simulator.path import FASTEST_WALK
from simulator.source_file import digest_of_file, file_inside
from simulator.tracks import STEP_S, Tracks, tracks_of
from simulator.trajectory_rows import METRES, beginning, turned
from simulator.walk_record import RUN_OUT_S, walk_record

_WINDOW_S = 1.0  # From one window that is tried to the next.
_TURNS_DEG = tuple(45.0 * eighth for eighth in range(8))
_FARTHEST_M = 6.0  # Before the camera: where the middle of a crowd is set.
_NEXT_PHASE = 0.618  # Cycles, from one walker to the next: nobody walks in step.


class RecordedCrowd(Frozen):
    """Which file, how it is to be read, and what of it is wanted."""

    file: str
    """Path from the scene's file; it stays in that file's folder or below."""
    fps: Annotated[float, Field(ge=1e-3, le=1e6)]
    """The file's frames a second."""
    unit: Literal["m", "cm"] = "m"
    """Of x and y."""
    people: tuple[PositiveInt, PositiveInt] = (2, 12)
    """How many of them, at least and at most."""
    first_frame: float | None = None
    """The file's frame in which the scene begins; or it is chosen."""
    shift: tuple[float, float] | None = None
    """Added to x and y after the turn, metres; or the middle of the crowd is set before the camera."""
    turn_deg: float | None = None
    """By how much the file's ground is turned about its origin, from x towards y, degrees; or it is chosen."""
    bodies: Annotated[tuple[BodyName, ...], Field(min_length=1)] = tuple(body_names())
    """Who they are, in turn."""
    sha256: str = ""
    """Digest of the file's content, filled in when the scene or family is loaded; one that is given must be the
    file's."""
    folder: str = Field(default=".", exclude=True)
    """That of the scene's or family's file, filled in when that is loaded. No part of what a data set keeps: it says
    nothing about the people."""

    @model_validator(mode="after")
    def _some(self) -> "RecordedCrowd":
        if self.people[0] > self.people[1]:
            raise ValueError(f"expected 'people' to be [at least, at most], got {list(self.people)}")
        return self


def crowd_in(folder: Path, crowd: RecordedCrowd) -> RecordedCrowd:
    """The crowd whose file lies in the folder or below, with that folder and the digest of the file's content."""
    found = crowd.model_copy(update={"folder": str(folder)})
    return found.model_copy(update={"sha256": _path_and_digest(found)[1]})


def crowd_tracks(crowd: RecordedCrowd) -> Tracks:
    """Everybody in the crowd's file; an `InputError` where it is not the one that the crowd was loaded with."""
    return _tracks(*_path_and_digest(crowd), fps=crowd.fps, metres=METRES[crowd.unit])


def _path_and_digest(crowd: RecordedCrowd) -> tuple[Path, str]:
    path = file_inside(Path(crowd.folder), crowd.file)
    return path, digest_of_file(path, kind="text file of trajectories", wanted=crowd.sha256)


@lru_cache(maxsize=2)
def _tracks(path: Path, digest: str, *, fps: float, metres: float) -> Tracks:
    """Everybody in the file, read once in a process while its content has the digest."""
    del digest  # Only a part of what the answer is remembered by.
    return tracks_of(path, fps=fps, metres=metres)


def recorded_walks(
    crowd: RecordedCrowd, tracks: Tracks, around: Surroundings, *, generator: np.random.Generator | None = None
) -> Walks:
    """Who walks where on the scene's ground, every `tracks.STEP_S` from 0 to `RUN_OUT_S` after the end, metres.

    Windows of time are tried one after the other, or in the generator's order, until one has as many people as wanted.
    Of the turns of the ground that suit it, the one with most to see is taken, or one that the generator draws.
    `casting.cast_of` says who takes part. Whose record begins or ends meanwhile walks straight on.
    Where no window suits, an `InputError`.
    """
    fullest = 0
    for begin_s in _begins(crowd, tracks, around.seconds, generator):
        suited = []
        for walks, seen_s in _casts(crowd, tracks, around, begin_s):
            fullest = max(fullest, len(walks))
            if len(walks) >= crowd.people[0]:
                suited.append((walks, seen_s))
        if suited and generator is not None:
            return suited[generator.integers(len(suited))][0]
        if suited:
            return max(suited, key=lambda cast: cast[1])[0]
    raise InputError(
        f"{tracks.source}: expected {around.seconds:.3g} s with at least {crowd.people[0]} people in view who keep "
        f"{around.people_m:g} m from one another and {around.obstacles_m:g} m from obstacles, at {FASTEST_WALK} m/s "
        f"at most, got {fullest}: ask for fewer people, less clearance or another time, or check fps and unit"
    )


def recorded_people(crowd: RecordedCrowd, around: Surroundings) -> list[dict[str, Any]]:
    """The crowd as the people of a scene's document; nothing is left to chance."""
    people = []
    for number, walk in enumerate(recorded_walks(crowd, crowd_tracks(crowd), around)):
        waypoints, times = walk_record(walk, step_s=STEP_S)
        body, phase = crowd.bodies[number % len(crowd.bodies)], round(number * _NEXT_PHASE % 1, 3)
        people.append({"body": body, "waypoints": waypoints, "times": times, "phase": phase})
    return people


def _begins(crowd: RecordedCrowd, tracks: Tracks, seconds: float, generator: np.random.Generator | None) -> list[float]:
    """When windows begin, seconds after the file's first frame, in the order in which they are tried."""
    if crowd.first_frame is not None:
        frame = beginning(tracks.source, (tracks.first_frame, tracks.last_frame), crowd.first_frame)
        return [(frame - tracks.first_frame) / tracks.fps]
    begins = np.arange(0.0, max(tracks.seconds - seconds, 0.0) + 1e-9, _WINDOW_S)
    return begins.tolist() if generator is None else generator.permutation(begins).tolist()


def _casts(crowd: RecordedCrowd, tracks: Tracks, around: Surroundings, begin_s: float) -> list[tuple[Walks, float]]:
    """For each turn of the ground, the walks of who takes part in the window, and how long they are in view."""
    looked_at = int(np.ceil(around.seconds / STEP_S - 1e-9)) + 1
    times = begin_s + STEP_S * np.arange(looked_at + np.ceil(RUN_OUT_S / STEP_S - 1e-9))
    there = [track for track in tracks.tracks if track.recorded(times[:looked_at]).any()]
    if not there:
        return []
    recorded = np.stack([track.recorded(times[:looked_at]) for track in there])
    on_file = np.stack([track.at(times) for track in there])
    middle = on_file[:, :looked_at][recorded].mean(axis=0)
    casts = []
    for turn_deg in _TURNS_DEG if crowd.turn_deg is None else (crowd.turn_deg,):
        shift = crowd.shift or _before(around.camera) - turned(middle, turn_deg)
        walks = turned(on_file, turn_deg) + np.array(shift)
        cast = cast_of(walks[:, :looked_at], recorded, around, most=crowd.people[1])
        casts.append((walks[list(cast.people)], cast.seen_s))
    return casts


def _before(camera: Camera) -> Float[np.ndarray, "2"]:
    """The place on the ground below what the camera looks at, a metre high, metres; not too far before it."""
    ahead = camera.world_from_camera[:3, 2]
    across, above = float(np.linalg.norm(ahead[:2])), float(camera.position[2]) - 1.0
    reach = above * across / -ahead[2] if ahead[2] < 0 < above else _FARTHEST_M
    return camera.position[:2] + ahead[:2] / max(across, 1e-9) * min(reach, _FARTHEST_M)
