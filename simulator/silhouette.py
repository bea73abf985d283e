"""What walking bodies look like from afar, in every phase of the gait and from every side: the shapes of the foresight.

A silhouette is a small bitmap over the place beside the body's axis and the height above the ground. `CELLS` of its
filled pixels, evenly spread, stand for all of them: the share of cells that is seen is the share of pixels that is.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from scipy.ndimage import binary_closing

from simulator.body import body_names, load_body
from simulator.gait import STRIDE_FACTOR
from simulator.path import path_through
from simulator.person import walking_person

CELLS = 64
"""As many as bits in a number."""
_PHASES, _FACINGS = 12, 24
_PACE = 1.2  # Metres a second: an ordinary walk.
_REACH_M = 0.6  # No part of a body is farther from its axis.
_ACROSS_M, _UPWARDS_M = 0.02, 0.03  # A pixel of the bitmaps.
_COLUMNS, _ROWS = round(2 * _REACH_M / _ACROSS_M), 64
_A_FACE = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4], [1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1]], np.float64)
"""Weights of a face's corners: points of it that leave no gaps between them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Silhouettes:
    """The silhouettes of all bodies; a *pose* is the number of a body, a phase and a facing together."""

    bodies: tuple[str, ...]
    thigh_m: Float[np.ndarray, "body"]
    """Height of the hip, by which the gait's frequency goes, metres."""
    filled: Bool[np.ndarray, "pose row column"]
    aside_m: Float32[np.ndarray, "pose cell"]
    """Where each cell is to the right of the body's axis, metres."""
    height_m: Float32[np.ndarray, "pose cell"]
    """Above the ground, metres."""

    def pose(
        self,
        body: Int[np.ndarray, "*#walker"],
        cycles: Float[np.ndarray, "*walker"],
        turn: Float[np.ndarray, "*walker"],
    ) -> Int[np.ndarray, "*walker"]:
        """The pose of a body at a phase of its gait that walks at an angle to the right of the line of sight."""
        phase = np.rint(cycles * _PHASES).astype(np.intp) % _PHASES
        facing = np.rint(turn / (2 * np.pi) * _FACINGS).astype(np.intp) % _FACINGS
        return (body * _PHASES + phase) * _FACINGS + facing

    def covers(
        self,
        pose: Int[np.ndarray, "*#place"],
        aside_m: Float[np.ndarray, "*place"],
        height_m: Float[np.ndarray, "*place"],
    ) -> Bool[np.ndarray, "*place"]:
        """Whether the silhouette is filled there."""
        column = ((aside_m + _REACH_M) * (1 / _ACROSS_M)).astype(np.int32)
        row = (height_m * (1 / _UPWARDS_M)).astype(np.int32)
        known = (aside_m >= -_REACH_M) & (column < _COLUMNS) & (height_m >= 0) & (row < _ROWS)
        place = (pose * _ROWS + row) * _COLUMNS + column
        return self.filled.reshape(-1)[np.where(known, place, 0)] & known

    def cycles(
        self,
        body: Int[np.ndarray, "*walker"],
        speed: Float[np.ndarray, "*walker frame"],
        phase: Float[np.ndarray, "*walker"],
        frame_s: float,
    ) -> Float[np.ndarray, "*walker frame"]:
        """The gait's phase in every frame of those who walk at these speeds, m/s, as `simulator.gait` has it."""
        frequency = np.sqrt(speed / self.thigh_m[body][..., None]) / STRIDE_FACTOR
        return phase[..., None] + (np.cumsum(frequency, axis=-1) - frequency) * frame_s


@cache
def silhouettes() -> Silhouettes:
    """The silhouettes of all bodies, made once in a process from their meshes; about 0.4 s."""
    names = tuple(body_names())
    thighs = np.array([load_body(name).joint("thigh.L")[2] for name in names])
    filled = np.concatenate([_filled(name, thigh) for name, thigh in zip(names, thighs.tolist(), strict=True)])
    order = np.argsort(~filled.reshape(len(filled), -1), axis=1, kind="stable")  # What is filled comes first.
    counts = filled.sum(axis=(1, 2))
    rank = ((np.arange(CELLS) + 0.5) / CELLS * counts[:, None]).astype(np.intp)
    row, column = np.divmod(np.take_along_axis(order, rank, axis=1), _COLUMNS)
    return Silhouettes(
        bodies=names,
        thigh_m=thighs,
        filled=filled,
        aside_m=((column + 0.5) * _ACROSS_M - _REACH_M).astype(np.float32),
        height_m=((row + 0.5) * _UPWARDS_M).astype(np.float32),
    )


def _filled(name: str, thigh_m: float) -> Bool[np.ndarray, "pose row column"]:
    """Which pixels of its silhouettes the body fills, seen from afar at its own height."""
    times = np.arange(_PHASES) / _PHASES * STRIDE_FACTOR * np.sqrt(thigh_m / _PACE)
    path = path_through([(-4.0, 0.0), (4.0, 0.0)], speed=_PACE, start=-2.0)
    mesh = walking_person(load_body(name), path, times, phase=0.0).mesh
    corners = mesh.vertices[:, mesh.faces] - np.pad(path.positions(times), ((0, 0), (0, 1)))[:, None, None]
    weights = _A_FACE / _A_FACE.sum(axis=1, keepdims=True)
    points = np.einsum("pfcx,kc->pfkx", corners, weights).reshape(_PHASES, -1, 3)
    row = np.clip(points[..., 2] / _UPWARDS_M, 0, _ROWS - 1).astype(np.intp)
    filled = np.zeros((_PHASES, _FACINGS, _ROWS, _COLUMNS), bool)
    for facing in range(_FACINGS):
        turn = 2 * np.pi * facing / _FACINGS
        aside = points[..., 0] * np.sin(turn) - points[..., 1] * np.cos(turn)
        column = np.clip((aside + _REACH_M) / _ACROSS_M, 0, _COLUMNS - 1).astype(np.intp)
        filled[np.arange(_PHASES)[:, None], facing, row, column] = True
    return binary_closing(filled, np.ones((1, 1, 2, 2), bool)).reshape(-1, _ROWS, _COLUMNS)
