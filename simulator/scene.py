"""The schema of a scene's TOML file: what happens, seen by which camera.

Lengths are metres, times seconds, speeds metres a second; what is in degrees says so in its name.
`docs/scenes.md` shows a minimal and a full example.
"""

from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from recording.camera import Camera, looking_at
from recording.checks import Frozen, nearest_name, toml_document, validated
from recording.errors import InputError
from recording.metadata import Side
from simulator.carrying import check_hands
from simulator.casting import Surroundings
from simulator.juggling_scene import Juggler
from simulator.motion_file import with_motion_files
from simulator.occlusion import OcclusionWish
from simulator.recorded_crowd import RecordedCrowd, crowd_in, recorded_people
from simulator.sensor import Ideal, Sensor
from simulator.things import Ball, Obstacle, Person, Point, Positive
from simulator.trajectory_file import with_recorded_walks

NotNegative = Annotated[float, Field(ge=0)]
FrameCount = Annotated[int, Field(gt=0, le=100_000)]
"""Who needs more wants several scenes: everybody's mesh in every frame is in memory."""


class CameraSpot(Frozen):
    """The virtual scanner: a pinhole with square pixels, upright, its principal point in the middle."""

    width: Side = 320
    """Picture width, pixels."""
    height: Side = 240
    """Picture height, pixels."""
    position: Point
    """Where it stands, metres."""
    look_at: Point
    """The point in the middle of its picture, metres."""
    horizontal_fov_deg: Annotated[float, Field(ge=1, le=179)] = 60.0
    """Angle between the picture's left and right edges, degrees."""

    @model_validator(mode="after")
    def _looks_somewhere(self) -> "CameraSpot":
        if self.position == self.look_at:
            raise ValueError("expected 'look_at' to be another point than 'position'")
        return self

    def as_camera(self) -> Camera:
        """The camera to compute with."""
        focal = self.width / 2 / np.tan(np.radians(self.horizontal_fov_deg) / 2)
        return Camera(
            width=self.width,
            height=self.height,
            fx=float(focal),
            fy=float(focal),
            cx=self.width / 2,
            cy=self.height / 2,
            world_from_camera=looking_at(self.position, self.look_at),
        )


class Vary(Frozen):
    """What another seed may change in people's walks: the same scene on another day."""

    sideways_m: NotNegative = 0.3
    """Each path is shifted across its direction by up to so much, either way, metres."""
    speed_share: Annotated[float, Field(ge=0, lt=1)] = 0.15
    """Each walk is faster or slower by up to this share."""
    start_s: NotNegative = 0.3
    """Each walk starts sooner or later by up to so much, seconds."""
    phase: bool = True
    """Whether the first frame finds each walker anywhere in the gait's cycle."""
    bodies: bool = True
    """Whether anybody may be anyone."""
    clearance_m: NotNegative = 0.6
    """Nobody comes nearer to another's centre, metres."""
    obstacle_clearance_m: NotNegative = 0.3
    """Nobody's centre comes nearer to an obstacle, metres."""
    together: bool = Field(default=False, exclude_if=lambda together: not together)
    """Whether all people change alike: one shift across the first one's path, share, delay, phase and body for all."""


class PaperSettings(Frozen):
    """The thresholds that Table 1 of the paper states for the scene, in the paper's units."""

    eps1: float
    eps2: float
    eps3: float
    eps4: float
    eps5: float


class Scene(Frozen):
    """A scene, as its TOML file says it."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]
    """Letters, digits, `_`, `-`, `.`: the recording's folder is called so."""
    description: str = ""
    """One sentence for the reader."""
    frames: FrameCount
    """How many pictures are taken."""
    fps: Positive
    """Pictures a second."""
    camera: CameraSpot
    people: tuple[Person, ...] = ()
    jugglers: tuple[Juggler, ...] = ()
    balls: tuple[Ball, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    vary: Vary = Vary()
    sensor: Sensor = Ideal()
    paper: PaperSettings | None = None
    stress_test: bool = False
    """Whether people may come nearer to one another and to obstacles than `vary` says, as bodies never do."""
    occlusion: OcclusionWish | None = Field(default=None, exclude_if=lambda wish: wish is None)
    """What a random family wanted of the scene's holes; others are written as if there were no such key."""

    @model_validator(mode="after")
    def _something_named_once(self) -> "Scene":
        things: tuple[Person | Juggler | Ball | Obstacle, ...]
        things = (*self.people, *self.jugglers, *self.balls, *self.obstacles)
        if not things:
            raise ValueError("expected at least one of 'people', 'jugglers', 'balls' and 'obstacles'")
        names = [thing.name for thing in things if thing.name is not None]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"expected every name once, but two are called {twice!r}")
        check_hands(self.people, self.balls)
        return self


class _Around(Frozen):
    """What of a scene its crowd has to suit, as in `Scene`."""

    frames: FrameCount
    fps: Positive
    camera: CameraSpot
    obstacles: tuple[Obstacle, ...] = ()
    vary: Vary = Vary()


def scene_names() -> list[str]:
    """The scenes that come with the program."""
    return sorted(entry.name.removesuffix(".toml") for entry in files("scenes").iterdir() if entry.name[-5:] == ".toml")


def load_scene(name_or_path: str | Path) -> Scene:
    """The scene of that name among those that come with the program, or in that TOML file."""
    text = str(name_or_path)
    if text in scene_names():
        place = Path(str(files("scenes") / f"{text}.toml"))
    elif text.endswith(".toml") or isinstance(name_or_path, Path):
        place = Path(text)
    else:
        raise InputError(f"unknown scene {text!r}: {nearest_name(text, scene_names())} (or the path of a .toml file)")
    document = with_motion_files(with_recorded_walks(toml_document(place), place=place), place=place)
    document = _with_crowd(document, place)
    return validated(Scene, document, source=str(place))


def _with_crowd(document: dict[str, Any], place: Path) -> dict[str, Any]:
    """The scene's document with people in place of its recorded `crowd`, if it has one: it stands for itself."""
    if "crowd" not in document:
        return document
    if "people" in document:
        raise InputError(f"{place}: crowd: expected it in place of 'people', got both: keep one")
    given = {key: document[key] for key in _Around.model_fields if key in document}
    stage = validated(_Around, given, source=str(place))
    around = Surroundings(
        camera=stage.camera.as_camera(),
        seconds=(stage.frames - 1) / stage.fps,
        obstacles=stage.obstacles,
        people_m=stage.vary.clearance_m,
        obstacles_m=stage.vary.obstacle_clearance_m,
    )
    crowd = validated(RecordedCrowd, document["crowd"], source=f"{place}: crowd")
    rest = {key: value for key, value in document.items() if key != "crowd"}
    return rest | {"people": recorded_people(crowd_in(place.parent, crowd), around)}
