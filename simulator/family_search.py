"""The search for crowds that meet a wish: of a pool of walks and obstacles, those that together hide as was wanted.

From a random crowd, one member after the other is exchanged for the one of the pool with which the crowd is nearest
to the wish (coordinate descent), until no exchange helps.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from simulator.family_pool import Pool
from simulator.misfit import Cover, misfit
from simulator.occlusion import OcclusionWish

_SWEEPS = 4
_TRIES = 20


@dataclass(frozen=True, kw_only=True, eq=False)
class Crowd:
    """A choice from a pool."""

    walks: Int[np.ndarray, "person"]
    obstacles: Int[np.ndarray, "obstacle"]


def random_crowd(pool: Pool, generator: np.random.Generator) -> Crowd | None:
    """Obstacles that stand apart and people who keep apart; None where none were found."""
    for _ in range(_TRIES):
        obstacles: list[int] = []
        for kind in pool.setting.kinds:
            free = np.flatnonzero(_free_obstacles(pool, np.array(obstacles, np.intp), kind))
            obstacles += [int(generator.choice(free))] if len(free) else []
        walks: list[int] = []
        open_walks = pool.obstacle_fits[:, obstacles].all(axis=1)
        while len(walks) < pool.setting.people and open_walks.any():
            walks.append(int(generator.choice(np.flatnonzero(open_walks))))
            open_walks = open_walks & pool.walks_fit[walks[-1]]
        if len(walks) == pool.setting.people and len(obstacles) == len(pool.setting.kinds):
            return Crowd(walks=np.array(walks, np.intp), obstacles=np.array(obstacles, np.intp))
    return None


def improved(
    pool: Pool, crowd: Crowd, wish: OcclusionWish, *, chance: float, generator: np.random.Generator
) -> tuple[Crowd, float]:
    """The crowd after exchanges, and its misfit."""
    best, slots = np.inf, len(crowd.walks) + len(crowd.obstacles)
    for _ in range(_SWEEPS):
        before = best
        for slot in generator.permutation(slots).tolist():
            crowd, best = _exchanged(pool, crowd, slot, wish, chance)
        if best > 0.98 * before:
            break
    return crowd, best


def cover_of(pool: Pool, crowd: Crowd) -> Cover:
    """What is covered of the crowd; its last member comes last."""
    return _cover_with_walk(pool, crowd.walks[:-1], crowd.obstacles, crowd.walks[-1:])


def _exchanged(pool: Pool, crowd: Crowd, slot: int, wish: OcclusionWish, chance: float) -> tuple[Crowd, float]:
    """The crowd with the best of all members in one place, and its misfit."""
    if slot < len(crowd.walks):
        others = np.delete(crowd.walks, slot)
        fits = pool.walks_fit[others].all(axis=0) & pool.obstacle_fits[:, crowd.obstacles].all(axis=1)
        fits[crowd.walks[slot]] = True
        candidates = np.flatnonzero(fits)
        off = misfit(wish, _cover_with_walk(pool, others, crowd.obstacles, candidates), chance=chance)
        walks = np.insert(others, slot, candidates[off.argmin()])
        return Crowd(walks=walks, obstacles=crowd.obstacles), float(off.min())
    place = slot - len(crowd.walks)
    others = np.delete(crowd.obstacles, place)
    fits = _free_obstacles(pool, others, pool.setting.kinds[place]) & pool.obstacle_fits[crowd.walks].all(axis=0)
    fits[crowd.obstacles[place]] = True
    candidates = np.flatnonzero(fits)
    off = misfit(wish, _cover_with_obstacle(pool, crowd.walks, others, candidates), chance=chance)
    obstacles = np.insert(others, place, candidates[off.argmin()])
    return Crowd(walks=crowd.walks, obstacles=obstacles), float(off.min())


def _cover_with_walk(pool: Pool, others: np.ndarray, obstacles: np.ndarray, candidates: np.ndarray) -> Cover:
    """What is covered of the others and of each candidate, last, in a crowd of these."""
    among = np.bitwise_or.reduce(pool.by_walk[others[:, None], others], axis=1)
    of_others = among[None] | pool.by_walk[others[None, :], candidates[:, None]]
    of_candidate = np.bitwise_or.reduce(pool.by_walk[candidates[:, None], others[None, :]], axis=1)
    members = np.concatenate([np.broadcast_to(others, (len(candidates), len(others))), candidates[:, None]], axis=1)
    behind = np.bitwise_or.reduce(pool.by_obstacle[:, obstacles], axis=1)
    return Cover(
        inside=pool.inside[members],
        people=np.concatenate([of_others, of_candidate[:, None]], axis=1),
        obstacles=behind[members],
    )


def _cover_with_obstacle(pool: Pool, walks: np.ndarray, others: np.ndarray, candidates: np.ndarray) -> Cover:
    """What is covered of the crowd with each candidate."""
    among = np.bitwise_or.reduce(pool.by_walk[walks[:, None], walks], axis=1)
    behind = np.bitwise_or.reduce(pool.by_obstacle[walks[:, None], others[None]], axis=1)
    shape = (len(candidates), *among.shape)
    return Cover(
        inside=np.broadcast_to(pool.inside[walks], shape),
        people=np.broadcast_to(among, shape),
        obstacles=behind[None] | pool.by_obstacle[walks[None, :], candidates[:, None]],
    )


def _free_obstacles(pool: Pool, others: np.ndarray, kind: str) -> Bool[np.ndarray, "obstacle"]:
    """Which obstacles of the kind may stand beside the others."""
    of_kind = np.array([each == kind for each in pool.kinds], bool)
    return of_kind & pool.obstacles_fit[others].all(axis=0)
