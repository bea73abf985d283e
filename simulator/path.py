"""Where somebody walks: a smooth curve over the ground, and when each place of it is passed."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from recording.errors import InputError

FASTEST_WALK = 2.5
"""Metres a second; whoever is faster runs."""
_SAMPLES_A_METRE = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """A curve over the ground, parametrised by time."""

    times: Float[np.ndarray, "sample"]
    """Seconds, growing."""
    places: Float[np.ndarray, "sample 2"]
    """World x and y at these times, metres."""

    @property
    def begin(self) -> float:
        """When the first place is left, seconds."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """When the last place is reached, seconds."""
        return float(self.times[-1])

    def positions(self, times: Float[np.ndarray, "time"]) -> Float[np.ndarray, "time 2"]:
        """The place at each time, metres: at rest at the first place before, at the last one after."""
        return np.stack([np.interp(times, self.times, axis) for axis in self.places.T], axis=-1)


def path_through(
    waypoints: Sequence[tuple[float, float]],
    *,
    speed: float | None = None,
    times: Sequence[float] | None = None,
    start: float = 0.0,
) -> Path:
    """The path through the way-points: a straight line between two, else a cubic spline.

    With `speed` (m/s) it is walked at that speed all along; with `times` each way-point is passed at its
    time. `start` (seconds) is added to all times.
    """
    places = np.asarray(waypoints, float)
    if len(places) < 2:
        raise InputError(f"expected two way-points at least, got {len(places)}")
    if (speed is None) == (times is None):
        raise InputError("expected either a speed or times for the way-points")
    if times is not None:
        if len(times) != len(places):
            raise InputError(f"expected a time for each of the {len(places)} way-points, got {len(times)}")
        return _timed(places, np.asarray(times, float) + start)
    if speed is None or not 0 < speed <= FASTEST_WALK:
        raise InputError(f"expected a speed above 0 and up to {FASTEST_WALK} m/s, got {speed}")
    return _at_speed(places, speed, start)


def _at_speed(places: Float[np.ndarray, "waypoint 2"], speed: float, start: float) -> Path:
    """The path at one speed: sampled evenly along the spline over the chords, timed by its length."""
    chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    if (np.diff(chord) <= 0).any():
        raise InputError("expected way-points that differ from the one before (to wait, give times)")
    along = np.linspace(0.0, chord[-1], max(2, int(chord[-1] * _SAMPLES_A_METRE)))
    curve = _spline(chord, places)(along)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    return Path(times=start + length / speed, places=curve)


def _timed(places: Float[np.ndarray, "waypoint 2"], times: Float[np.ndarray, "waypoint"]) -> Path:
    """The path that passes each way-point at its time; equal way-points in turn are a stop."""
    if (np.diff(times) <= 0).any():
        raise InputError("expected times that grow from way-point to way-point")
    between = np.arange(times[0], times[-1], 1 / 120)  # Rounding can take the last one past the end.
    sampled = np.unique(np.concatenate([between[between < times[-1]], times]))
    rests = np.flatnonzero((np.diff(places, axis=0) == 0).all(axis=1))
    ends = np.unique([0, len(places) - 1, *rests, *(rests + 1)])
    curve = np.empty((len(sampled), 2))
    for first, last in pairwise(ends.tolist()):
        during = (sampled >= times[first]) & (sampled <= times[last])
        part = slice(first, last + 1)
        spline = _spline(times[part], places[part], from_rest=first - 1 in rests, to_rest=last in rests)
        curve[during] = places[first] if first in rests else spline(sampled[during])
    return Path(times=sampled, places=curve)


def _spline(
    parameter: np.ndarray, places: np.ndarray, *, from_rest: bool = False, to_rest: bool = False
) -> CubicSpline:
    """A cubic spline, natural at its ends or still there; a natural one through two places is straight.

    Still before and after a stop: else it would swing through the place and come back to it.
    """
    ends = [(1 if at_rest else 2, np.zeros(2)) for at_rest in (from_rest, to_rest)]
    return CubicSpline(parameter, places, bc_type=tuple(ends))
