"""What of a random scene is settled before anybody walks: camera, ground, numbers, lengths; and whether it can be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from recording.camera import Camera
from recording.errors import InputError
from simulator.family import Family, ObstacleRange
from simulator.scene import CameraSpot
from simulator.sensor import Sensor
from simulator.tracks import STEP_S

CLOSEST_M = 1.8
"""Nobody walks nearer to the camera."""
BEFORE_S = 0.4
"""Walks begin so long before the first frame."""
AFTER_S = 1.6
"""And end so long after the last: who stops does so beyond the recording."""
_AIM_M = 1.0  # The height that the camera looks at.
_DIGITS = 3
_DENSEST = 2 / np.sqrt(3)
"""Discs of diameter 1 in a unit of area, in the densest packing (Thue 1890)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Setting:
    """A random scene without its people and obstacles."""

    family: Family
    frames: int
    spot: CameraSpot
    sensor: Sensor
    people: int
    nearest_m: float
    """Where the ground that people cross begins, from the camera on."""
    farthest_m: float
    """And where it ends."""
    kinds: tuple[str, ...]
    """Which obstacles are to stand there, by kind, one after the other."""

    @cached_property
    def camera(self) -> Camera:
        """The camera to compute with."""
        return self.spot.as_camera()

    @property
    def eye(self) -> np.ndarray:
        """Where the camera stands on the ground."""
        return np.array(self.spot.position[:2])

    @property
    def half_view(self) -> float:
        """Tangent of half the angle between the picture's left and right edges."""
        return float(np.tan(np.radians(self.spot.horizontal_fov_deg / 2)))

    @property
    def seconds(self) -> float:
        """From the first frame to the last."""
        return (self.frames - 1) / self.family.fps

    @cached_property
    def moments(self) -> Float[np.ndarray, "time"]:
        """The moments of walks, from before the first frame to after the last, seconds after the first."""
        return np.arange(-BEFORE_S, self.seconds + AFTER_S + STEP_S, STEP_S)

    @property
    def frame_times(self) -> Float[np.ndarray, "frame"]:
        """When each picture is taken, seconds after the first."""
        return np.arange(self.frames) / self.family.fps

    def range_of(self, kind: str) -> ObstacleRange:
        """The sizes of a kind of obstacle."""
        return self.family.obstacles.kinds[kind]


def drawn_setting(family: Family, generator: np.random.Generator) -> Setting:
    """The setting of one scene; an InputError in one line where arithmetic shows that there is none."""
    camera, people = family.camera, family.people
    frames = int(generator.integers(family.frames[0], family.frames[1], endpoint=True))
    count = int(generator.integers(people.count[0], people.count[1], endpoint=True))
    distance, eye_m, fov = (
        _drawn(span, generator) for span in (camera.distance_m, camera.eye_m, camera.horizontal_fov_deg)
    )
    breadth = 2 * distance * float(np.tan(np.radians(fov / 2)))
    depth = _drawn(people.depth_m, generator)
    if people.density is not None:
        depth = count / _drawn(people.density, generator) / breadth
    setting = Setting(
        family=family,
        frames=frames,
        spot=CameraSpot(
            width=camera.width,
            height=camera.height,
            position=(0.0, -distance, eye_m),
            look_at=(0.0, 0.0, _AIM_M),
            horizontal_fov_deg=fov,
        ),
        sensor=family.sensor[int(generator.integers(len(family.sensor)))],
        people=count,
        nearest_m=distance - depth / 2,
        farthest_m=distance + depth / 2,
        kinds=_drawn_kinds(family, generator),
    )
    if family.crowd is None:
        _check_room(setting, breadth * depth)
    _check_wish(setting)
    return setting


def _drawn_kinds(family: Family, generator: np.random.Generator) -> tuple[str, ...]:
    """Which obstacles stand there; one at least where there may be some and not only people are to hide."""
    kinds = family.obstacles.kinds
    drawn = [
        kind
        for kind, sizes in kinds.items()
        for _ in range(int(generator.integers(sizes.count[0], sizes.count[1], endpoint=True)))
    ]
    if kinds and not drawn and family.occlusion is not None and family.occlusion.by != "people":
        drawn = [str(generator.choice(list(kinds)))]
    return tuple(drawn)


def _drawn(span: tuple[float, float], generator: np.random.Generator) -> float:
    """A number of the range, all equally likely."""
    return round(float(generator.uniform(*span)), _DIGITS)


def _check_room(setting: Setting, area: float) -> None:
    """Raise where the ground is too small for its people, or too near."""
    family, clearance = setting.family, setting.family.people.clearance_m
    if setting.people * clearance**2 > _DENSEST * area:
        raise InputError(
            f"family {family.name!r}: expected room for {setting.people} people who keep {clearance:g} m apart, got "
            f"{area:.3g} square metres, which hold {int(_DENSEST * area / clearance**2)} at the very most: "
            "lower 'people.count', 'people.density' or 'people.clearance_m', or raise 'people.depth_m'"
        )
    if setting.nearest_m < CLOSEST_M:
        raise InputError(
            f"family {family.name!r}: expected people {CLOSEST_M} m from the camera at the least, got a strip that "
            f"begins at {setting.nearest_m:.2f} m: raise 'camera.distance_m', or lower 'people.depth_m'"
        )


def _check_wish(setting: Setting) -> None:
    """Raise where numbers alone show that the wish cannot be met."""
    wish, name = setting.family.occlusion, f"family {setting.family.name!r}"
    if wish is None:
        return
    if wish.hole_frames + 2 > setting.frames:
        raise InputError(
            f"{name}: expected holes that fit, with a frame before and one after, into {setting.frames} frames, got "
            f"'occlusion.hole_frames' = {wish.hole_frames:g}: lower it, or raise 'frames'"
        )
    if wish.by in ("obstacles", "both") and not setting.kinds:
        raise InputError(
            f"{name}: expected obstacles where 'occlusion.by' is {wish.by!r}, got none: raise a count of [obstacles]"
        )
    if setting.people == 1 and (wish.by in ("people", "both") or not setting.kinds):
        raise InputError(f"{name}: expected somebody else who hides, got one person alone: raise 'people.count'")
    if wish.hidden_share is not None:
        _check_share(setting, wish.hole_frames, wish.hidden_share)


def _check_share(setting: Setting, hole_frames: float, share: float) -> None:
    """Raise where one hole is already more than the hidden share, or the longest one for everybody less."""
    name, wish = f"family {setting.family.name!r}", setting.family.occlusion
    least = 0.75 * hole_frames / (setting.people * setting.frames)
    if share < least:
        raise InputError(
            f"{name}: expected 'occlusion.hidden_share' to be that of one hole of {hole_frames:g} frames at least, "
            f"{least:.3f} of {setting.people} people's {setting.frames} frames, got {share:g}: raise it, or the frames"
        )
    whole = (setting.people - 1) / setting.people if wish is not None and wish.by == "people" else 1.0
    most = whole * hole_frames / (hole_frames + 1)
    if share > most:
        raise InputError(
            f"{name}: expected 'occlusion.hidden_share' up to {most:.2f}, for somebody is seen between two holes of "
            f"{hole_frames:g} frames{' and who is nearest is seen' if whole < 1 else ''}, got {share:g}: lower it"
        )
