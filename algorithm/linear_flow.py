"""One step of a variational flow: its robust energy as parabolas about the present flow, and their minimum."""

import numpy as np
from jaxtyping import Float32, Float64

from algorithm.compiled import compiled

_POWER, _ROUNDING = 0.45, 1e-6
"""The robust penalty is (x^2 + rounding)^power, a slightly non-convex Charbonnier."""
_RELAXATION = 1.9


def flow_step(
    flow: Float32[np.ndarray, "row column 2"],
    slopes: Float32[np.ndarray, "row column 3"],
    *,
    smoothness: float,
    quadratic: float,
    sweeps: int = 40,
) -> Float32[np.ndarray, "row column 2"]:
    """The increment of the flow that minimises the energy with its penalties replaced by parabolas.

    The energy is the sum over the pixels of penalty(I_t + I_x du + I_y dv), plus `smoothness` times the sum of
    the penalties of all differences of u, and of v, between pixels side by side. `slopes` holds I_x, I_y and
    I_t; a pixel without data has zeros. A penalty is `quadratic` parts x^2, the rest robust.

    The linear system is solved by successive over-relaxation: with 200 sweeps in place of 40 the error on
    Middlebury's photographs changes by less than 1 %, and steps are filtered afterwards.
    """
    height, width = flow.shape[:2]
    across = np.zeros((height, width + 1, 2), np.float32)  # What holds each pixel to the one on its left;
    down = np.zeros((height + 1, width, 2), np.float32)  # ... to the one above it; nothing at the borders.
    pull = np.zeros_like(flow)
    for axis, link in ((1, across[:, 1:-1]), (0, down[1:-1])):
        difference = np.diff(flow, axis=axis)
        link[:] = smoothness * _parabola(difference, quadratic)
        padding = [(1, 1) if side == axis else (0, 0) for side in range(3)]
        pull += np.diff(np.pad(link * difference, padding), axis=axis)
    held = across[:, 1:] + across[:, :-1] + down[1:] + down[:-1] + np.float32(1e-9)  # A single pixel is free.
    # The matrix of a pixel is nearly singular, its large part a million times the small one: double precision.
    slope, later = slopes[..., :2].astype(np.float64), slopes[..., 2:]
    weight = _parabola(later, quadratic)
    inverse = _inverses(weight * slope**2 + held, weight[..., 0] * slope[..., 0] * slope[..., 1])
    step = np.zeros((height + 2, width + 2, 2))
    _relax(step, pull - weight * slope * later, inverse, (across, down), sweeps)
    return step[1:-1, 1:-1].astype(np.float32)


def _parabola(x: Float32[np.ndarray, "*any"], quadratic: float) -> Float32[np.ndarray, "*any"]:
    """How steep the parabola is that touches the penalty at x: half its derivative, over x."""
    if quadratic == 1:
        return np.ones_like(x)
    robust = _POWER * (x * x + _ROUNDING) ** (_POWER - 1)
    return quadratic + (1 - quadratic) * robust


def _inverses(
    diagonal: Float64[np.ndarray, "row column 2"], coupling: Float64[np.ndarray, "row column"]
) -> Float64[np.ndarray, "row column 3"]:
    """The inverses (uu, uv, vv) of symmetric 2x2 matrices."""
    determinant = diagonal[..., 0] * diagonal[..., 1] - coupling**2
    return np.stack([diagonal[..., 1], -coupling, diagonal[..., 0]], axis=-1) / determinant[..., None]


@compiled
def _relax(
    step: np.ndarray, right: np.ndarray, inverse: np.ndarray, links: tuple[np.ndarray, np.ndarray], sweeps: int
) -> None:
    """Sweeps of successive over-relaxation, in place, both components of a pixel at once; `step` has a border."""
    across, down = links
    for _ in range(sweeps):
        for i in range(right.shape[0]):
            for j in range(right.shape[1]):
                u = (
                    right[i, j, 0]
                    + across[i, j, 0] * step[i + 1, j, 0]
                    + across[i, j + 1, 0] * step[i + 1, j + 2, 0]
                    + down[i, j, 0] * step[i, j + 1, 0]
                    + down[i + 1, j, 0] * step[i + 2, j + 1, 0]
                )
                v = (
                    right[i, j, 1]
                    + across[i, j, 1] * step[i + 1, j, 1]
                    + across[i, j + 1, 1] * step[i + 1, j + 2, 1]
                    + down[i, j, 1] * step[i, j + 1, 1]
                    + down[i + 1, j, 1] * step[i + 2, j + 1, 1]
                )
                new_u = inverse[i, j, 0] * u + inverse[i, j, 1] * v
                new_v = inverse[i, j, 1] * u + inverse[i, j, 2] * v
                step[i + 1, j + 1, 0] += _RELAXATION * (new_u - step[i + 1, j + 1, 0])
                step[i + 1, j + 1, 1] += _RELAXATION * (new_v - step[i + 1, j + 1, 1])
