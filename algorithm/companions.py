"""Step 6 of the default, second part: segments that go together at the same time are one body.

What grouping leaves apart are limbs that nothing near keeps together with, and the two halves of a body that a
thin trunk cuts. Both are near, move alike and together are no larger than a body. The paper has no such step.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from algorithm.outlines import HORIZONTAL, SMALLEST_M, size_limits
from algorithm.segment_frames import SegmentFrames
from algorithm.settings import Settings

_LEAST_FRAMES, _LEAST_SHARE = 3, 0.5
"""Common frames that say anything of two segments, at the least, and as a share of the shorter one's: two that only
meet are for the links to judge."""
_OFTEN = 0.95
"""In so large a share of the common frames the union must be no larger than a body."""
_STRAY = 0.45
"""What strays less about the other, by this share of the extent, may also be fast: a swinging limb."""
_SHARED = 0.5
"""What lies over one another shares so much of its extent along every horizontal direction."""
_FULL_SIZE_M = 0.8
"""From this extent on the limits hold as they stand; half of a person is so large."""
_UPRIGHT_FRAMES, _UPRIGHT_BESIDE_M, _UPRIGHT_STRAY_M = 5, 0.4, 0.3
"""Common frames, and sideways distance and straying, of a head and of feet that show above and below what hides the
rest: then the gap between them says nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Meetings:
    """Two rows of `SegmentFrames` in the same frame, sorted by pair."""

    one: Int[np.ndarray, "meeting"]
    other: Int[np.ndarray, "meeting"]
    start: Int[np.ndarray, "pair"]
    """Where each pair of segments begins."""


def companions(rows: SegmentFrames, settings: Settings, *, fps: float) -> Int[np.ndarray, "segment"]:
    """The body of every segment, from 0: segments that go together are united, the nearest first.

    Two go together if over their common frames (three, and half of the shorter one's, at least) the union has the size
    of a body, the median gap between their boxes is at most `companion_gap_m`, and one's centre never strays sideways
    more than `companion_stray_m` from its mean place beside the other; for what is small these two shrink with its
    extent. And it must not stray at all, or move about the other slower than `companion_speed_m_per_s` (root mean
    square). Whatever the gap, so do two of which one keeps above the other, as a head and feet that show above and
    below somebody else.
    """
    body = np.arange(rows.count)
    while True:
        cost, pair = _costs(rows, settings, fps)
        name = _united(cost, pair, rows.count)
        if name is None:
            return body
        rows, body = rows.renamed(name), name[body]


def meetings(rows: SegmentFrames, *, reach_m: float) -> Meetings:
    """The pairs of rows in one frame whose centres are at most `reach_m` apart."""
    one, other = [np.zeros(0, int)], [np.zeros(0, int)]
    order = np.argsort(rows.frame, kind="stable")
    for part in np.split(order, np.flatnonzero(np.diff(rows.frame[order])) + 1):
        if len(part) > 1:
            near = cKDTree(rows.centre[part]).query_pairs(reach_m, output_type="ndarray")
            low, high = np.sort(part[near], axis=1).T
            one.append(low)
            other.append(high)
    first, second = np.concatenate(one), np.concatenate(other)
    order = np.lexsort((rows.frame[first], rows.segment[second], rows.segment[first]))
    first, second = first[order], second[order]
    key = rows.segment[first] * rows.count + rows.segment[second]
    start = np.flatnonzero(np.r_[True, np.diff(key) != 0]) if len(key) else np.zeros(0, int)
    return Meetings(one=first, other=second, start=start)


def union_fits(rows: SegmentFrames, met: Meetings, settings: Settings) -> Bool[np.ndarray, "meeting"]:
    """Where both rows together are no larger than a body.

    Slim need not be what lies over one another: two people stand side by side, an umbrella over its bearer.
    """
    extent = np.maximum(rows.high[met.one], rows.high[met.other]) - np.minimum(rows.low[met.one], rows.low[met.other])
    small = (extent <= size_limits(widest_m=settings.widest_m, tallest_m=settings.tallest_m)).all(axis=1)
    slim = extent[:, HORIZONTAL].min(axis=1) <= settings.slimmest_m
    return small & (slim | _over_one_another(rows, met))


def _over_one_another(rows: SegmentFrames, met: Meetings) -> Bool[np.ndarray, "meeting"]:
    """Where along every horizontal direction the rows share at least half of the smaller one's extent."""
    size = rows.high - rows.low
    shared = np.minimum(rows.high[met.one], rows.high[met.other]) - np.maximum(rows.low[met.one], rows.low[met.other])
    enough = shared >= _SHARED * np.minimum(size[met.one], size[met.other])
    return np.asarray(enough[:, HORIZONTAL].all(axis=1))


def gaps(rows: SegmentFrames, met: Meetings) -> Float[np.ndarray, "meeting"]:
    """The largest gap between the two rows along any direction, metres; 0 where they overlap in all."""
    apart = np.maximum(rows.low[met.one] - rows.high[met.other], rows.low[met.other] - rows.high[met.one])
    return np.maximum(apart, 0.0).max(axis=1, initial=0.0)


def _costs(
    rows: SegmentFrames, settings: Settings, fps: float
) -> tuple[Float[np.ndarray, "pair"], Int[np.ndarray, "pair 2"]]:
    """The pairs that may be united, and how badly they go together, metres."""
    met = meetings(rows, reach_m=settings.tallest_m)
    if not len(met.start):
        return np.zeros(0), np.zeros((0, 2), int)
    pair = np.stack([rows.segment[met.one[met.start]], rows.segment[met.other[met.start]]], axis=1)
    frames = np.diff([*met.start, len(met.one)])
    lasts = np.bincount(rows.segment)[pair].min(axis=1)
    fits = np.add.reduceat(union_fits(rows, met, settings).astype(float), met.start) / frames
    beside = _beside(rows, met, frames, fps)
    gap = _medians(gaps(rows, met), met.start, frames)
    extent = _extents(rows, met)
    size = np.clip(extent, SMALLEST_M, _FULL_SIZE_M) / _FULL_SIZE_M
    slow = beside.speed <= settings.companion_speed_m_per_s
    near = (gap <= size * settings.companion_gap_m) & (beside.stray <= size * settings.companion_stray_m)
    near &= slow | (beside.stray_3d <= _STRAY * extent)
    upright = (frames >= _UPRIGHT_FRAMES) & (_heights(rows, met, frames) >= _FULL_SIZE_M)
    upright &= slow & (beside.distance <= _UPRIGHT_BESIDE_M) & (beside.stray <= _UPRIGHT_STRAY_M)
    good = (frames >= np.maximum(_LEAST_FRAMES, _LEAST_SHARE * lasts)) & (fits >= _OFTEN) & (near | upright)
    cost = gap + 0.5 * beside.stray + 2.0 / 30.0 * fps / frames
    return cost[good], pair[good]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Beside:
    """How the centre of one segment of a pair keeps beside the other's; metres, metres a second."""

    distance: Float[np.ndarray, "pair"]
    """Sideways, of their mean places in the common frames."""
    stray: Float[np.ndarray, "pair"]
    """The farthest from the mean place, sideways."""
    stray_3d: Float[np.ndarray, "pair"]
    speed: Float[np.ndarray, "pair"]
    """Root mean square."""


def _beside(rows: SegmentFrames, met: Meetings, frames: Int[np.ndarray, "pair"], fps: float) -> _Beside:
    apart = rows.centre[met.one] - rows.centre[met.other]
    mean = np.add.reduceat(apart, met.start, axis=0) / frames[:, None]
    off = apart - np.repeat(mean, frames, axis=0)
    squares = np.sum((rows.step[met.one] - rows.step[met.other]) ** 2, axis=1)
    return _Beside(
        distance=np.linalg.norm(mean[:, :2], axis=1),
        stray=np.maximum.reduceat(np.linalg.norm(off[:, :2], axis=1), met.start),
        stray_3d=np.maximum.reduceat(np.linalg.norm(off, axis=1), met.start),
        speed=fps * np.sqrt(np.add.reduceat(squares, met.start) / frames),
    )


def _heights(rows: SegmentFrames, met: Meetings, frames: Int[np.ndarray, "pair"]) -> Float[np.ndarray, "pair"]:
    """The mean height of both together, metres."""
    top = np.maximum(rows.high[met.one, -1], rows.high[met.other, -1])
    foot = np.minimum(rows.low[met.one, -1], rows.low[met.other, -1])
    return np.add.reduceat(top - foot, met.start) / frames


def _extents(rows: SegmentFrames, met: Meetings) -> Float[np.ndarray, "pair"]:
    """The larger one's largest extent in any of their common frames, metres."""
    extent = (rows.high - rows.low).max(axis=1, initial=0.0)
    return np.maximum.reduceat(np.maximum(extent[met.one], extent[met.other]), met.start)


def _united(
    cost: Float[np.ndarray, "pair"], pair: Int[np.ndarray, "pair 2"], count: int
) -> Int[np.ndarray, "segment"] | None:
    """New names after the cheapest pairs are united, each segment once; None where there is no pair."""
    if not len(cost):
        return None
    name = np.arange(count)
    free = np.ones(count, bool)
    for one, other in pair[np.argsort(cost, kind="stable")].tolist():
        if free[one] and free[other]:
            free[[one, other]] = False
            name[other] = one
    return np.unique(name, return_inverse=True)[1]


def _medians(
    values: Float[np.ndarray, "meeting"], start: Int[np.ndarray, "pair"], count: Int[np.ndarray, "pair"]
) -> Float[np.ndarray, "pair"]:
    """The lower median of each pair's values."""
    pair = np.repeat(np.arange(len(start)), count)
    ordered = values[np.lexsort((values, pair))]
    return ordered[start + (count - 1) // 2]
