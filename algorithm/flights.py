"""Step 9 of the default, fourth part: what flies goes on as what falls along the same parabola.

A ball that passes behind a pillar shows itself for a few frames on either side, too little to tell how restless it is.
But in the air nothing can turn: two short flights are one where a single free fall explains both.
"""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float

from algorithm.segment_frames import SegmentFrames
from recording.motions import Link

_GRAVITY_M_PER_S2 = np.array([0.0, 0.0, -9.81])
_LARGEST_M = 0.5
"""Of what is thrown; in any direction."""
_SLOWEST_M_PER_S = 1.5
"""Faster than this it goes all the time ..."""
_FALLS = 3.0
"""... or else a straight line misses it so many times farther than the parabola: near its top it is slow, but falls."""
_MISS_M = 0.06
"""How far the centre of what is seen lies off the parabola at most (root mean square): half a ball may be hidden."""
_LEAST_FRAMES = 3
_LONGEST_SECONDS = 0.4
"""In so short a hole no other ball takes the same way."""
_END_SECONDS = 0.2
"""What is seen beside the hole for so long counts: before, it may have lain in a hand."""
_CONFIDENCE = 0.95
"""Of a link that free fall makes."""


def flights(rows: SegmentFrames, links: Iterable[Link], *, fps: float) -> tuple[Link, ...]:
    """The links between segments that are one free fall, such as `links` leave alone on these sides; short holes first.

    Both are no larger than half a metre and are seen in three frames at least, one after the other and at most
    0.4 s apart, and the parabola through what is seen of both 0.2 s before and after the hole misses their centres by
    at most 6 cm, at 1.5 m/s or more all the time or three times less than a straight line.
    """
    before = {link.before for link in links}
    after = {link.after for link in links}
    ones = rows.singles()
    small = [number for number, one in enumerate(ones) if _may_fly(one)]
    misses = {
        (a, b): _miss_m(ones[a], ones[b], fps)
        for a in small
        for b in small
        if a not in before and b not in after and 0 < ones[b].frame[0] - ones[a].frame[-1] <= _LONGEST_SECONDS * fps
    }
    made: list[Link] = []
    for a, b in sorted(misses, key=lambda pair: (ones[pair[1]].frame[0] - ones[pair[0]].frame[-1], misses[pair])):
        if misses[a, b] <= _MISS_M and a not in before and b not in after:
            before.add(a)
            after.add(b)
            made.append(Link(before=a, after=b, confidence=_CONFIDENCE))
    return tuple(made)


def _may_fly(one: SegmentFrames) -> bool:
    return len(one.frame) >= _LEAST_FRAMES and bool(np.median((one.high - one.low).max(axis=1)) <= _LARGEST_M)


def _miss_m(one: SegmentFrames, other: SegmentFrames, fps: float) -> float:
    """How far the free fall nearest to both ends misses their centres, metres; infinite where they show none."""
    span = round(_END_SECONDS * fps)
    one = one.part(slice(int(np.searchsorted(one.frame, one.frame[-1] - span)), None))
    other = other.part(slice(0, int(np.searchsorted(other.frame, other.frame[0] + span, side="right"))))
    time = (np.concatenate([one.frame, other.frame]) - one.frame[-1]) / fps
    place = np.concatenate([one.centre, other.centre])
    falling, begin = _miss_and_begin(place - 0.5 * _GRAVITY_M_PER_S2 * time[:, None] ** 2, time)
    straight, _ = _miss_and_begin(place, time)
    flies = _slowest(begin, time) >= _SLOWEST_M_PER_S or straight >= _FALLS * falling
    return falling if flies else np.inf


def _miss_and_begin(
    place: Float[np.ndarray, "moment 3"], time: Float[np.ndarray, "moment"]
) -> tuple[float, Float[np.ndarray, "3"]]:
    """How far the nearest straight line, at an even speed, misses the places (root mean square), and its velocity."""
    line = np.stack([np.ones_like(time), time], axis=1)
    start, *_ = np.linalg.lstsq(line, place, rcond=None)
    return float(np.sqrt(np.mean(np.sum((place - line @ start) ** 2, axis=1)))), start[1]


def _slowest(begin: Float[np.ndarray, "3"], time: Float[np.ndarray, "moment"]) -> float:
    """The least speed in these moments, metres a second."""
    return float(np.linalg.norm(begin + _GRAVITY_M_PER_S2 * time[:, None], axis=1).min())
