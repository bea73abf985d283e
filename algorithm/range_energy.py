"""The energy of range flow and its minimum: loops over the moving pixels, compiled.

Everywhere `flow` holds (u, v, w) of every pixel: columns and rows in pixels, depth in units of 2 cm. An `aspect` of an
image is one of the values that must stay the same from frame to frame: its brightness and its slopes.
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
_AT_REST = 0.03
"""A pixel whose flow changed by less in a warp, as its neighbours' did, is left alone from then on."""
_LARGEST_STEP = 1.0, 1.0, 2.5
"""Of (u, v, w) in one warp: beyond it the slopes mean nothing."""
_ASPECT_WEIGHT, _ASPECT_SCALE, _GRADIENT_FLOOR = 0.5, 0.3, 0.01
_SMOOTHNESS, _SMOOTH_SCALE = 2.0, 0.05
_RANGE_REACH_M, _SLOPE_REACH_M = 0.12, 0.08


class Firmness(NamedTuple):
    """How far depth can be trusted."""

    range_weight: float
    """Weight of the range term; an image term's is one half."""
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
    aspects: tuple[np.ndarray, np.ndarray],
    surfaces: tuple[np.ndarray, np.ndarray],
    pixels: np.ndarray,
    flow: np.ndarray,
    firm: Firmness,
) -> None:
    """Bring the flow of the pixels, in place, to a minimum of the energy.

    `aspects` (row, column, aspect) of both images come with their slopes, as `View.aspects` has them. Pixels whose
    flow has come to rest are not worked on any more: what is left to do shrinks from warp to warp.
    """
    neighbours, hold = _same_surface(surfaces[0], pixels, firm)
    active = np.arange(len(pixels))
    for _ in range(_WARPS):
        terms = _linearised(aspects, surfaces, pixels, active, flow)
        warped = flow.copy()
        for _ in range(_REWEIGHTINGS):
            matrix, right = _normal_equations(terms, active, warped, flow, firm)
            robust = _robust_hold(neighbours, hold, active, flow)
            _relax(matrix, right, neighbours, robust, active, flow)
        active = _still_moving(neighbours, active, warped, flow)
        if not len(active):
            break


@compiled
def _same_surface(surface: np.ndarray, pixels: np.ndarray, firm: Firmness) -> tuple[np.ndarray, np.ndarray]:
    """The four neighbours of every pixel, itself where the surface ends, and how firmly each holds it."""
    number = np.full(surface.shape, -1)
    for k in range(len(pixels)):
        number[pixels[k, 0], pixels[k, 1]] = k
    neighbours, hold = np.empty((len(pixels), 4), np.int64), np.zeros((len(pixels), 4))
    for k in range(len(pixels)):
        for side, (down, right) in enumerate(((0, 1), (0, -1), (1, 0), (-1, 0))):
            neighbours[k, side] = k
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
    aspects: tuple[np.ndarray, np.ndarray],
    surfaces: tuple[np.ndarray, np.ndarray],
    pixels: np.ndarray,
    active: np.ndarray,
    flow: np.ndarray,
) -> np.ndarray:
    """Residual, slope along u and slope along v, of each aspect and last of the range term, at the present flow.

    NaN where the range term says nothing: no return of the surface around the target.
    """
    count = aspects[0].shape[2] // 3
    terms = np.empty((len(active), count + 1, 3))
    for n, k in enumerate(active):
        i, j = pixels[k]
        row, column = i + flow[k, 1], j + flow[k, 0]
        _read(aspects[1], row, column, terms[n])
        for c in range(count):
            terms[n, c, 0] -= aspects[0][i, j, 3 * c]
        depth, surface = surfaces[0][i, j], surfaces[1]
        met = on_surface(surface, surface, (row, column), depth + flow[k, 2] / UNITS_PER_M, _RANGE_REACH_M)
        right = on_surface(surface, surface, (row, column + 1), met, _SLOPE_REACH_M)
        left = on_surface(surface, surface, (row, column - 1), met, _SLOPE_REACH_M)
        below = on_surface(surface, surface, (row + 1, column), met, _SLOPE_REACH_M)
        above = on_surface(surface, surface, (row - 1, column), met, _SLOPE_REACH_M)
        terms[n, count, 0] = UNITS_PER_M * (met - depth) - flow[k, 2]
        terms[n, count, 1] = UNITS_PER_M * (right - left) / 2
        terms[n, count, 2] = UNITS_PER_M * (below - above) / 2
    return terms


@compiled
def _read(aspects: np.ndarray, row: float, column: float, terms: np.ndarray) -> None:
    """Write the aspects and their slopes between the pixels, bilinear; at the border they go on as they are."""
    row = min(max(row, 0.0), aspects.shape[0] - 1.0)
    column = min(max(column, 0.0), aspects.shape[1] - 1.0)
    i, j = min(int(row), max(aspects.shape[0] - 2, 0)), min(int(column), max(aspects.shape[1] - 2, 0))
    below, beside = min(i + 1, aspects.shape[0] - 1), min(j + 1, aspects.shape[1] - 1)
    down, right = row - i, column - j
    for c in range(aspects.shape[2]):
        upper = (1 - right) * aspects[i, j, c] + right * aspects[i, beside, c]
        lower = (1 - right) * aspects[below, j, c] + right * aspects[below, beside, c]
        terms[c // 3, c % 3] = (1 - down) * upper + down * lower


@compiled
def _normal_equations(
    terms: np.ndarray, active: np.ndarray, warped: np.ndarray, flow: np.ndarray, firm: Firmness
) -> tuple[np.ndarray, np.ndarray]:
    """The data terms' symmetric matrix (uu, uv, vv, uw, vw, ww) and right side, reweighted at the present flow."""
    matrix, right = np.zeros((len(active), 6)), np.zeros((len(active), 3))
    for n, k in enumerate(active):
        u, v, w = flow[k] - warped[k]
        for c in range(terms.shape[1] - 1):
            residual, along_u, along_v = terms[n, c]
            norm = along_u**2 + along_v**2 + _GRADIENT_FLOOR
            now = residual + along_u * u + along_v * v
            weight = _ASPECT_WEIGHT / norm / math.sqrt(now**2 / norm + _ASPECT_SCALE**2)
            _add(matrix[n], right[n], weight, (residual, along_u, along_v, 0.0), warped[k])
        residual, along_u, along_v = terms[n, -1]
        now = residual + along_u * u + along_v * v - w
        if not math.isnan(now):
            weight = firm.range_weight / math.sqrt(now**2 + firm.range_scale**2)
            _add(matrix[n], right[n], weight, (residual, along_u, along_v, -1.0), warped[k])
    return matrix, right


@compiled
def _add(
    matrix: np.ndarray,
    right: np.ndarray,
    weight: float,
    term: tuple[float, float, float, float],
    warped: np.ndarray,
) -> None:
    """Add weight (residual + term . (flow - warped))^2 to a pixel's equations."""
    residual, u, v, w = term
    matrix[0] += weight * u * u
    matrix[1] += weight * u * v
    matrix[2] += weight * v * v
    matrix[3] += weight * u * w
    matrix[4] += weight * v * w
    matrix[5] += weight * w * w
    pull = weight * (u * warped[0] + v * warped[1] + w * warped[2] - residual)
    right[0] += u * pull
    right[1] += v * pull
    right[2] += w * pull


@compiled
def _robust_hold(neighbours: np.ndarray, hold: np.ndarray, active: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """How firmly each neighbour holds a pixel: less, the more their flows differ."""
    robust = np.empty((len(active), 4))
    for n, k in enumerate(active):
        for side in range(4):
            other = neighbours[k, side]
            square = _SMOOTH_SCALE**2
            for c in range(3):
                square += (flow[k, c] - flow[other, c]) ** 2
            robust[n, side] = hold[k, side] / math.sqrt(square)
    return robust


@compiled
def _relax(
    matrix: np.ndarray,
    right: np.ndarray,
    neighbours: np.ndarray,
    hold: np.ndarray,
    active: np.ndarray,
    flow: np.ndarray,
) -> None:
    """Bring the flow, in place, near to the minimum of the quadratic energy."""
    for _ in range(_SWEEPS):
        for n, k in enumerate(active):
            firm, pull_u, pull_v, pull_w = 1e-6, 1e-6 * flow[k, 0], 1e-6 * flow[k, 1], 1e-6 * flow[k, 2]
            for side in range(4):
                q, other = hold[n, side], neighbours[k, side]
                firm += q
                pull_u += q * flow[other, 0]
                pull_v += q * flow[other, 1]
                pull_w += q * flow[other, 2]
            uu, uv, vv, uw, vw, ww = matrix[n]
            u, v, w = flow[k]
            u += _RELAXATION * ((right[n, 0] + pull_u - uv * v - uw * w) / (uu + firm) - u)
            v += _RELAXATION * ((right[n, 1] + pull_v - uv * u - vw * w) / (vv + firm) - v)
            w += _RELAXATION * ((right[n, 2] + pull_w - uw * u - vw * v) / (ww + firm) - w)
            flow[k, 0], flow[k, 1], flow[k, 2] = u, v, w


@compiled
def _still_moving(neighbours: np.ndarray, active: np.ndarray, warped: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """The pixels whose flow, or a neighbour's, has changed; steps that are too large are shortened, in place."""
    restless = np.zeros(len(flow), np.bool_)
    for k in active:
        largest = 0.0
        for c in range(3):
            step = min(max(flow[k, c] - warped[k, c], -_LARGEST_STEP[c]), _LARGEST_STEP[c])
            flow[k, c] = warped[k, c] + step
            largest = max(largest, abs(step))
        if largest > _AT_REST:
            restless[k] = True
            for side in range(4):
                restless[neighbours[k, side]] = True
    return np.flatnonzero(restless)
