"""Step 9 of the default, third part: what no link reached goes to the motion that it lies in.

A foot seen under a table, or the sliver that shows between two people: too little to tell where it goes, yet where a
motion's outline passes at the time.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from algorithm.outlines import reaches
from algorithm.path import full_area
from algorithm.representative import Curve
from algorithm.restlessness import restless_path
from algorithm.segment_frames import SegmentFrames
from algorithm.settings import Settings

_SLACK = 0.3
"""A straggler may stand out by this share of the outline's width."""
_OFTEN = 0.7
"""In so large a share of its frames a straggler must lie in the outline."""
_LITTLE = 0.3
"""A straggler shows at most this share of what its host shows when all of it is seen."""
_USUAL = 10, 90
"""Percentiles of a body's reach from its path that make its outline."""
_SWING, _LIMB = 0.15, 2.0
"""What strays about its mean place beside the host by at most this share of the host's extent, as a limb that swings
does, may be so many times as fast ..."""
_BODY_M = 1.2
"""... if the host is as large as a body: balls are juggled about hands."""
_AHEAD_SECONDS = 0.3
"""A path is drawn out so far beyond its ends."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Host:
    """A motion that others may belong to."""

    curve: Curve
    low: Float[np.ndarray, "direction"]
    """The outline's reach from the path, metres."""
    high: Float[np.ndarray, "direction"]
    area: float
    """What it shows of itself when nothing hides it."""
    shown: float
    """Its area in all frames."""


def gathered(rows: SegmentFrames, settings: Settings, *, fps: float) -> Int[np.ndarray, "motion"]:
    """The motion that each motion belongs to, itself if it is none's straggler; names are not made anew.

    The rows are those of motions. Motion m is a straggler of h if it shows little beside h, in 70 % of its frames lies
    in h's outline, carried along h's path, and moves with it as companions do, or as a limb that swings; of several the
    one whose path it keeps nearest to. The outline reaches as far up and down as h ever does: feet show now and then.
    """
    ones = rows.singles()
    hosts = [_host(one, settings, fps) for one in ones]
    shown = np.array([host.shown for host in hosts])
    near = _Nearness(hosts, reach_m=settings.tallest_m)
    into = np.arange(len(ones))
    for number, one in enumerate(ones):
        possible = near.hosts_of(one, area=hosts[number].area)
        larger = possible[shown[possible] > shown[number]].tolist()
        distances = {other: _distance(one, hosts[other], settings, fps) for other in larger}
        nearest = min(distances, key=lambda other: distances[other], default=number)
        if distances.get(nearest, np.inf) < np.inf:
            into[number] = nearest
    for _ in range(len(ones)):
        into = into[into]
    return into


class _Nearness:
    """Where every host is in every frame, to ask few of them."""

    def __init__(self, hosts: list[Host], *, reach_m: float) -> None:
        last = max((host.curve.last for host in hosts), default=-1)
        self._reach_m = reach_m
        self._area = np.array([host.area for host in hosts])
        self._place = np.full((last + 1, len(hosts), 3), np.nan, np.float32)
        for number, host in enumerate(hosts):
            self._place[host.curve.first : host.curve.last + 1, number] = host.curve.position

    def hosts_of(self, one: SegmentFrames, *, area: float) -> Int[np.ndarray, "host"]:
        """The hosts that show enough beside a full area, and at its middle frame are about where the motion is."""
        middle = len(one.frame) // 2
        apart = np.linalg.norm(self._place[one.frame[middle]] - one.centre[middle], axis=1)
        return np.flatnonzero((apart <= self._reach_m) & (area <= _LITTLE * self._area))


def _host(one: SegmentFrames, settings: Settings, fps: float) -> Host:
    curve = restless_path(one, fps=fps, calmest=settings.restlessness)
    along = reaches(curve.position[one.frame - curve.first])
    low = np.percentile(one.low - along, _USUAL[0], axis=0)
    high = np.percentile(one.high - along, _USUAL[1], axis=0)
    low[-1], high[-1] = (one.low - along)[:, -1].min(), (one.high - along)[:, -1].max()
    return Host(curve=curve, low=low, high=high, area=full_area(one), shown=float(one.area.sum()))


def _distance(one: SegmentFrames, host: Host, settings: Settings, fps: float) -> float:
    """The mean distance of a motion's centre from the host's path, metres; infinite for no straggler of it."""
    curve = host.curve
    reach = round(_AHEAD_SECONDS * fps)
    common = (one.frame >= curve.first - reach) & (one.frame <= curve.last + reach)
    if common.sum() < _OFTEN * len(one.frame):
        return np.inf
    place = _places(curve, one.frame[common])
    along = reaches(place)
    slack = _SLACK * (host.high - host.low)
    inside = (one.low[common] - along >= host.low - slack) & (one.high[common] - along <= host.high + slack)
    if inside.all(axis=1).sum() < _OFTEN * len(one.frame):
        return np.inf
    onward = _places(curve, one.frame[common] + 1) - place
    missed = np.sum((one.step[common] - onward)[one.followed[common] > 0] ** 2, axis=1)
    beside = one.centre[common] - place
    extent = float(np.max(host.high - host.low))
    swings = extent >= _BODY_M and np.linalg.norm(beside - beside.mean(axis=0), axis=1).max() <= _SWING * extent
    fastest = settings.companion_speed_m_per_s * (_LIMB if swings else 1.0)
    if len(missed) and fps * np.sqrt(missed.mean()) > fastest:
        return np.inf
    return float(np.linalg.norm(beside, axis=1).mean())


def _places(curve: Curve, frame: Int[np.ndarray, "moment"]) -> Float[np.ndarray, "moment 3"]:
    """The curve's places, drawn out straight beyond its ends."""
    inside = np.clip(frame, curve.first, curve.last)
    place = curve.position[inside - curve.first]
    if len(curve.position) > 1:
        place = place + np.minimum(frame - curve.first, 0)[:, None] * (curve.position[1] - curve.position[0])
        place = place + np.maximum(frame - curve.last, 0)[:, None] * (curve.position[-1] - curve.position[-2])
    return place
