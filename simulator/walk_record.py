"""Walks as a scene has them: way-points and when each is passed."""

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

KNOT_S = 0.2
"""Between two way-points, about."""
RUN_OUT_S = 1.5
"""How much longer than the scene a track has to be: who comes to the end of a path slows down before it."""
_DIGITS = 4  # A tenth of a millimetre: the resolved scene stays readable.
_STILL_M = 0.001  # Who gets no farther stands.

Waypoints = tuple[tuple[float, float], ...]
Times = tuple[float, ...]


def walk_record(track: Float[np.ndarray, "time 2"], *, step_s: float, begin_s: float = 0.0) -> tuple[Waypoints, Times]:
    """A `Person`'s `waypoints` (metres) and `times` (seconds) of a track sampled every `step_s` from `begin_s`.

    The path through them passes every sample within 2 cm, if the track is one that somebody walks. A track has two
    samples at least.
    """
    sampled = begin_s + step_s * np.arange(len(track))
    knots = even_knots(sampled[0], sampled[-1])
    return recorded(knots, CubicSpline(sampled, track, bc_type="natural")(knots))


def even_knots(begin_s: float, end_s: float) -> Float[np.ndarray, "knot"]:
    """Times from the first to the last, about `KNOT_S` apart, seconds."""
    return np.linspace(begin_s, end_s, max(2, round(float(end_s - begin_s) / KNOT_S) + 1))


def recorded(knots: Float[np.ndarray, "knot"], places: Float[np.ndarray, "knot 2"]) -> tuple[Waypoints, Times]:
    """The places as `waypoints` and the knots as `times`, rounded; who stands has equal way-points, as a path wants."""
    held = places[0]
    waypoints = []
    for place in places:
        held = held if np.linalg.norm(place - held) < _STILL_M else place
        waypoints.append((round(float(held[0]), _DIGITS), round(float(held[1]), _DIGITS)))
    return tuple(waypoints), tuple(round(float(knot), _DIGITS) for knot in knots)
