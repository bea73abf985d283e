"""Who of many recorded people can take part in a scene: in view, apart from one another, walking."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from recording.camera import Camera
from recording.crowd import HEADROOM_M
from simulator.clearance import smallest_clearance
from simulator.path import FASTEST_WALK
from simulator.things import Obstacle
from simulator.tracks import STEP_S

SLACK_M = 0.02
"""Added to the clearances asked: the path through way-points is a little off the track."""
_CHEST_M = 1.2  # The height that has to be in the picture.
_SEEN_M = 15.0  # Who is farther from the camera is too small to be looked for.
_BEFORE_LENS_M = 1.0  # Nobody comes so near to a camera that hangs lower than people are high.

Walks = Float[np.ndarray, "person time 2"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Surroundings:
    """What a crowd is to suit."""

    camera: Camera
    seconds: float
    """How long the crowd is looked at."""
    obstacles: tuple[Obstacle, ...] = ()
    people_m: float = 0.6
    """Nobody comes nearer to another's centre."""
    obstacles_m: float = 0.3
    """Nobody's centre comes nearer to an obstacle."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cast:
    """Who takes part."""

    people: tuple[int, ...]
    """Their numbers, growing."""
    seen_s: float
    """How long they are in view, all together."""


def cast_of(walks: Walks, recorded: Bool[np.ndarray, "person time"], around: Surroundings, *, most: int) -> Cast:
    """As many of the people as can take part, up to `most`, in the order of how long they are in view.

    `recorded` marks where a walk is more than a guess; only there somebody is looked for. Whoever is never in view is
    left out, and who walks too fast, too near to an obstacle or the camera, or too near to somebody who takes part.
    """
    seen = (_in_view(around.camera, walks) & recorded).sum(axis=-1)
    people: list[int] = []
    for person in np.argsort(-seen, kind="stable").tolist():
        if len(people) == most or not seen[person]:
            break
        if _walkable(walks[person], around) and _nearest_m(walks[person], walks[people]) >= around.people_m + SLACK_M:
            people.append(person)
    return Cast(people=tuple(sorted(people)), seen_s=STEP_S * float(seen[people].sum()))


def _in_view(camera: Camera, walks: Walks) -> Bool[np.ndarray, "person time"]:
    """Mark whose chest is in the picture."""
    chest = np.concatenate([walks, np.full((*walks.shape[:2], 1), _CHEST_M)], axis=-1)
    column_row, depth = camera.pixel_from_world(chest)
    return camera.contains(column_row) & (depth < _SEEN_M)


def _walkable(walk: Float[np.ndarray, "time 2"], around: Surroundings) -> bool:
    """Whether somebody can walk so, clear of obstacles and of the camera."""
    paces = np.linalg.norm(np.diff(walk, axis=0), axis=-1) / STEP_S
    aside = np.linalg.norm(walk - around.camera.position[:2], axis=-1)
    hit = around.camera.position[2] < HEADROOM_M and aside.min() < _BEFORE_LENS_M
    beside_m = smallest_clearance([walk], around.obstacles).obstacles_m
    return bool(paces.max() < FASTEST_WALK and not hit and beside_m >= around.obstacles_m + SLACK_M)


def _nearest_m(walk: Float[np.ndarray, "time 2"], others: Walks) -> float:
    """The smallest distance to any of the others, between the moments too; infinite where there are none."""
    apart = others - walk
    begin, change = apart[:, :-1], np.diff(apart, axis=1)
    share = np.clip(-(begin * change).sum(axis=-1) / np.maximum((change**2).sum(axis=-1), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(begin + share[..., None] * change, axis=-1).min(initial=np.inf))
