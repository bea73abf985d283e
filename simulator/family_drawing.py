"""Random walks and obstacles: some as it happens, some made for the wanted holes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from recording.errors import InputError
from simulator.family_setting import Setting
from simulator.foresight import outline
from simulator.silhouette import silhouettes
from simulator.things import Obstacle
from simulator.tracks import STEP_S

_DIGITS = 3
_HALF_BODY_M = 0.22
"""Of somebody's width, about."""
_STILL_HIDDEN = 0.65
"""Who is hidden by 80 % has this share of the width behind the cover, about."""
_WALL_M = 0.12
_BEYOND_M = 0.3
"""Walks may leave the strip of ground by so much."""
_IN_VIEW_S = 2.0
_FROM_CAMERA_M = 1.5
_ROUNDS = 60
_BETWEEN = (0.35, 0.9)
"""Where obstacles stand, as shares of the way from the camera to whom they hide."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Walks:
    """Where several people walk, each with a body; the ground's origin is the middle of where people walk."""

    place: Float[np.ndarray, "walk time 2"]
    """At each of the setting's moments, metres."""
    body: Int[np.ndarray, "walk"]
    """Number in `silhouettes().bodies`."""
    phase: Float[np.ndarray, "walk"]
    """Of the gait in the first frame, cycles."""

    def __len__(self) -> int:
        return len(self.body)

    def __getitem__(self, chosen: Any) -> "Walks":
        """Some of the walks."""
        return Walks(place=self.place[chosen], body=self.body[chosen], phase=self.phase[chosen])

    def at(
        self, moments: Float[np.ndarray, "time"], times: Float[np.ndarray, "frame"]
    ) -> Float[np.ndarray, "walk frame 2"]:
        """The places at other times than those `moments`, evenly spaced, at which they are known."""
        place = (times - moments[0]) / (moments[1] - moments[0])
        before = np.clip(place.astype(np.intp), 0, len(moments) - 2)
        share = (place - before)[:, None]
        return (1 - share) * self.place[:, before] + share * self.place[:, before + 1]


def random_walks(setting: Setting, count: int, generator: np.random.Generator) -> Walks:
    """Walks that cross the picture, as many as asked for: each is at a random place of it at some random moment."""
    found: list[Walks] = []
    for _ in range(_ROUNDS):
        drawn = _drawn_walks(setting, 3 * count, generator)
        found.append(drawn[crossing(setting, drawn)])
        if sum(map(len, found)) >= count:
            return joined(found)[np.arange(count)]
    raise InputError(
        f"family {setting.family.name!r}: expected walks that cross the picture between {setting.nearest_m:.1f} and "
        f"{setting.farthest_m:.1f} m from the camera, got none: lower 'people.slant_deg', or raise 'people.depth_m'"
    )


def crossing(setting: Setting, walks: Walks) -> Bool[np.ndarray, "walk"]:
    """Which walks are long enough in the picture, and never near the camera."""
    away = walks.place - setting.eye
    during = (setting.moments >= 0) & (setting.moments <= setting.seconds)
    depth, aside = away[..., 1], np.abs(away[..., 0])
    shown = during & (aside < setting.half_view * depth)
    on_ground = (depth > setting.nearest_m - _BEYOND_M) & (depth < setting.farthest_m + _BEYOND_M)
    enough = shown.sum(axis=1) >= min(0.45, _IN_VIEW_S / max(setting.seconds, 1e-9)) * during.sum()
    beside = aside > setting.half_view * depth + 1.0
    return enough & (on_ground | beside).all(axis=1) & (np.linalg.norm(away, axis=-1) > _FROM_CAMERA_M).all(axis=1)


def shadowing_walks(
    setting: Setting, walks: Walks, frames: Float[np.ndarray, "walk"], generator: np.random.Generator
) -> Walks:
    """For each walk another one, behind or before it, so that one hides the other for about so many frames.

    While A walks at the distance d, B walks at s d in nearly the same direction from the camera, and drifts from one
    side of A to the other. Seen from B's distance A is s times as wide, so the drift is s w - 0.65 w on each side.
    Some have no such partner at a speed that people walk at: they are left out.
    """
    count, half_s = len(walks), frames / setting.family.fps / 2
    middle_s = generator.uniform(0.1, 0.9, count) * setting.seconds
    ends = np.stack([middle_s - half_s, middle_s + half_s], axis=1)
    first, velocity = walks.place[:, 0], _velocity(setting, walks)
    places = first[:, None] + (ends - setting.moments[0])[..., None] * velocity[:, None] - setting.eye
    scale = generator.uniform(1.3, 2.2, count)
    before = generator.random(count) < 0.5
    drift = np.where(before, 1 / scale, 1.0) * (scale - _STILL_HIDDEN) * _HALF_BODY_M
    drift *= generator.choice([-1.0, 1.0], count)
    places *= np.where(before, 1 / scale, scale)[:, None, None]
    places[:, :, 0] += drift[:, None] * np.array([-1.0, 1.0])
    velocity = (places[:, 1] - places[:, 0]) / (2 * half_s[:, None])
    pace, (slow, fast) = np.linalg.norm(velocity, axis=1), setting.family.people.speed
    shadows = _straight(setting, places[:, 0] - ends[:, :1] * velocity + setting.eye, velocity, generator)
    return shadows[crossing(setting, shadows) & (pace >= 0.9 * slow) & (pace <= 1.05 * fast)]


def joined(walks: list[Walks]) -> Walks:
    """All of them, in their order."""
    return Walks(
        place=np.concatenate([each.place for each in walks]),
        body=np.concatenate([each.body for each in walks]),
        phase=np.concatenate([each.phase for each in walks]),
    )


def drawn_obstacle(
    setting: Setting, kind: str, walk: Walks, frames: float | None, generator: np.random.Generator
) -> Obstacle | None:
    """An obstacle between the camera and a walk (one of them), as wide as a hole of so many frames wants, or any.

    In t seconds the view of somebody who walks across it at v metres a second sweeps v t; for that long a cover hides
    at the walker's distance if it is v t + 2 * 0.65 w wide there, and the nearer to the camera the narrower. None where
    the kind has no such width.
    """
    sizes = setting.range_of(kind)
    during = np.flatnonzero((setting.moments >= 0.1 * setting.seconds) & (setting.moments <= 0.9 * setting.seconds))
    moment = int(generator.choice(during))
    away = walk.place[0, moment] - setting.eye
    distance = float(np.linalg.norm(away))
    ahead = (walk.place[0, moment + 1] - walk.place[0, moment]) / STEP_S
    across = abs(float(ahead @ np.array([away[1], -away[0]]))) / distance
    low, high = _BETWEEN
    if frames is None:
        share, width = generator.uniform(low, high), generator.uniform(*sizes.width_m)
    else:
        wanted = across * frames / setting.family.fps + 2 * _STILL_HIDDEN * _HALF_BODY_M
        wanted *= {"cones": 2.0, "pillars": 0.85}.get(kind, 1.0)
        low, high = max(low, sizes.width_m[0] / wanted), min(high, sizes.width_m[1] / wanted)
        if low > high:
            return None
        share = high - (high - low) * generator.uniform() ** 2  # Rather among the people than before the camera.
        width = wanted * share
    place = setting.eye + share * away
    if share * distance < 1.2 or width > 0.7 * setting.half_view * share * distance:
        return None
    return _standing(kind, float(width), float(generator.uniform(*sizes.height_m)), place, generator)


def discs_of(obstacle: Obstacle) -> Float[np.ndarray, "disc 3"]:
    """Discs (x, y, radius) that cover the obstacle's outline: a long box is a row of them; metres."""
    if obstacle.size is None:
        return np.array([[*obstacle.position[:2], obstacle.radius or 0.0]])
    long, thick = obstacle.size[:2]
    count = max(1, int(np.ceil(long / max(thick, 0.2))))
    yaw = np.radians(obstacle.yaw_deg)
    along = (np.arange(count) + 0.5) / count * long - long / 2
    centres = np.array(obstacle.position[:2]) + along[:, None] * np.array([np.cos(yaw), np.sin(yaw)])
    return np.column_stack([centres, np.full(count, np.hypot(long / count, thick) / 2)])


def keep_clear(setting: Setting, walks: Walks, obstacle: Obstacle, *, margin_m: float) -> Bool[np.ndarray, "walk"]:
    """Which walks pass the obstacle at a distance."""
    discs = discs_of(obstacle)
    to_discs = np.linalg.norm(walks.place[:, :, None] - discs[:, :2], axis=-1) - discs[:, 2]
    return to_discs.min(axis=(1, 2)) >= setting.family.people.obstacle_clearance_m + margin_m


def bearings(setting: Setting, obstacle: Obstacle) -> tuple[float, float]:
    """From where to where it stands in the picture: tangents of the angle to the right of the view."""
    away = outline(obstacle) - setting.eye
    tangents = away[:, 0] / np.maximum(away[:, 1], 0.1)
    return float(tangents.min()), float(tangents.max())


def _drawn_walks(setting: Setting, count: int, generator: np.random.Generator) -> Walks:
    near, far = setting.nearest_m, setting.farthest_m
    depth = np.sqrt(generator.uniform(near**2, far**2, count))  # The ground that the picture shows widens with depth.
    aside = generator.uniform(-0.9, 0.9, count) * setting.half_view * depth
    moment = generator.uniform(0.0, 1.0, count) * setting.seconds
    slant = np.radians(setting.family.people.slant_deg) * generator.uniform(-1.0, 1.0, count)
    pace = generator.uniform(*setting.family.people.speed, count) * generator.choice([-1.0, 1.0], count)
    velocity = pace[:, None] * np.stack([np.cos(slant), np.sin(slant)], axis=1)
    place = np.stack([aside, depth], axis=1) + setting.eye - moment[:, None] * velocity
    return _straight(setting, place, velocity, generator)


def _velocity(setting: Setting, walks: Walks) -> Float[np.ndarray, "walk 2"]:
    """The mean velocity, metres a second."""
    return (walks.place[:, -1] - walks.place[:, 0]) / float(np.ptp(setting.moments))


def _straight(
    setting: Setting,
    place: Float[np.ndarray, "walk 2"],
    velocity: Float[np.ndarray, "walk 2"],
    generator: np.random.Generator,
) -> Walks:
    """Straight walks at an even pace that are at a place in the first frame, with random bodies."""
    numbers = np.array([silhouettes().bodies.index(name) for name in setting.family.people.bodies])
    return Walks(
        place=place[:, None] + setting.moments[:, None] * velocity[:, None],
        body=generator.choice(numbers, len(place)),
        phase=np.round(generator.uniform(0.0, 1.0, len(place)), _DIGITS),
    )


def _standing(
    kind: str, width: float, height: float, place: Float[np.ndarray, "2"], generator: np.random.Generator
) -> Obstacle:
    """The obstacle of that width at the place: a wall looks at the camera, nearly, and a pillar anywhere."""
    x, y = (round(float(metres), _DIGITS) for metres in place)
    wide, high = round(width, _DIGITS), round(height, _DIGITS)
    if kind in ("trees", "cones"):
        shape = "cylinder" if kind == "trees" else "cone"
        return Obstacle.model_validate(
            {"shape": shape, "radius": round(wide / 2, _DIGITS), "height": high, "position": (x, y, 0.0)}
        )
    wall = kind == "walls"
    yaw = generator.uniform(-12.0, 12.0) if wall else generator.uniform(-45.0, 45.0)
    size = (wide, _WALL_M if wall else wide, high)
    return Obstacle(shape="box", size=size, position=(x, y, 0.0), yaw_deg=round(float(yaw), 1))
