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
"""Faster than this it goes all the time."""
_MISS_M = 0.06
"""How far the centre of what is seen lies off the parabola at most (root mean square): half a ball may be hidden."""
_LEAST_FRAMES = 3
_LONGEST_SECONDS = 0.4
"""In so short a hole no other ball takes the same way."""
_CONFIDENCE = 0.95
"""Of a link that free fall makes."""


def flights(rows: SegmentFrames, links: Iterable[Link], *, fps: float) -> tuple[Link, ...]:
    """The links between segments that are one free fall, such as `links` leave alone on these sides; short holes first.

    Both are no larger than half a metre and are seen in three frames at least, one after the other and at most
    0.4 s apart, and the parabola through both misses their centres by at most 6 cm, at 1.5 m/s or more.
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
    """How far the free fall nearest to both misses their centres, metres; infinite where it is too slow for one."""
    time = (np.concatenate([one.frame, other.frame]) - one.frame[-1]) / fps
    place = np.concatenate([one.centre, other.centre])
    weightless = place - 0.5 * _GRAVITY_M_PER_S2 * time[:, None] ** 2
    straight = np.stack([np.ones_like(time), time], axis=1)
    start, *_ = np.linalg.lstsq(straight, weightless, rcond=None)
    if _slowest(start[1], time) < _SLOWEST_M_PER_S:
        return np.inf
    return float(np.sqrt(np.mean(np.sum((weightless - straight @ start) ** 2, axis=1))))


def _slowest(begin: Float[np.ndarray, "3"], time: Float[np.ndarray, "moment"]) -> float:
    """The least speed in these moments, metres a second."""
    return float(np.linalg.norm(begin + _GRAVITY_M_PER_S2 * time[:, None], axis=1).min())
