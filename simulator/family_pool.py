"""A pool of walks and obstacles to choose a crowd from: what each covers of each other, and which bar one another.

What one walk covers of another is known for all pairs, so that a crowd is foretold by the bitwise or of what its
members cover.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, UInt64

from simulator.family_drawing import Walks, bearings, drawn_obstacle, joined, keep_clear, random_walks, shadowing_walks
from simulator.family_setting import Setting
from simulator.foresight import Sights, cells_behind_obstacle, cells_behind_people, cells_in_picture, sights
from simulator.occlusion import OcclusionWish
from simulator.things import Obstacle
from simulator.tracks import STEP_S

_WALKS = 128
_PARENTS = 32
"""So many walks have shadows, where they are wanted."""
_OBSTACLES = 24  # Of each kind; some fit nowhere.
_EVASION = 1.1
"""Straight walks are no nearer than so many times the clearance: what is missing, people evade by."""
_BESIDE_M = 0.12
"""Straight walks pass obstacles so much farther away than they must, so that they stay straight."""
_MARGIN_M = 0.03
"""What a path through way-points may be off the walk, and a little."""
_APART_M = 0.3
"""Two obstacles leave a gap as wide to look through, at the far end of the ground."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Passing:
    """Walks to choose from, and what they cover of one another."""

    walks: Walks
    inside: UInt64[np.ndarray, "walk frame"]
    """Cells in the picture."""
    by_walk: UInt64[np.ndarray, "walk walk frame"]
    """Cells of the first walk that the second covers."""
    walks_fit: Bool[np.ndarray, "walk walk"]
    """Which two may be in one crowd."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Pool(Passing):
    """What there is to choose from, and what covers and what bars what."""

    setting: Setting
    obstacles: tuple[Obstacle, ...]
    kinds: tuple[str, ...]
    """Of each obstacle."""
    by_obstacle: UInt64[np.ndarray, "walk obstacle frame"]
    """Cells of the walk that the obstacle covers."""
    obstacle_fits: Bool[np.ndarray, "walk obstacle"]
    """Which walk may pass which obstacle."""
    obstacles_fit: Bool[np.ndarray, "obstacle obstacle"]
    """Which two may stand in one scene."""


def drawn_pool(setting: Setting, wish: OcclusionWish | None, generator: np.random.Generator) -> Pool:
    """Random walks, and, where holes are wanted, shadows of them and obstacles as wide as these want them.

    All are straight, and may be a little nearer to one another than people are to be: these evade one another.
    """
    walks = random_walks(setting, _WALKS, generator)
    if wish is not None and wish.by != "obstacles" and setting.people > 1:
        parents = walks[generator.integers(0, _PARENTS, 3 * _WALKS)]
        shadows = shadowing_walks(setting, parents, _lengths(wish, len(parents), generator), generator)
        walks = joined([walks[:_PARENTS], shadows, walks[_PARENTS:]])[:_WALKS]
    seen = _sights(setting, walks)
    passing = Passing(
        walks=walks,
        inside=cells_in_picture(setting.camera, seen),
        by_walk=cells_behind_people(setting.camera, seen[:, None], seen[None]),
        walks_fit=_apart(setting, walks) >= _EVASION * setting.family.people.clearance_m,
    )
    return _pool(setting, passing, _drawn_obstacles(setting, walks, wish, generator), margin_m=_BESIDE_M)


def mending_pool(
    pool: Pool, walked: Walks, stood: tuple[int, ...], wish: OcclusionWish, generator: np.random.Generator
) -> Pool:
    """The pool of a crowd that has evaded: its walks as they have become come first, then all of the pool.

    Nobody evades any more, so only those fit together who keep clear as they are. The obstacles that `stood` in its
    way come first as well, then others made for its walks.
    """
    setting, own = pool.setting, len(walked)
    walks, camera = joined([walked, pool.walks]), setting.camera
    seen = _sights(setting, walks)
    by_walk = np.empty((len(walks), len(walks), setting.frames), np.uint64)
    by_walk[own:, own:] = pool.by_walk
    by_walk[:own] = cells_behind_people(camera, seen[:own, None], seen[None])
    by_walk[own:, :own] = cells_behind_people(camera, seen[own:, None], seen[None, :own])
    passing = Passing(
        walks=walks,
        inside=np.concatenate([cells_in_picture(camera, seen[:own]), pool.inside]),
        by_walk=by_walk,
        walks_fit=_apart(setting, walks) >= setting.family.people.clearance_m + _MARGIN_M,
    )
    obstacles = [(pool.kinds[number], pool.obstacles[number]) for number in stood]
    obstacles += _drawn_obstacles(setting, walked, wish, generator)
    return _pool(setting, passing, obstacles, margin_m=_MARGIN_M)


def recorded_pool(setting: Setting, walks: Walks, wish: OcclusionWish | None, generator: np.random.Generator) -> Pool:
    """These walks, which all take part as they are, and obstacles made for them."""
    seen = _sights(setting, walks)
    passing = Passing(
        walks=walks,
        inside=cells_in_picture(setting.camera, seen),
        by_walk=cells_behind_people(setting.camera, seen[:, None], seen[None]),
        walks_fit=~np.eye(len(walks), dtype=bool),
    )
    return _pool(setting, passing, _drawn_obstacles(setting, walks, wish, generator), margin_m=_MARGIN_M)


def _pool(setting: Setting, passing: Passing, obstacles: list[tuple[str, Obstacle]], *, margin_m: float) -> Pool:
    """The pool of these walks and of these obstacles with their kinds."""
    walks, standing = passing.walks, tuple(one for _, one in obstacles)
    seen = _sights(setting, walks)
    by_obstacle = np.zeros((len(walks), len(standing), setting.frames), np.uint64)
    fits = np.zeros((len(walks), len(standing)), bool)
    for number, one in enumerate(standing):
        by_obstacle[:, number] = cells_behind_obstacle(setting.camera, seen, one)
        fits[:, number] = keep_clear(setting, walks, one, margin_m=margin_m)
    sides = np.array([bearings(setting, one) for one in standing]).reshape(-1, 2)
    beside = sides[:, None, 0] > sides[None, :, 1] + _APART_M / setting.farthest_m
    return Pool(
        setting=setting,
        walks=walks,
        inside=passing.inside,
        by_walk=passing.by_walk,
        walks_fit=passing.walks_fit,
        obstacles=standing,
        kinds=tuple(kind for kind, _ in obstacles),
        by_obstacle=by_obstacle,
        obstacle_fits=fits,
        obstacles_fit=beside | beside.T,
    )


def _drawn_obstacles(
    setting: Setting, walks: Walks, wish: OcclusionWish | None, generator: np.random.Generator
) -> list[tuple[str, Obstacle]]:
    """Obstacles of every kind that is to stand there, with their kind, each for one of the walks."""
    found = []
    for kind in [kind for kind in dict.fromkeys(setting.kinds) for _ in range(_OBSTACLES)]:
        walk = walks[[int(generator.integers(len(walks)))]]
        frames = None if wish is None or wish.by == "people" else float(_lengths(wish, 1, generator)[0])
        obstacle = drawn_obstacle(setting, kind, walk, frames, generator)
        if obstacle is not None and keep_clear(setting, walk, obstacle, margin_m=_BESIDE_M)[0]:
            found.append((kind, obstacle))
    return found


def _lengths(wish: OcclusionWish, count: int, generator: np.random.Generator) -> Float[np.ndarray, "hole"]:
    """Random lengths of the wanted distribution, frames."""
    return wish.hole_frames * np.exp(wish.spread * generator.standard_normal(count))


def _sights(setting: Setting, walks: Walks) -> Sights:
    """The walks in each frame."""
    places = walks.at(setting.moments, setting.frame_times)
    return sights(setting.camera, places, walks.body, walks.phase, setting.family.fps)


def _apart(setting: Setting, walks: Walks) -> Float[np.ndarray, "walk walk"]:
    """How near every two come from the first frame to the last, metres; 0 to oneself."""
    during = (setting.moments >= -STEP_S) & (setting.moments <= setting.seconds + STEP_S)
    x, y = np.ascontiguousarray(walks.place[:, during].transpose(2, 0, 1))
    squared = (x[:, None] - x[None]) ** 2 + (y[:, None] - y[None]) ** 2
    return np.sqrt(squared.min(axis=-1))
