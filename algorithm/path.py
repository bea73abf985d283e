"""Step 7 of the default: the smoothest path that the points of a motion allow, hidden frames included.

What is known of a motion in a frame is how its points went on to the next one and, where it is well seen, where
their centre is. Displacements alone drift; the centre alone jumps when a part of the body is hidden. The path is
the least-squares answer to both, and where neither is known it has the least acceleration: good continuation.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.linalg import solveh_banded

from algorithm.representative import Curve
from algorithm.segment_frames import SegmentFrames

_FULL_AREA = 90
"""Percentile of a motion's areas that counts as its full area."""
_SEEN_IN_FULL = 0.9
"""From this share of the full area on nothing is hidden: areas change with the pose as well."""
_CENTRE_M = 0.015
_ASTRAY_M = np.array([0.2, 0.2, 1.2])
"""Standard deviation of the centre of what is seen as the body's: in full, and how fast it grows with what is not.
People are slim: who shows his head alone is half a body away upwards, but not sideways. (The last axis is up.)"""
_CENTRE_SECONDS = 0.1
"""Its errors are those of a pose: so long they stay the same."""
_SPEED_M_PER_S = 0.15
"""Standard deviation of the points' mean speed as the body's, metres a second."""
_STEP_AREA = 0.85
"""Below this share of the full area the mean displacement counts less."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """What is known of one motion in each frame from its first to its last; weights are inverse variances."""

    first: int
    points: Float[np.ndarray, "moment"]
    centre: Float[np.ndarray, "moment 3"]
    centre_weight: Float[np.ndarray, "moment 3"]
    step: Float[np.ndarray, "moment 3"]
    """Displacement to the next moment."""
    step_weight: Float[np.ndarray, "moment"]
    """0 at the last moment."""


def path(rows: SegmentFrames, *, fps: float, restlessness: float) -> Curve:
    """The path of the rows, all of one motion, from its first frame to its last.

    It minimises the squares of three misses, each over its variance: of the displacements between frames (0.15 m/s),
    of the centre of what is seen (1.5 cm where all is seen, up to 45 cm for a sliver), and of zero acceleration, as
    white noise of `restlessness` (m^2 / s^3).
    """
    known = evidence(rows, full_area=full_area(rows), fps=fps)
    position, _ = smoothest(known, fps=fps, restlessness=restlessness)
    return Curve(first=known.first, position=position, points=known.points)


def astray_m(share: Float[np.ndarray, "row"]) -> Float[np.ndarray, "row 3"]:
    """Standard deviation of the centre of what is seen as the body's, metres, by the share of it that is seen."""
    return _CENTRE_M + _ASTRAY_M * np.maximum(_SEEN_IN_FULL - share, 0.0)[:, None]


def full_area(rows: SegmentFrames) -> float:
    """The area that a motion shows when nothing hides it."""
    return float(np.percentile(rows.area, _FULL_AREA))


def evidence(rows: SegmentFrames, *, full_area: float, fps: float) -> Evidence:
    """What the rows, all of one motion, say of its path."""
    first, last = int(rows.frame[0]), int(rows.frame[-1])
    count = last - first + 1
    moment = rows.frame - first
    share = np.minimum(rows.area / full_area, 1.0)
    points, centre, centre_weight = np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3))
    points[moment] = rows.points
    centre[moment] = rows.centre
    centre_weight[moment] = 1.0 / (astray_m(share) ** 2 * max(_CENTRE_SECONDS * fps, 1.0))
    step, step_weight = np.zeros((count, 3)), np.zeros(count)
    known = (rows.followed > 0) & (rows.frame < last)
    step[moment[known]] = rows.step[known]
    step_weight[moment[known]] = np.minimum(share[known] / _STEP_AREA, 1.0) * (fps / _SPEED_M_PER_S) ** 2
    return Evidence(
        first=first, points=points, centre=centre, centre_weight=centre_weight, step=step, step_weight=step_weight
    )


def smoothest(known: Evidence, *, fps: float, restlessness: float) -> tuple[Float[np.ndarray, "moment 3"], float]:
    """The places that minimise the weighted squares, and their sum.

    The places x minimise sum w (x - c)^2 + sum v (x' - x - s)^2 + sum b (x'' - 2 x' + x)^2: a system of five bands
    for every axis.
    """
    heavy = known.step_weight[:-1]
    bend = np.full(max(len(heavy) - 1, 0), fps**3 / restlessness)
    bands = np.zeros((3, len(heavy) + 1))  # Upper diagonals, as SciPy stores them.
    bands[2, 1:] += heavy
    bands[2, :-1] += heavy
    bands[1, 1:] -= heavy
    right = known.centre_weight * known.centre
    right[1:] += heavy[:, None] * known.step[:-1]
    right[:-1] -= heavy[:, None] * known.step[:-1]
    if len(bend):
        bands[2, :-2] += bend
        bands[2, 1:-1] += 4.0 * bend
        bands[2, 2:] += bend
        bands[1, 1:-1] -= 2.0 * bend
        bands[1, 2:] -= 2.0 * bend
        bands[0, 2:] += bend
    place = np.stack([_solved(bands, known.centre_weight[:, axis], right[:, axis]) for axis in range(3)], axis=1)
    missed = (
        np.sum(known.centre_weight * (place - known.centre) ** 2)
        + np.sum(heavy[:, None] * (np.diff(place, axis=0) - known.step[:-1]) ** 2)
        + np.sum(bend[:, None] * np.diff(place, 2, axis=0) ** 2)
    )
    return place, float(missed)


def _solved(
    bands: Float[np.ndarray, "3 moment"], diagonal: Float[np.ndarray, "moment"], right: Float[np.ndarray, "moment"]
) -> Float[np.ndarray, "moment"]:
    """The solution of the symmetric system of five bands with something added to its diagonal."""
    used = min(3, len(diagonal))
    whole = bands[3 - used :].copy()
    whole[-1] += diagonal
    return np.asarray(solveh_banded(whole, right))
