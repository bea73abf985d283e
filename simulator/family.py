"""The schema of a family's TOML file: ranges from which random scenes are drawn.

A range is `[lowest, highest]`, or one number that is both. Lengths are metres, times seconds, speeds metres a second;
what is in degrees says so in its name. `docs/families.md` shows an example.
"""

from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from recording.checks import Frozen, nearest_name, toml_document, validated
from recording.errors import InputError
from recording.metadata import Side
from simulator.body import body_names
from simulator.body_name import BodyName
from simulator.occlusion import OcclusionWish
from simulator.path import FASTEST_WALK
from simulator.recorded_crowd import RecordedCrowd, crowd_in
from simulator.sensor import Ideal, Sensor
from simulator.things import Positive

DEVELOPMENT_SEEDS = range(1, 1000)
"""Seeds to develop with."""
REPORTING_SEEDS = range(1000, 2000)
"""Seeds to report on, and never to tune by."""


def _both_ends(value: Any) -> Any:
    return (value, value) if isinstance(value, int | float) else value


def _ascending(value: tuple[Any, Any]) -> tuple[Any, Any]:
    if value[0] > value[1]:
        raise ValueError("expected a range [lowest, highest]")
    return value


def _one_or_several(value: Any) -> Any:
    return value if isinstance(value, list | tuple) else [value]


NotNegative = Annotated[float, Field(ge=0)]
Span = Annotated[tuple[Positive, Positive], BeforeValidator(_both_ends), AfterValidator(_ascending)]
"""A range of lengths, speeds or angles, all above 0."""
Count = Annotated[
    tuple[Annotated[int, Field(ge=0, le=100_000)], Annotated[int, Field(ge=0, le=100_000)]],
    BeforeValidator(_both_ends),
    AfterValidator(_ascending),
]
"""A range of numbers of things."""
Sensors = Annotated[tuple[Sensor, ...], BeforeValidator(_one_or_several), Field(min_length=1)]


class CameraRange(Frozen):
    """Where the camera may stand: before the people, upright, as high as `eye_m`."""

    width: Side = 320
    """Picture width, pixels."""
    height: Side = 240
    """Picture height, pixels."""
    eye_m: Span = (1.5, 1.5)
    """Its height above the ground, metres."""
    distance_m: Span = (5.5, 5.5)
    """From the middle of where people walk, metres."""
    horizontal_fov_deg: Annotated[Span, Field()] = (60.0, 60.0)
    """Angle between the picture's left and right edges, degrees."""


class PeopleRange(Frozen):
    """Who walks, and where."""

    count: Count
    """How many people."""
    bodies: Annotated[tuple[BodyName, ...], Field(min_length=1)] = tuple(body_names())
    """Whose bodies they may have."""
    speed: Span = (0.9, 1.5)
    """How fast they want to walk, metres a second."""
    slant_deg: Annotated[float, Field(ge=0, le=90)] = 50.0
    """Walks lead across the view, or off that by up to so much; at 90 in any direction, degrees."""
    depth_m: Span = (4.0, 4.0)
    """Of the strip of ground that they cross before the camera, metres; or else `density`."""
    density: Span | None = None
    """People a square metre of that strip, as far as the picture shows it; or else `depth_m`."""
    clearance_m: NotNegative = 0.6
    """Nobody comes nearer to another's centre, metres."""
    obstacle_clearance_m: NotNegative = 0.3
    """Nobody's centre comes nearer to an obstacle, metres."""

    @model_validator(mode="after")
    def _walk(self) -> "PeopleRange":
        if self.speed[1] > FASTEST_WALK / 1.3:
            raise ValueError(f"expected a 'speed' up to {FASTEST_WALK / 1.3:.1f}: who evades hurries")
        if self.density is not None and "depth_m" in self.model_fields_set:
            raise ValueError("expected either 'depth_m' or 'density', not both")
        return self


class ObstacleRange(Frozen):
    """One kind of obstacle."""

    count: Count
    """How many there are."""
    width_m: Span
    """A wall's length, a cone's width at its base, the thickness of others, metres."""
    height_m: Span
    """Metres."""


class ObstacleRanges(Frozen):
    """What people walk behind, by kind."""

    walls: ObstacleRange | None = None
    """Thin boxes, nearly at right angles to the view."""
    cones: ObstacleRange | None = None
    """As the paper's house."""
    trees: ObstacleRange | None = None
    """Round trunks."""
    pillars: ObstacleRange | None = None
    """Square ones, turned at random."""

    @property
    def kinds(self) -> dict[str, ObstacleRange]:
        """The kinds that there may be."""
        given = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: kind for name, kind in given.items() if kind is not None and kind.count[1] > 0}


class Family(Frozen):
    """A family of scenes, as its TOML file says it."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]
    """Letters, digits, `_`, `-`, `.`: the scenes are called so, with their seed."""
    description: str = ""
    """One sentence for the reader."""
    frames: Annotated[Count, Field()] = (60, 60)
    """How many pictures are taken."""
    fps: Positive = 15.0
    """Pictures a second."""
    camera: CameraRange = CameraRange()
    people: PeopleRange
    obstacles: ObstacleRanges = ObstacleRanges()
    crowd: RecordedCrowd | None = None
    """Recorded people in place of random ones; of [people], `count`, `bodies` and the clearances go on to hold."""
    sensor: Sensors = (Ideal(),)
    """One, or several of which each scene has one."""
    occlusion: OcclusionWish | None = None
    """The dial; without it people are hidden as it happens."""

    @model_validator(mode="after")
    def _possible(self) -> "Family":
        if self.frames[0] < 1 or self.people.count[0] < 1:
            raise ValueError("expected at least one of 'frames' and one of 'people.count'")
        if self.camera.horizontal_fov_deg[1] > 120:
            raise ValueError("expected 'camera.horizontal_fov_deg' up to 120")
        if self.crowd is not None and {"people", "bodies"} & self.crowd.model_fields_set:
            raise ValueError("expected 'people.count' and 'people.bodies' in place of 'people' and 'bodies' of 'crowd'")
        return self


def family_names() -> list[str]:
    """The families that come with the program."""
    folder = files("scenes") / "families"
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def load_family(name_or_path: str | Path) -> Family:
    """The family of that name among those that come with the program, or in that TOML file.

    A recorded crowd's file is looked for beside the family's, and known by its content from then on.
    """
    text = str(name_or_path)
    if text in family_names():
        place = Path(str(files("scenes") / "families" / f"{text}.toml"))
    elif text.endswith(".toml") or isinstance(name_or_path, Path):
        place = Path(text)
    else:
        raise InputError(f"unknown family {text!r}: {nearest_name(text, family_names())} (or the path of a .toml file)")
    family = validated(Family, toml_document(place), source=str(place))
    if family.crowd is None:
        return family
    return family.model_copy(update={"crowd": crowd_in(place.parent, family.crowd)})
