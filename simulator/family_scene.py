"""A scene drawn from a family: random, but with the occlusion that the family wants."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from recording.errors import InputError
from simulator.clearance import smallest_clearance
from simulator.crowds import Crowds
from simulator.family import Family
from simulator.family_drawing import Walks, discs_of
from simulator.family_pool import Pool, drawn_pool, mending_pool, recorded_pool
from simulator.family_recorded import recorded_setting
from simulator.family_search import Crowd, cover_of, improved, random_crowd
from simulator.family_setting import BEFORE_S, Setting, drawn_setting
from simulator.misfit import Foretold, foretold, misfit
from simulator.scene import Scene, Vary
from simulator.silhouette import silhouettes
from simulator.social_force import social_force_walks
from simulator.stage import walkers_centres
from simulator.things import Obstacle, Person
from simulator.tracks import STEP_S
from simulator.walk_record import walk_record

_ROUNDS = 8
_CROWDS = 12
"""In each round so many random crowds are improved,"""
_MENDED = 3
"""and so many of them improved once more after people have evaded one another."""
_GOOD, _BEARABLE = 1.2, 3.5
"""Misfits: with less than the one the search ends, with more than the other there is no scene."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Found:
    """A crowd with its obstacles, and how far it is from the wish."""

    walks: Walks
    obstacles: tuple[Obstacle, ...]
    misfit: float
    foretold: Foretold


def drawn_scene(family: Family, seed: int) -> Scene:
    """The family's scene of that seed: the same family and seed give the same scene.

    Its `occlusion` is the family's wish, if there is one. InputError, in one line, where the family's ranges leave no
    room for its people, or where no scene was found that meets the wish.
    """
    if seed < 0:
        raise InputError(f"expected a seed of 0 or above, got {seed}")
    generator = np.random.default_rng(seed)
    setting = drawn_setting(family, generator)
    chance = float(generator.uniform(0.1, 0.9))
    best: tuple[_Found, Scene] | None = None
    for _ in range(_ROUNDS):
        for found in _candidates(setting, chance, generator):
            scene = _scene(setting, found, seed)
            if (best is None or found.misfit < best[0].misfit) and _keeps_clear(scene):
                best = found, scene
            if best is not None and best[0].misfit <= _GOOD:
                return best[1]
    if best is None or best[0].misfit > _BEARABLE:
        raise InputError(_refusal(setting, seed, None if best is None else best[0].foretold))
    return best[1]


def _candidates(setting: Setting, chance: float, generator: np.random.Generator) -> Iterator[_Found]:
    """Crowds of one pool, the more promising first; each is made when it is asked for."""
    family, wish = setting.family, setting.family.occlusion
    if family.crowd is not None:
        setting, recorded = recorded_setting(setting, family.crowd, generator)
        pool = recorded_pool(setting, recorded, wish, generator)
    else:
        pool = drawn_pool(setting, wish, generator)
    crowds = [crowd for _ in range(_CROWDS) if (crowd := random_crowd(pool, generator)) is not None]
    if wish is not None:
        better = [improved(pool, crowd, wish, chance=chance, generator=generator) for crowd in crowds]
        crowds = [crowd for crowd, _ in sorted(better, key=lambda each: each[1])]
    chosen = crowds[:_MENDED]
    if family.crowd is not None:
        yield from (_found(pool, crowd, pool.walks[crowd.walks], chance) for crowd in chosen)
        return
    for crowd, walks in zip(chosen, _walked(pool, chosen), strict=True):
        if wish is None:
            yield _found(pool, crowd, walks, chance)
        else:
            mending = mending_pool(pool, walks, tuple(crowd.obstacles.tolist()), wish, generator)
            own = Crowd(walks=np.arange(len(walks)), obstacles=np.arange(len(crowd.obstacles)))
            mended, _ = improved(mending, own, wish, chance=chance, generator=generator)
            yield _found(mending, mended, mending.walks[mended.walks], chance)


def _found(pool: Pool, crowd: Crowd, walks: Walks, chance: float) -> _Found:
    """The crowd as it walks, and how far what is foretold of it is from the wish, if there is one."""
    wish, cover = pool.setting.family.occlusion, cover_of(pool, crowd)
    return _Found(
        walks=walks,
        obstacles=tuple(pool.obstacles[number] for number in crowd.obstacles.tolist()),
        misfit=0.0 if wish is None else float(misfit(wish, cover, chance=chance)[0]),
        foretold=foretold(cover),
    )


def _refusal(setting: Setting, seed: int, nearest: Foretold | None) -> str:
    """Why there is no scene, in one line."""
    family, wish = setting.family, setting.family.occlusion
    name = f"family {family.name!r}, seed {seed}"
    if nearest is None or wish is None:
        who, room = (setting.people, ", or raise 'people.depth_m'") if family.crowd is None else ("recorded", "")
        return (
            f"{name}: expected {who} people who keep {family.people.clearance_m:g} m apart and clear of "
            f"{len(setting.kinds)} obstacles, found none in {_ROUNDS * _CROWDS} crowds: lower 'people.count', "
            f"'people.clearance_m' or the obstacles' counts and widths{room}"
        )
    share = "" if wish.hidden_share is None else f" and {wish.hidden_share:g} hidden"
    return (
        f"{name}: expected holes of {wish.hole_frames:g} frames{share} by {wish.by}, the nearest found were "
        f"{nearest.sentence}: change 'occlusion', or the counts and sizes of people and obstacles, or 'frames'"
    )


def _walked(pool: Pool, crowds: Sequence[Crowd]) -> list[Walks]:
    """The crowds as they walk when people evade one another and the obstacles."""
    setting, people = pool.setting, pool.setting.family.people
    if not crowds:
        return []
    walks = [pool.walks[crowd.walks] for crowd in crowds]
    places = np.stack([each.place for each in walks])
    span = float(np.ptp(setting.moments))
    walked = social_force_walks(
        Crowds(
            starts=places[:, :, 0],
            goals=places[:, :, -1],
            speeds=np.linalg.norm(places[:, :, -1] - places[:, :, 0], axis=-1) / span,
            discs=_discs(pool, crowds),
        ),
        seconds=span,
        step_s=STEP_S,
        clearance_m=people.clearance_m,
        obstacle_clearance_m=people.obstacle_clearance_m,
    )
    count = len(setting.moments)
    return [replace(each, place=place[:, :count]) for place, each in zip(walked, walks, strict=True)]


def _discs(pool: Pool, crowds: Sequence[Crowd]) -> Float[np.ndarray, "crowd disc 3"]:
    """What stands in each crowd's way, filled up with NaN."""
    none = np.zeros((0, 3))
    standing = [[discs_of(pool.obstacles[number]) for number in crowd.obstacles.tolist()] for crowd in crowds]
    rows = [np.concatenate([none, *each]) for each in standing]
    most = max(map(len, rows))
    return np.stack([np.pad(each, ((0, most - len(each)), (0, 0)), constant_values=np.nan) for each in rows])


def _scene(setting: Setting, found: _Found, seed: int) -> Scene:
    """The crowd as a scene."""
    family = setting.family
    return Scene(
        name=f"{family.name}-{seed}",
        description=family.description,
        frames=setting.frames,
        fps=family.fps,
        camera=setting.spot,
        people=tuple(_people(found.walks)),
        obstacles=found.obstacles,
        vary=Vary(clearance_m=family.people.clearance_m, obstacle_clearance_m=family.people.obstacle_clearance_m),
        sensor=setting.sensor,
        occlusion=family.occlusion,
    )


def _people(walks: Walks) -> Iterator[Person]:
    """The walkers as a scene has them."""
    for place, body, phase in zip(walks.place, walks.body.tolist(), walks.phase.tolist(), strict=True):
        waypoints, times = walk_record(place, step_s=STEP_S, begin_s=-BEFORE_S)
        yield Person(body=silhouettes().bodies[body], waypoints=waypoints, times=times, phase=phase)


def _keeps_clear(scene: Scene) -> bool:
    """Whether people keep apart, and clear of obstacles, in every frame."""
    found = smallest_clearance(walkers_centres(scene), scene.obstacles)
    return found.people_m >= scene.vary.clearance_m and found.obstacles_m >= scene.vary.obstacle_clearance_m
