"""Step 9 of the default, first part: how well one segment goes on as another.

Both are laid on one smooth path (`path`); what they miss it by more than each its own is the price of the link.
So what is known well, where someone went and how fast, counts, and what is not, the place of a sliver, does not.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from algorithm.outlines import size_limits
from algorithm.path import astray_m, evidence, full_area, smoothest
from algorithm.restlessness import shown_restlessness
from algorithm.segment_frames import SegmentFrames
from algorithm.settings import Settings

_PLACE_M, _SPEED_M_PER_S = 0.15, 0.15
"""How well a segment's end tells its place and speed."""
_SWING_M = 0.1
"""Parts of a body swing by so much: seen for a short time, they tell little of its speed."""
_ROOM_M, _SPEEDS_M_PER_S = 2.0, 1.0
"""How far apart the places, and the speeds, of people are who have nothing to do with one another."""
_TURNS = 2.5
"""What is hidden may be so much more restless than what is seen: a ball in a hand."""
_STILL, _ALIKE, _UNLIKE_PRICE = 0.05, 5.0, 2.0
"""Restlessness of one body is alike within this factor, and what is below counts as such; beyond it has a price."""
_TAIL = 4.0
"""Degrees of freedom of Student's t: so surprising is a turn or a stop."""
_HIDDEN_PRICE = 1.0
"""Of a second of being hidden: holes are short more often than long."""
_HEIGHT_M = 0.05
"""Standard deviation of the height of a body between two segments."""
_HEIGHT_PRICE = 4.0
"""No difference of height is dearer: what is seen from above shows its feet now and then, and so another "height"."""
_SEEN = 0.8
"""Frames with more than this share of the full area show the height."""
_AS_LARGE = 1.6
"""Full areas within this factor are alike."""
_SMALL_M = 0.5
"""What is smaller is seen whole, and shows the same area again."""
_OVERLAP = 0.5
"""So large a share of the shorter of two segments of one body may be seen at the same time as the other."""
_SHOWN_TWICE = 1.3
"""Two parts of one body that are seen at the same time show so much of its full area at the most."""
_OFTEN = 0.8
"""In so large a share of the frames that two segments have in common their union must be no larger than a body."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidates:
    """Links that are possible."""

    before: Int[np.ndarray, "link"]
    after: Int[np.ndarray, "link"]
    price: Float[np.ndarray, "link"]
    """Negative log of how much likelier one motion is than two: below 0 they rather are one."""
    restlessness: Float[np.ndarray, "link"]
    """That was reckoned with, m^2 / s^3."""


def candidates(rows: SegmentFrames, settings: Settings, *, fps: float) -> Candidates:
    """Which segment may go on as which, and at what price.

    Segment b may follow a if it begins and ends after a does, at most `longest_hole_seconds` later, no farther than
    `fastest_walk_m_per_s` leads, and is no larger with a than a body where they overlap in time.
    """
    ones = rows.singles()
    before, after = _reachable(ones, settings, fps)
    fits = np.array(
        [_one_body(ones[a], ones[b], settings) for a, b in zip(before.tolist(), after.tolist(), strict=True)], bool
    )
    before, after = before[fits], after[fits]
    shown = np.array([shown_restlessness(one, fps=fps) for one in ones])
    changes = np.nan_to_num(_TURNS * np.fmin(shown[before], shown[after]))
    restlessness = np.maximum(changes, settings.restlessness_of_links)
    price = np.array(
        [
            _price((ones[a], ones[b]), restless, fps) + _difference(ones[a], ones[b])
            for a, b, restless in zip(before.tolist(), after.tolist(), restlessness.tolist(), strict=True)
        ]
    ).reshape(-1)
    unlike = np.nan_to_num(np.abs(np.log((shown[before] + _STILL) / (shown[after] + _STILL))))
    price += _UNLIKE_PRICE * np.maximum(unlike - np.log(_ALIKE), 0.0)
    return Candidates(before=before, after=after, price=price, restlessness=restlessness)


def _reachable(
    ones: list[SegmentFrames], settings: Settings, fps: float
) -> tuple[Int[np.ndarray, "link"], Int[np.ndarray, "link"]]:
    first = np.array([one.frame[0] for one in ones], int)
    last = np.array([one.frame[-1] for one in ones], int)
    begin = np.array([one.centre[0] for one in ones]).reshape(-1, 3)
    end = np.array([one.centre[-1] for one in ones]).reshape(-1, 3)
    gap = first[None, :] - last[:, None]
    later = (first[None, :] > first[:, None]) & (last[None, :] > last[:, None])
    timely = later & (gap <= settings.longest_hole_seconds * fps) & (gap >= -settings.longest_overlap_seconds * fps)
    before, after = np.nonzero(timely)
    far = np.linalg.norm(begin[after] - end[before], axis=1)
    reach = settings.tallest_m + settings.fastest_walk_m_per_s * np.maximum(gap[before, after], 1) / fps
    return before[far <= reach], after[far <= reach]


def _one_body(one: SegmentFrames, other: SegmentFrames, settings: Settings) -> bool:
    """Whether two segments can be one body in the frames that both have, as on both sides of a trunk.

    These are the lesser part of either's frames. In most of them both together must be no larger than a body, and
    show no more than one of them shows alone.
    """
    _, here, there = np.intersect1d(one.frame, other.frame, assume_unique=True, return_indices=True)
    if not len(here):
        return True
    if len(here) > _OVERLAP * min(len(one.frame), len(other.frame)):
        return False
    extent = np.maximum(one.high[here], other.high[there]) - np.minimum(one.low[here], other.low[there])
    limit = size_limits(widest_m=settings.widest_m, tallest_m=settings.tallest_m)
    shown = float(np.median(one.area[here] + other.area[there]))
    most = max(full_area(one), full_area(other))
    return bool((extent <= limit).all(axis=1).mean() >= _OFTEN and shown <= _SHOWN_TWICE * most)


def _price(pair: tuple[SegmentFrames, SegmentFrames], restlessness: float, fps: float) -> float:
    """The price of one path for both, by place and speed."""
    one, other = pair
    both = SegmentFrames.together(one, other)
    area = full_area(both)
    misses = [
        smoothest(evidence(rows, full_area=area, fps=fps), fps=fps, restlessness=restlessness)[1]
        for rows in (both, one, other)
    ]
    missed = max(misses[0] - misses[1] - misses[2], 0.0)
    hidden = max(float(other.frame[0] - one.frame[-1]), 1.0) / fps
    place = _PLACE_M**2 + restlessness * hidden**3 / 3.0
    speed = _SPEED_M_PER_S**2 + restlessness * hidden
    for rows in (one, other):
        place += float(np.mean(astray_m(rows.area.max(keepdims=True) / area)[0, :2] ** 2))
        speed += (_SWING_M * fps / len(rows.frame)) ** 2
    surprise = (_TAIL + 4.0) / 2.0 * np.log1p(missed / _TAIL)
    surprise += _HIDDEN_PRICE * hidden
    return float(surprise + np.log(min(place / _ROOM_M**2, 1.0)) + np.log(min(speed / _SPEEDS_M_PER_S**2, 1.0)))


def _difference(one: SegmentFrames, other: SegmentFrames) -> float:
    """The price of two looks: of the heights that bodies reach up to, or of the areas of what is small.

    Heights say nothing where one shows less of itself than the other, and little where they are unsteady.
    """
    areas = full_area(one), full_area(other)
    ratio = max(areas) / min(areas)
    if max(_extent(one), _extent(other)) < _SMALL_M:
        return float(_UNLIKE_PRICE * max(np.log(ratio / _AS_LARGE), 0.0))
    if ratio > _AS_LARGE:
        return 0.0
    tops = [rows.high[rows.area >= _SEEN * area, -1] for rows, area in zip((one, other), areas, strict=True)]
    middle = [float(np.median(top)) for top in tops]
    unsteady = sum(float(np.mean(np.abs(top - usual))) ** 2 for top, usual in zip(tops, middle, strict=True))
    surprise = 2.5 * np.log1p((middle[0] - middle[1]) ** 2 / (4 * _HEIGHT_M**2 + unsteady))
    return float(min(surprise, _HEIGHT_PRICE))


def _extent(one: SegmentFrames) -> float:
    """The largest extent in any direction and frame, metres."""
    return float((one.high - one.low).max())
