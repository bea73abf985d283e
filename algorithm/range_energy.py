"""The energy of range flow and its minimum: loops over the moving pixels, compiled.

Everywhere `flow` and `step` hold (u, v, w) of every pixel: columns and rows in pixels, depth in units of 2 cm.
"""

import math
from typing import NamedTuple

import numpy as np

from algorithm.compiled import compiled
from algorithm.sampling import on_surface

UNITS_PER_M = 50.0
"""Depth is counted in units of 2 cm, which weigh as much as a pixel in the picture."""
_SILENT = 0.1
"""Noise below it makes no difference, units of 2 cm."""
_WARPS, _REWEIGHTINGS, _SWEEPS, _RELAXATION = 8, 3, 15, 1.9
_LARGEST_STEP = 1.0, 1.0, 2.5
"""Of (u, v, w) in one warp: beyond it the slopes mean nothing."""
_IMAGE_WEIGHT, _IMAGE_SCALE, _GRADIENT_FLOOR = 1.0, 0.3, 0.01
_SMOOTHNESS, _SMOOTH_SCALE = 2.0, 0.05
_RANGE_REACH_M, _SLOPE_REACH_M = 0.12, 0.08


class Firmness(NamedTuple):
    """How far depth can be trusted."""

    range_weight: float
    """Weight of the range term; the image term's is 1."""
    range_scale: float
    """Residuals of the range term above this count as outliers, units of 2 cm."""
    crease_m: float
    """Neighbours whose depths differ by this hold each other much less, metres."""
    edge_m: float
    """Neighbours whose depths differ by more do not hold each other, metres."""


def firmness(noise_m: float) -> Firmness:
    """What to expect of surfaces whose depth has noise of this standard deviation.

    The range term loses weight with the square of the noise, as likelihood has it; up to some millimetres the
    curvature of limbs looks no different.
    """
    noise = max(UNITS_PER_M * noise_m, _SILENT)
    beyond_m = max(noise_m - 0.005, 0.0)
    return Firmness(
        range_weight=5.0 * min(1.0, (0.15 / noise) ** 2),
        range_scale=noise,
        crease_m=0.1 + 8 * beyond_m,
        edge_m=0.2 + 12 * beyond_m,
    )


@compiled
def minimise(
    images: tuple[np.ndarray, np.ndarray],
    surfaces: tuple[np.ndarray, np.ndarray],
    pixels: np.ndarray,
    flow: np.ndarray,
    firm: Firmness,
) -> None:
    """Bring the flow of the pixels, in place, to a minimum of the energy."""
    neighbours, hold = _same_surface(surfaces[0], pixels, firm)
    for _ in range(_WARPS):
        terms = _linearised(images, surfaces, pixels, flow)
        step = np.zeros(flow.shape)
        for _ in range(_REWEIGHTINGS):
            matrix, right = _normal_equations(terms, step, firm)
            robust = _robust_hold(neighbours, hold, flow + step)
            _relax(matrix, right, neighbours, robust, flow, step)
        for k in range(len(flow)):
            for c in range(3):
                flow[k, c] += min(max(step[k, c], -_LARGEST_STEP[c]), _LARGEST_STEP[c])


@compiled
def _same_surface(surface: np.ndarray, pixels: np.ndarray, firm: Firmness) -> tuple[np.ndarray, np.ndarray]:
    """The four neighbours of every pixel, -1 where the surface ends, and how firmly each holds it."""
    number = np.full(surface.shape, -1)
    for k in range(len(pixels)):
        number[pixels[k, 0], pixels[k, 1]] = k
    neighbours, hold = np.full((len(pixels), 4), -1), np.zeros((len(pixels), 4))
    for k in range(len(pixels)):
        for side, (down, right) in enumerate(((0, 1), (0, -1), (1, 0), (-1, 0))):
            row, column = pixels[k, 0] + down, pixels[k, 1] + right
            if row < 0 or column < 0 or row >= surface.shape[0] or column >= surface.shape[1]:
                continue
            jump = abs(surface[row, column] - surface[pixels[k, 0], pixels[k, 1]])
            if number[row, column] >= 0 and jump <= firm.edge_m:
                neighbours[k, side] = number[row, column]
                hold[k, side] = _SMOOTHNESS * math.exp(-((jump / firm.crease_m) ** 2))
    return neighbours, hold


@compiled
def _linearised(
    images: tuple[np.ndarray, np.ndarray],
    surfaces: tuple[np.ndarray, np.ndarray],
    pixels: np.ndarray,
    flow: np.ndarray,
) -> np.ndarray:
    """Residual, slope along u and slope along v, of the image term and of the range term, at the present flow.

    NaN where the range term says nothing: no return of the surface around the target.
    """
    terms = np.empty((len(pixels), 2, 3))
    image, surface = images[1], surfaces[1]
    for k in range(len(pixels)):
        row, column = pixels[k, 0] + flow[k, 1], pixels[k, 1] + flow[k, 0]
        terms[k, 0, 0] = _between(image, row, column) - images[0][pixels[k, 0], pixels[k, 1]]
        terms[k, 0, 1] = _between(image, row, column + 0.5) - _between(image, row, column - 0.5)
        terms[k, 0, 2] = _between(image, row + 0.5, column) - _between(image, row - 0.5, column)
        depth = surfaces[0][pixels[k, 0], pixels[k, 1]]
        met = on_surface(surface, surface, (row, column), depth + flow[k, 2] / UNITS_PER_M, _RANGE_REACH_M)
        right = on_surface(surface, surface, (row, column + 1), met, _SLOPE_REACH_M)
        left = on_surface(surface, surface, (row, column - 1), met, _SLOPE_REACH_M)
        below = on_surface(surface, surface, (row + 1, column), met, _SLOPE_REACH_M)
        above = on_surface(surface, surface, (row - 1, column), met, _SLOPE_REACH_M)
        terms[k, 1, 0] = UNITS_PER_M * (met - depth) - flow[k, 2]
        terms[k, 1, 1] = UNITS_PER_M * (right - left) / 2
        terms[k, 1, 2] = UNITS_PER_M * (below - above) / 2
    return terms


@compiled
def _between(image: np.ndarray, row: float, column: float) -> float:
    """The image between its pixels, bilinear; at the border it goes on as it is."""
    row = min(max(row, 0.0), image.shape[0] - 1.0)
    column = min(max(column, 0.0), image.shape[1] - 1.0)
    i, j = min(int(row), image.shape[0] - 2), min(int(column), image.shape[1] - 2)
    down, right = row - i, column - j
    upper = (1 - right) * image[i, j] + right * image[i, j + 1]
    lower = (1 - right) * image[i + 1, j] + right * image[i + 1, j + 1]
    return (1 - down) * upper + down * lower


@compiled
def _normal_equations(terms: np.ndarray, step: np.ndarray, firm: Firmness) -> tuple[np.ndarray, np.ndarray]:
    """The data terms' symmetric matrix (uu, uv, vv, uw, vw, ww) and right side, reweighted at the present step."""
    matrix, right = np.zeros((len(terms), 6)), np.zeros((len(terms), 3))
    for k in range(len(terms)):
        residual, along_u, along_v = terms[k, 0]
        norm = along_u**2 + along_v**2 + _GRADIENT_FLOOR
        now = residual + along_u * step[k, 0] + along_v * step[k, 1]
        weight = _IMAGE_WEIGHT / norm / math.sqrt(now**2 / norm + _IMAGE_SCALE**2)
        _add(matrix[k], right[k], weight, (residual, along_u, along_v, 0.0))
        residual, along_u, along_v = terms[k, 1]
        now = residual + along_u * step[k, 0] + along_v * step[k, 1] - step[k, 2]
        if not math.isnan(now):
            weight = firm.range_weight / math.sqrt(now**2 + firm.range_scale**2)
            _add(matrix[k], right[k], weight, (residual, along_u, along_v, -1.0))
    return matrix, right


@compiled
def _add(matrix: np.ndarray, right: np.ndarray, weight: float, term: tuple[float, float, float, float]) -> None:
    """Add weight (residual + term . step)^2 to a pixel's equations."""
    residual, u, v, w = term
    matrix[0] += weight * u * u
    matrix[1] += weight * u * v
    matrix[2] += weight * v * v
    matrix[3] += weight * u * w
    matrix[4] += weight * v * w
    matrix[5] += weight * w * w
    right[0] -= weight * u * residual
    right[1] -= weight * v * residual
    right[2] -= weight * w * residual


@compiled
def _robust_hold(neighbours: np.ndarray, hold: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """How firmly each neighbour holds a pixel: less, the more their flows differ."""
    robust = np.zeros(hold.shape)
    for k in range(len(flow)):
        for side in range(4):
            other = neighbours[k, side]
            if other >= 0:
                square = _SMOOTH_SCALE**2
                for c in range(3):
                    square += (flow[k, c] - flow[other, c]) ** 2
                robust[k, side] = hold[k, side] / math.sqrt(square)
    return robust


@compiled
def _relax(
    matrix: np.ndarray,
    right: np.ndarray,
    neighbours: np.ndarray,
    hold: np.ndarray,
    flow: np.ndarray,
    step: np.ndarray,
) -> None:
    """Bring the step, in place, near to the minimum of the quadratic energy."""
    for _ in range(_SWEEPS):
        for k in range(len(flow)):
            firm, pull_u, pull_v, pull_w = 1e-6, 0.0, 0.0, 0.0
            for side in range(4):
                other = neighbours[k, side]
                if other >= 0:
                    q = hold[k, side]
                    firm += q
                    pull_u += q * (flow[other, 0] + step[other, 0] - flow[k, 0])
                    pull_v += q * (flow[other, 1] + step[other, 1] - flow[k, 1])
                    pull_w += q * (flow[other, 2] + step[other, 2] - flow[k, 2])
            uu, uv, vv, uw, vw, ww = matrix[k]
            best = (right[k, 0] + pull_u - uv * step[k, 1] - uw * step[k, 2]) / (uu + firm)
            step[k, 0] += _RELAXATION * (best - step[k, 0])
            best = (right[k, 1] + pull_v - uv * step[k, 0] - vw * step[k, 2]) / (vv + firm)
            step[k, 1] += _RELAXATION * (best - step[k, 1])
            best = (right[k, 2] + pull_w - uw * step[k, 0] - vw * step[k, 1]) / (ww + firm)
            step[k, 2] += _RELAXATION * (best - step[k, 2])
