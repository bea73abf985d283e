"""How the points of a motion swing about its representative: the gait of somebody who walks.

Without its swing a body is rigid, so all else treats it as such: places are taken into axes that go with it, the
swing is taken out of them (`Gait.calmed`), they are completed, and the swing is put back (`Gait.restored`).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.ndimage import gaussian_filter1d

from algorithm.body_axes import body_axes
from algorithm.orbits import (
    Orbits,
    fitted_prior,
    harmonics,
    moments_of,
    orbits_by_examples,
    orbits_by_prior,
)
from algorithm.period import period_frames
from algorithm.representative import Curve
from algorithm.steadied import steadied
from algorithm.trajectories import Trajectories

_EXAMPLES = 400
"""Trajectories that the gait is learned from, the longest likeliest."""
_FEWEST = 60
"""With fewer nothing can be learned."""
_CORRECTIONS = 2
"""How often the representative is corrected by what the points' orbits leave over."""
_CORRECTED_OVER_SECONDS = 0.12
_CHUNK = 200_000
"""Places at a time: bounds the memory."""
_DOUBT = 20.0
"""A frame's correction is halved where only so many examples speak for it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Gait:
    """The swing of every trajectory of a motion."""

    period_frames: float
    axes: Float[np.ndarray, "moment 3 3"]
    """Rotations world_from_body."""
    carrier: Curve
    """The representative, without what it swings itself."""
    orbits: Orbits
    """In body axes about the carrier, a trajectory each."""

    def swing(
        self, trajectory: Int[np.ndarray, "place"], frame: Int[np.ndarray, "place"]
    ) -> Float[np.ndarray, "place 3"]:
        """How far the trajectories' points are from their mean places, body axes, metres."""
        swing = np.empty((len(frame), 3))
        for begin in range(0, len(frame), _CHUNK):
            rows = slice(begin, begin + _CHUNK)
            basis = harmonics(frame[rows], period_frames=self.period_frames)[:, 1:]
            swing[rows] = np.einsum("ph,phx->px", basis, self.orbits[trajectory[rows], 1:])
        return swing

    def calmed(self, trajectories: Trajectories) -> Trajectories:
        """The trajectories in body axes about the carrier, without their swing: a rigid body that stands still."""
        place = _in_body(trajectories, self.carrier, self.axes)
        calm = place - self.swing(trajectories.trajectory, trajectories.frame)
        return Trajectories(
            trajectory=trajectories.trajectory,
            frame=trajectories.frame,
            position=calm,
            column_row=trajectories.column_row,
        )

    def restored(
        self, place: Float[np.ndarray, "place 3"], frame: Int[np.ndarray, "place"]
    ) -> Float[np.ndarray, "place 3"]:
        """Places in body axes, swing included, in world axes; metres."""
        world = np.empty_like(place)
        for begin in range(0, len(place), _CHUNK):
            rows = slice(begin, begin + _CHUNK)
            moment = frame[rows] - self.carrier.first
            world[rows] = self.carrier.position[moment] + np.einsum("pij,pj->pi", self.axes[moment], place[rows])
        return world


def found_gait(trajectories: Trajectories, curve: Curve, *, fps: float, spacing_m: float) -> Gait | None:
    """The gait of a motion; None where it has none, or shows too little of it.

    Learned of the motion itself and of nothing else: the period (`period`), how the orbits of its points are
    distributed (`orbits.fitted_prior`), the orbits of a few hundred of them, each with the help of the others,
    and by these the orbit of every point. What is left over and common to all points of a frame is an error of the
    representative, and is taken off it; where little is seen the path is drawn anew.
    """
    if trajectories.count < _FEWEST:
        return None
    axes = body_axes(curve, fps=fps)
    place = _in_body(trajectories, curve, axes)
    period = period_frames(trajectories, place, fps=fps)
    if period is None:
        return None
    few = _examples(trajectories)
    carrier = curve
    for corrections_left in range(_CORRECTIONS, -1, -1):
        place = _in_body(few, carrier, axes)
        shown = moments_of(place, few.frame, few.first_row, period_frames=period)
        prior = fitted_prior(shown, least_noise_m=spacing_m)
        weight = shown.length**2
        examples = orbits_by_examples(shown, orbits_by_prior(shown, prior), weight, prior, themselves=True)
        if corrections_left:
            carrier = _corrected(carrier, axes, (few, place), examples, (period, fps))
    place = _in_body(trajectories, carrier, axes)
    known = moments_of(place, trajectories.frame, trajectories.first_row, period_frames=period)
    orbits = orbits_by_examples(known, examples, weight, prior)
    return Gait(period_frames=period, axes=axes, carrier=steadied(carrier, fps=fps), orbits=orbits)


def _in_body(trajectories: Trajectories, curve: Curve, axes: np.ndarray) -> Float[np.ndarray, "observation 3"]:
    """The trajectories' places about the curve in body axes, metres."""
    place = np.empty_like(trajectories.position)
    for begin in range(0, len(place), _CHUNK):
        rows = slice(begin, begin + _CHUNK)
        moment = trajectories.frame[rows] - curve.first
        away = trajectories.position[rows] - curve.position[moment]
        place[rows] = np.einsum("pji,pj->pi", axes[moment], away)
    return place


def _examples(trajectories: Trajectories) -> Trajectories:
    """Trajectories evenly spread over all observations: the longer one is, the likelier it is among them."""
    total = np.cumsum(trajectories.length)
    sought = (np.arange(_EXAMPLES) + 0.5) / _EXAMPLES * total[-1]
    chosen = np.zeros(trajectories.count, bool)
    chosen[np.searchsorted(total, sought)] = True
    return trajectories.chosen(chosen)


def _corrected(
    curve: Curve,
    axes: np.ndarray,
    seen: tuple[Trajectories, np.ndarray],
    examples: Orbits,
    timing: tuple[float, float],
) -> Curve:
    """The curve moved by what the examples' orbits leave over, smoothed, as far as there are examples."""
    trajectories, place = seen
    period, fps = timing
    moment = trajectories.frame - curve.first
    basis = harmonics(trajectories.frame, period_frames=period)
    left = place - np.einsum("ph,phx->px", basis, examples[trajectories.trajectory])
    size = len(curve.position)
    count = np.bincount(moment, minlength=size).astype(float)
    total = np.stack([np.bincount(moment, left[:, axis], size) for axis in range(3)], axis=1)
    sigma = _CORRECTED_OVER_SECONDS * fps
    near = gaussian_filter1d(count, sigma, mode="constant")
    offset = gaussian_filter1d(total, sigma, axis=0, mode="constant") / (near + _DOUBT)[:, None]
    seen_moments = np.flatnonzero(count > 0)
    offset = np.stack([np.interp(np.arange(size), seen_moments, offset[seen_moments, axis]) for axis in range(3)], 1)
    moved = curve.position + np.einsum("mij,mj->mi", axes, offset)
    return Curve(first=curve.first, position=moved, points=curve.points)
