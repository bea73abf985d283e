"""How far groups of trajectories reach in every frame, and their unions refused where none could be one body."""

from typing import NamedTuple

import numba
import numpy as np
from jaxtyping import Float, Float32, Int

from algorithm.compiled import compiled

_POINTS_AT_ONCE = 1_000_000
"""Bounds the memory."""
_MEMBERS_A_PAIR = 4
SMALLEST_M = 0.15
"""What is smaller counts as so large when it strays: a ball turns, and shows now this half of it and now that."""
_STRAY = 1.2
"""Parts of a body stray about one another by this share of its extent."""
_HORIZONTALS = 4
_ANGLES = np.arange(_HORIZONTALS) * np.pi / _HORIZONTALS
DIRECTIONS: Float[np.ndarray, "direction 3"] = np.concatenate(
    [np.stack([np.cos(_ANGLES), np.sin(_ANGLES), np.zeros(_HORIZONTALS)], axis=1), [[0.0, 0.0, 1.0]]]
)
"""Widths are measured along four horizontal directions (8 % too small at the worst), height along the last."""


HORIZONTAL = slice(0, _HORIZONTALS)
"""The horizontal ones of them."""


def size_limits(*, widest_m: float, tallest_m: float) -> Float32[np.ndarray, "direction"]:
    """The largest extent along each of `DIRECTIONS`, metres."""
    return np.array([widest_m] * _HORIZONTALS + [tallest_m], np.float32)


def reaches(position: Float[np.ndarray, "point 3"]) -> Float32[np.ndarray, "point direction"]:
    """How far points lie along `DIRECTIONS`, metres."""
    found = np.empty((len(position), len(DIRECTIONS)), np.float32)
    for begin in range(0, len(position), _POINTS_AT_ONCE):
        part = slice(begin, begin + _POINTS_AT_ONCE)
        found[part] = position[part] @ DIRECTIONS.T
    return found


class Intervals(NamedTuple):
    """Consecutive moments of each trajectory; `row` is where its first one stands in the reaches."""

    first: Int[np.ndarray, "trajectory"]
    lasts: Int[np.ndarray, "trajectory"]
    row: Int[np.ndarray, "trajectory"]


@compiled
def united(
    pairs: tuple[np.ndarray, np.ndarray],
    intervals: Intervals,
    reach: np.ndarray,
    limit: np.ndarray,
    refuse_after: int,
) -> np.ndarray:
    """The group of every trajectory when the pairs are united in turn (Kruskal), but for unions that are no body.

    `pairs` come in order of falling trust. A union is refused if in more than `refuse_after` common moments its
    extent along some direction is above the `limit`; or if one part strays about the other farther than the larger
    one's extent times 1.2, as balls do that meet in a hand. It is put off until there is one pair more for every four
    members of the smaller group: two bodies are not one for a few bad matches. Groups are named by a member.
    """
    parent = np.arange(len(intervals.first))
    members = np.ones(len(parent), np.int64)
    extent = np.zeros(len(parent))
    support = numba.typed.Dict.empty(numba.types.int64, numba.types.int64)
    begin, end = intervals.first.copy(), intervals.first + intervals.lasts
    room_begin, room_end, room = begin.copy(), end.copy(), intervals.row.copy()
    low, high = reach.copy(), reach.copy()
    used = len(low)
    for number in range(len(pairs[0])):
        one, other = _root(parent, pairs[0][number]), _root(parent, pairs[1][number])
        if one == other or _put_off(support, members, one, other):
            continue
        if end[one] - begin[one] < end[other] - begin[other]:
            one, other = other, one
        shared = max(begin[one], begin[other]), min(end[one], end[other])
        rows = room[one] - room_begin[one], room[other] - room_begin[other]
        size = max(extent[one], extent[other])
        if _too_large(low, high, rows, shared, limit, refuse_after) or _astray(low, high, rows, shared, size):
            continue
        parent[other] = one
        members[one] += members[other]
        first, last = min(begin[one], begin[other]), max(end[one], end[other])
        if first < room_begin[one] or last > room_end[one]:  # Moves to thrice the room, so that it seldom does.
            spare = last - first
            moved = rows[0] + begin[one], end[one] - begin[one], begin[one] - first + spare
            low, high = _moved(low, used, 3 * spare, moved), _moved(high, used, 3 * spare, moved)
            room_begin[one], room_end[one], room[one] = first - spare, last + spare, used
            used += 3 * spare
            rows = room[one] - room_begin[one], rows[1]
        _blank(low, high, rows[0], (first, begin[one]))
        _blank(low, high, rows[0], (end[one], last))
        extent[one] = max(size, _widened(low, high, rows, (begin[other], end[other])))
        begin[one], end[one] = first, last
    for member in range(len(parent)):
        parent[member] = _root(parent, member)
    return parent


@compiled
def _put_off(support: dict[int, int], members: np.ndarray, one: int, other: int) -> bool:
    """Whether more pairs have to speak for the union of two groups; this one is counted."""
    needed = min(members[one], members[other]) // _MEMBERS_A_PAIR
    if needed == 0:
        return False
    key = min(one, other) * len(members) + max(one, other)
    known = support.get(key, 0)
    support[key] = known + 1
    return known < needed


@compiled
def _too_large(
    low: np.ndarray,
    high: np.ndarray,
    rows: tuple[int, int],
    shared: tuple[int, int],
    limit: np.ndarray,
    refuse_after: int,
) -> bool:
    """Whether the union of two groups is beyond the limit in more than so many of the shared moments."""
    beyond = 0
    for moment in range(shared[0], shared[1]):
        one, other = rows[0] + moment, rows[1] + moment
        if low[one, 0] > high[one, 0] or low[other, 0] > high[other, 0]:
            continue  # One of them has no point in this moment.
        for direction in range(len(limit)):
            top = max(high[one, direction], high[other, direction])
            if top - min(low[one, direction], low[other, direction]) > limit[direction]:
                beyond += 1
                break
        if beyond > refuse_after:
            return True
    return False


@compiled
def _astray(low: np.ndarray, high: np.ndarray, rows: tuple[int, int], shared: tuple[int, int], size: float) -> bool:
    """Whether the middle of one group strays about that of the other farther than a body of this size lets it."""
    for direction in range(low.shape[1]):
        least, most = np.inf, -np.inf
        for moment in range(shared[0], shared[1]):
            one, other = rows[0] + moment, rows[1] + moment
            apart = low[one, direction] + high[one, direction] - low[other, direction] - high[other, direction]
            if np.isfinite(apart):
                least, most = min(least, apart / 2), max(most, apart / 2)
        if most - least > _STRAY * max(size, SMALLEST_M):
            return True
    return False


@compiled
def _blank(low: np.ndarray, high: np.ndarray, row: int, moments: tuple[int, int]) -> None:
    """No point in these moments."""
    for moment in range(moments[0], moments[1]):
        low[row + moment] = np.inf
        high[row + moment] = -np.inf


@compiled
def _widened(low: np.ndarray, high: np.ndarray, rows: tuple[int, int], moments: tuple[int, int]) -> float:
    """The first group's outline widened by the second's in its moments; the largest extent there, metres."""
    widest = 0.0
    for moment in range(moments[0], moments[1]):
        to, source = rows[0] + moment, rows[1] + moment
        for direction in range(low.shape[1]):
            low[to, direction] = min(low[to, direction], low[source, direction])
            high[to, direction] = max(high[to, direction], high[source, direction])
            widest = max(widest, high[to, direction] - low[to, direction])
    return widest


@compiled
def _root(parent: np.ndarray, member: int) -> int:
    while parent[member] != member:
        parent[member] = parent[parent[member]]
        member = parent[member]
    return member


@compiled
def _moved(values: np.ndarray, used: int, room: int, rows: tuple[int, int, int]) -> np.ndarray:
    """The values with some rows copied into new room behind what is used: from where, how many, how far into it."""
    if used + room > len(values):
        grown = np.empty((max(used + room, 2 * len(values)), values.shape[1]), values.dtype)
        grown[:used] = values[:used]
        values = grown
    source, count, offset = rows
    values[used + offset : used + offset + count] = values[source : source + count]
    return values
