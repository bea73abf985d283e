"""The periodic motions of many points that are parts of one body, learned from all of them together.

A point's orbit is a constant and a few harmonics of the motion's period. Most points are seen for less than a
cycle, which leaves their orbits open; what closes them is that points of one body swing alike.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from algorithm.compiled import compiled

HARMONICS = 3
_ROUNDS = 8
"""Rounds of expectation and maximisation: more change nothing."""
_START_M = 0.1
"""The first guess of how far points swing, of the extent of the motion's points."""
_LIKE = 0.12
"""Orbits that differ by this share of the extent are still somewhat like one another."""
_OWN_SHARE = 0.05
"""Share of the variance over the whole body that neighbours have among themselves."""
_CHUNK = 5_000
"""Trajectories at a time: bounds the memory."""

Orbits = Float[np.ndarray, "trajectory harmonic 3"]
"""Coefficients: the constant, then cosine and sine of each harmonic; metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Moments:
    """All that the fit of an orbit needs to know of each trajectory: sums over its frames."""

    gram: Float[np.ndarray, "trajectory harmonic harmonic"]
    """Of the harmonics with each other."""
    cross: Float[np.ndarray, "trajectory harmonic 3"]
    """Of the harmonics with the places."""
    square: Float[np.ndarray, "trajectory"]
    """Of the squared places."""
    length: Float[np.ndarray, "trajectory"]
    """Frames."""

    def chosen(self, which: Int[np.ndarray, "chosen"] | slice) -> "Moments":
        """Those of some trajectories."""
        return Moments(
            gram=self.gram[which], cross=self.cross[which], square=self.square[which], length=self.length[which]
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Prior:
    """How the orbits of a body's points are distributed: normally, all coefficients with one another."""

    mean: Float[np.ndarray, "coefficient"]
    covariance: Float[np.ndarray, "coefficient coefficient"]
    noise_m: float
    """Standard deviation of places from their orbits, metres along each axis."""


def harmonics(frame: Int[np.ndarray, "moment"], *, period_frames: float) -> Float[np.ndarray, "moment harmonic"]:
    """1, cos, sin, cos 2, sin 2 ... of the phase at the frames."""
    first = int(frame.min()) if len(frame) else 0
    last = int(frame.max()) if len(frame) else 0
    phase = 2 * np.pi / period_frames * np.arange(first, last + 1)  # Many moments share a frame.
    waves = [wave(number * phase) for number in range(1, HARMONICS + 1) for wave in (np.cos, np.sin)]
    return np.asarray(np.stack([np.ones(len(phase)), *waves], axis=1)[frame - first])


def moments_of(
    place: Float[np.ndarray, "observation 3"],
    frame: Int[np.ndarray, "observation"],
    first_row: Int[np.ndarray, "trajectory"],
    *,
    period_frames: float,
) -> Moments:
    """The sums over each trajectory; it begins at its first row and ends before the next one's."""
    length = np.diff(np.append(first_row, len(place)))
    first = int(frame.min()) if len(frame) else 0
    last = int(frame.max()) if len(frame) else 0
    basis = harmonics(np.arange(first, last + 1), period_frames=period_frames)
    gram, cross, square = _sums(first_row, length, basis, frame - first, place)
    return Moments(gram=gram, cross=cross, square=square, length=length.astype(float))


@compiled
def _sums(
    first_row: np.ndarray, length: np.ndarray, basis: np.ndarray, moment: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # pragma: no cover
    """Of each trajectory the sums of the harmonics' products with each other and the places, and of squared places."""
    count, width = len(first_row), basis.shape[1]
    gram, cross, square = np.zeros((count, width, width)), np.zeros((count, width, 3)), np.zeros(count)
    for trajectory in range(count):
        for row in range(first_row[trajectory], first_row[trajectory] + length[trajectory]):
            wave = basis[moment[row]]
            for one in range(width):
                for other in range(one + 1):
                    gram[trajectory, one, other] += wave[one] * wave[other]
                for axis in range(3):
                    cross[trajectory, one, axis] += wave[one] * place[row, axis]
            for axis in range(3):
                square[trajectory] += place[row, axis] ** 2
        for one in range(width):
            for other in range(one):
                gram[trajectory, other, one] = gram[trajectory, one, other]
    return gram, cross, square


def fitted_prior(known: Moments, *, least_noise_m: float) -> Prior:
    """How orbits are distributed, by expectation and maximisation [Dempster, Laird, Rubin, JRSS B 1977].

    Each trajectory is linear in its orbit's coefficients, which are random effects with a normal distribution
    [Laird, Ware, Biometrics 1982]. Since it has all covariances, a few frames of a swinging foot tell the rest
    of its cycle. The noise is never below `least_noise_m`: errors of neighbouring frames are alike.
    """
    width = known.gram.shape[1]
    centre = known.cross[:, 0].sum(axis=0) / known.length.sum()
    extent = float(np.sqrt(max(known.square.sum() / known.length.sum() - centre @ centre, least_noise_m**2)))
    mean = np.concatenate([centre, np.zeros(3 * width - 3)])
    scale = np.concatenate([np.full(3, extent), np.full(3 * width - 3, _START_M * extent)])
    prior = Prior(mean=mean, covariance=np.diag(scale**2), noise_m=2 * least_noise_m)
    gram = _on_all_axes(known.gram)
    for _ in range(_ROUNDS):
        orbit, variance = _expected(known, gram, prior)
        mean = orbit.mean(axis=0)
        apart = orbit - mean
        covariance = (variance.sum(axis=0) + apart.T @ apart) / len(orbit) + 1e-10 * extent**2 * np.eye(3 * width)
        noise = np.sqrt(_expected_miss(known, gram, (orbit, variance)) / (3 * known.length.sum()))
        prior = Prior(mean=mean, covariance=covariance, noise_m=max(float(noise), least_noise_m))
    return prior


def orbits_by_prior(known: Moments, prior: Prior) -> Orbits:
    """The likeliest orbit of each trajectory, given how orbits are distributed."""
    return _expected(known, _on_all_axes(known.gram), prior)[0].reshape(known.cross.shape)


def orbits_by_examples(
    known: Moments,
    examples: Float[np.ndarray, "example harmonic 3"],
    weight: Float[np.ndarray, "example"],
    prior: Prior,
    *,
    themselves: bool = False,
) -> Orbits:
    """The likeliest orbit of each trajectory, given orbits of points that were seen for longer.

    The examples that pass near the places of a trajectory, each at its frame's phase, tell what to expect of it;
    its own places decide as far as they can. With `themselves` the trajectories are those of the examples, and
    none is its own example.
    """
    width = known.gram.shape[1]
    joint = prior.covariance.reshape(width, 3, width, 3)
    own = _OWN_SHARE * np.einsum("iaja->ij", joint) / 3 + 1e-10 * np.trace(prior.covariance) * np.eye(width)
    like_m2 = _LIKE**2 * float(np.trace(joint[0, :, 0, :]))
    stiffness = np.linalg.inv(own)
    parts = []
    for begin in range(0, len(known.length), _CHUNK):
        part = known.chosen(slice(begin, begin + _CHUNK))
        miss = _squared_misses(part, examples)
        if themselves:
            here = np.arange(len(miss))
            miss[here, begin + here] = np.inf
        near = weight * np.exp(-(miss - miss.min(axis=1, keepdims=True)) / (2 * like_m2))
        near /= near.sum(axis=1, keepdims=True)
        expected = np.einsum("te,ehx->thx", near, examples, optimize=True)
        left = stiffness + part.gram / prior.noise_m**2
        parts.append(np.linalg.solve(left, stiffness @ expected + part.cross / prior.noise_m**2))
    return np.concatenate([np.zeros((0, width, 3)), *parts])


def _squared_misses(
    known: Moments, examples: Float[np.ndarray, "example harmonic 3"]
) -> Float[np.ndarray, "trajectory example"]:
    """The mean squared distance of each trajectory's places from each example, in the same frames; square metres."""
    products = np.einsum("eix,ejx->eij", examples, examples).reshape(len(examples), -1)
    total = known.square[:, None] + known.gram.reshape(len(known.gram), -1) @ products.T
    total -= 2 * known.cross.reshape(len(known.cross), -1) @ examples.reshape(len(examples), -1).T
    return np.maximum(total / known.length[:, None], 0.0)


def _expected(
    known: Moments, gram: Float[np.ndarray, "trajectory coefficient coefficient"], prior: Prior
) -> tuple[Float[np.ndarray, "trajectory coefficient"], Float[np.ndarray, "trajectory coefficient coefficient"]]:
    """Mean and covariance of each trajectory's coefficients."""
    inverse = np.linalg.inv(prior.covariance)
    variance = np.linalg.inv(inverse + gram / prior.noise_m**2)
    right = inverse @ prior.mean + known.cross.reshape(len(known.cross), -1) / prior.noise_m**2
    return np.einsum("tij,tj->ti", variance, right), variance


def _expected_miss(
    known: Moments,
    gram: Float[np.ndarray, "trajectory coefficient coefficient"],
    expected: tuple[np.ndarray, np.ndarray],
) -> float:
    """The sum of the squared distances of all places from their orbits, as uncertain as these are."""
    orbit, variance = expected
    flat = known.cross.reshape(len(known.cross), -1)
    own = known.square - 2 * (orbit * flat).sum(axis=1) + np.einsum("ti,tij,tj->t", orbit, gram, orbit, optimize=True)
    return float(own.sum() + np.einsum("tij,tij->", gram, variance))


def _on_all_axes(gram: Float[np.ndarray, "trajectory harmonic harmonic"]) -> np.ndarray:
    """The sums of products for coefficients in the order harmonic, axis."""
    count, width, _ = gram.shape
    return np.einsum("tij,ab->tiajb", gram, np.eye(3)).reshape(count, 3 * width, 3 * width)
