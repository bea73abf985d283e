"""How abruptly a motion changes: people hardly, balls that are caught and thrown very much."""

import numpy as np
from jaxtyping import Bool, Float

from algorithm.path import evidence, full_area, path, smoothest
from algorithm.representative import Curve
from algorithm.segment_frames import SegmentFrames

_FREE = 30.0
"""Restlessness, m^2 / s^3, that lets a path follow what is seen."""
_SPEED_SECONDS = 0.1
"""A speed is measured over this time."""
_CALM, _SWAY = 0.4, 0.5
"""What is hidden is calmer than what is seen: who walks sways, and noise looks like change."""
_CHANGE_SECONDS = 0.25
"""And its change over this one."""


def restless_path(rows: SegmentFrames, *, fps: float, calmest: float) -> Curve:
    """The path of a motion, as restless as it shows itself to be; who walks is as calm as `calmest`, m^2 / s^3."""
    shown = shown_restlessness(rows, fps=fps)
    return path(rows, fps=fps, restlessness=max(calmest, 0.0 if np.isnan(shown) else _CALM * (shown - _SWAY)))


def shown_restlessness(one: SegmentFrames, *, fps: float) -> float:
    """A motion's usual change of speed, as white noise of acceleration, m^2 / s^3: 0.1 of walkers, 7 of juggled balls.

    It is the median of the squared changes in 0.25 s, over that time and the three axes; of what is not seen for that
    long in half of it. NaN for what is seen too shortly even for that.
    """
    place, _ = smoothest(evidence(one, full_area=full_area(one), fps=fps), fps=fps, restlessness=_FREE)
    seen = np.zeros(len(place), bool)
    seen[one.frame - one.frame[0]] = True
    for part in (1.0, 0.5):
        span, lag = (max(1, round(part * seconds * fps)) for seconds in (_SPEED_SECONDS, _CHANGE_SECONDS))
        noise = np.sum(_changes(place, seen, span, lag) ** 2, axis=1) * fps**3 / (3.0 * lag)
        if len(noise):
            return float(np.median(noise))
    return np.nan


def _changes(
    place: Float[np.ndarray, "moment 3"], seen: Bool[np.ndarray, "moment"], span: int, lag: int
) -> Float[np.ndarray, "change 3"]:
    """How much the displacement a frame changes within the lag, where all of it was seen, metres."""
    if len(place) <= span + lag:
        return np.zeros((0, 3))
    speed = (place[span:] - place[:-span]) / span
    known = np.lib.stride_tricks.sliding_window_view(seen, span + lag + 1).all(axis=1)
    return np.asarray((speed[lag:] - speed[:-lag])[known])
