"""Steps 3 and 4 of the default preset: points followed between the pixels, frame after frame.

The paper chains matched pixels: each step rounds to a pixel, and the roundings add up. Here a point keeps its place
between the pixels, and its depth is read anew from the surface that it has arrived on.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64

from algorithm.compiled import compiled
from algorithm.lifting import SceneFlow
from algorithm.noise import surface_noise_m
from algorithm.observations import Observations
from algorithm.sampling import on_surface
from algorithm.stopwatch import Stopwatch
from recording.camera import PIXEL_CENTRE, Camera

Depth = Float32[np.ndarray, "row column"]
_CELLS_A_PIXEL = 2
"""Of points that come together in one cell the oldest goes on."""
_SEEDED_FROM_PX = 0.6
"""A pixel without a point this near to its centre begins one."""
_INSIDE_PX = 0.499
_SURFACE_SIGMAS, _HOME_SIGMAS, _JOLT_SIGMAS = 4.0, 6.0, 10.0
"""Standard deviations of the depth that the tolerances leave room for."""
_MEMORY = 0.5
"""Share of its former velocity that a point's running mean keeps at each step."""


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """When a point is lost."""

    surface_m: float
    """Depths that differ by more are of different surfaces, metres."""
    home_m: float
    """Following the flow there and back, a point must come home this near, metres (epsilon 1)."""
    jolt_m: float
    """How far a step may be from the running mean of the steps before it, metres."""

    def under_noise(self, noise_m: float) -> "Tolerances":
        """The same where depth has noise of this standard deviation: it makes surfaces rough, and steps jolt."""
        return Tolerances(
            surface_m=math.hypot(self.surface_m, _SURFACE_SIGMAS * noise_m),
            home_m=math.hypot(self.home_m, _HOME_SIGMAS * noise_m),
            jolt_m=math.hypot(self.jolt_m, _JOLT_SIGMAS * noise_m),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Points:
    """The points that are being followed, in one frame."""

    number: Int64[np.ndarray, "point"]
    column_row: Float64[np.ndarray, "point 2"]
    depth: Float64[np.ndarray, "point"]
    step: Float64[np.ndarray, "point 3"]
    """Running mean of the moves a frame, camera axes, metres; NaN for a point that has just begun."""


def followed(
    depths: Sequence[Depth],
    flows: Iterable[tuple[SceneFlow, SceneFlow]],
    *,
    camera: Camera,
    tolerances: Tolerances,
    watch: Stopwatch,
) -> list[Observations]:
    """Every moving point of every frame; `flows` lead forward and backward between consecutive frames.

    A point ends where its flow or its surface is not known, where the way back does not lead home, and where its
    step leaves the running mean of its steps. Of points that meet the oldest goes on; where none lies a new one begins.
    """
    tolerances = tolerances.under_noise(surface_noise_m(depths))
    points = _begun(depths[0], np.isfinite(depths[0]), first=0)
    count = len(points.number)
    history = [_observed(points, points.column_row)]
    for pair, both in zip(pairwise(depths), flows, strict=True):
        with watch.stage("match"):
            points = _advanced(points, pair, both, camera, tolerances)
        with watch.stage("trajectories"):
            free = np.isfinite(pair[1]) & ~_occupied(pair[1], points, tolerances.surface_m)
            fresh = _begun(pair[1], free, first=count)
            count += len(fresh.number)
            points = _joined(points, fresh)
            history.append(_observed(points, _seen_at(pair[1], points, tolerances.surface_m)))
    return history


def _observed(points: _Points, column_row: Float64[np.ndarray, "point 2"]) -> Observations:
    """What is remembered of the points: their places in the picture, and how far they are."""
    return Observations(
        number=points.number.astype(np.int32),
        column_row=column_row.astype(np.float32),
        depth=points.depth.astype(np.float32),
    )


def _begun(depth: Depth, where: Bool[np.ndarray, "row column"], *, first: int) -> _Points:
    """A new point in the middle of each of the pixels."""
    row, column = np.nonzero(where)
    return _Points(
        number=first + np.arange(len(row)),
        column_row=np.stack([column, row], axis=1) + PIXEL_CENTRE,
        depth=depth[row, column].astype(np.float64),
        step=np.full((len(row), 3), np.nan),
    )


def _joined(one: _Points, other: _Points) -> _Points:
    names = [field.name for field in fields(_Points)]
    return _Points(**{name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in names})


def _advanced(
    points: _Points,
    depths: tuple[Depth, Depth],
    flows: tuple[SceneFlow, SceneFlow],
    camera: Camera,
    tolerances: Tolerances,
) -> _Points:
    """The points that are found in the next frame, there."""
    move = _moves(points.column_row, points.depth, depths[0], flows[0], tolerances.surface_m)
    column_row = points.column_row + move[:, :2]
    depth = _depth_at(depths[1], column_row, points.depth + move[:, 2], tolerances.surface_m)
    back = _moves(column_row, depth, depths[1], flows[1], tolerances.surface_m)
    begun = camera.camera_from_pixel(points.column_row, points.depth)
    arrived = camera.camera_from_pixel(column_row, depth)
    home = camera.camera_from_pixel(column_row + back[:, :2], depth + back[:, 2])
    step = arrived - begun
    jolt = np.linalg.norm(step - points.step, axis=1)
    lasts = np.linalg.norm(home - begun, axis=1) <= tolerances.home_m  # NaN does not come home.
    lasts &= ~(jolt > tolerances.jolt_m)  # NaN: a point's first step is no jolt.
    kept = np.flatnonzero(lasts)
    kept = kept[_oldest(points.number[kept], column_row[kept])]
    known = np.isfinite(points.step[kept])
    mean = np.where(known, _MEMORY * points.step[kept] + (1 - _MEMORY) * step[kept], step[kept])
    return _Points(number=points.number[kept], column_row=column_row[kept], depth=depth[kept], step=mean)


def _oldest(
    number: Int64[np.ndarray, "point"], column_row: Float64[np.ndarray, "point 2"]
) -> Int64[np.ndarray, "kept"]:
    """Which points go on: in each cell of half a pixel the one that began first."""
    cell = np.floor(column_row * _CELLS_A_PIXEL).astype(np.int64)
    cell -= cell.min(axis=0, initial=0)  # A place may lie a little outside the picture.
    key = cell[:, 1] * (cell[:, 0].max(initial=0) + 1) + cell[:, 0]
    order = np.lexsort((number, key))  # Numbers grow with time.
    first = np.ones(len(order), bool)
    first[1:] = key[order][1:] != key[order][:-1]
    return np.sort(order[first])


def _moves(
    column_row: Float64[np.ndarray, "point 2"],
    depth: Float64[np.ndarray, "point"],
    image: Depth,
    flow: SceneFlow,
    surface_m: float,
) -> Float64[np.ndarray, "point 3"]:
    """The flow at the points: columns, rows (pixels), depth (metres); NaN where it is not known."""
    return _sampled_flow(flow.column_row, flow.depth, image, column_row - PIXEL_CENTRE, depth, surface_m)


def _depth_at(
    image: Depth, column_row: Float64[np.ndarray, "point 2"], expected: Float64[np.ndarray, "point"], surface_m: float
) -> Float64[np.ndarray, "point"]:
    """The depth of the surface at the points, NaN where none is near what is expected."""
    return _sampled_depth(image, column_row - PIXEL_CENTRE, expected, surface_m)


def _occupied(image: Depth, points: _Points, surface_m: float) -> Bool[np.ndarray, "row column"]:
    """The pixels that have a point near by on their surface."""
    return _near_points(image, points.column_row - PIXEL_CENTRE, points.depth, surface_m)


def _seen_at(image: Depth, points: _Points, surface_m: float) -> Float64[np.ndarray, "point 2"]:
    """The points' picture positions, at outlines moved into the pixel whose return shows the surface."""
    return _drawn_in(image, points.column_row - PIXEL_CENTRE, points.depth, surface_m) + PIXEL_CENTRE


@compiled
def _sampled_flow(
    column_row: np.ndarray,
    change: np.ndarray,
    image: np.ndarray,
    place: np.ndarray,
    depth: np.ndarray,
    surface_m: float,
) -> np.ndarray:
    moves = np.full((len(place), 3), np.nan)
    for k in range(len(place)):
        where = (place[k, 1], place[k, 0])
        moves[k, 0] = on_surface(column_row[..., 0], image, where, depth[k], surface_m)
        moves[k, 1] = on_surface(column_row[..., 1], image, where, depth[k], surface_m)
        moves[k, 2] = on_surface(change, image, where, depth[k], surface_m)
    return moves


@compiled
def _sampled_depth(image: np.ndarray, place: np.ndarray, expected: np.ndarray, surface_m: float) -> np.ndarray:
    depth = np.full(len(place), np.nan)
    for k in range(len(place)):
        depth[k] = on_surface(image, image, (place[k, 1], place[k, 0]), expected[k], surface_m)
    return depth


@compiled
def _near_points(image: np.ndarray, place: np.ndarray, depth: np.ndarray, surface_m: float) -> np.ndarray:
    near = np.zeros(image.shape, np.bool_)
    for k in range(len(place)):
        row, column = math.floor(place[k, 1]), math.floor(place[k, 0])
        for i in range(max(row, 0), min(row + 2, image.shape[0])):
            for j in range(max(column, 0), min(column + 2, image.shape[1])):
                square = (i - place[k, 1]) ** 2 + (j - place[k, 0]) ** 2
                if square <= _SEEDED_FROM_PX**2 and abs(image[i, j] - depth[k]) <= surface_m:
                    near[i, j] = True
    return near


@compiled
def _drawn_in(image: np.ndarray, place: np.ndarray, depth: np.ndarray, surface_m: float) -> np.ndarray:
    """Each place, or where none of its own pixel's return is near the depth, the nearest place in a pixel with one."""
    drawn = place.copy()
    for k in range(len(place)):
        nearest = math.inf
        row, column = math.floor(place[k, 1]), math.floor(place[k, 0])
        for i in range(max(row, 0), min(row + 2, image.shape[0])):
            for j in range(max(column, 0), min(column + 2, image.shape[1])):
                if abs(image[i, j] - depth[k]) <= surface_m:
                    x = min(max(place[k, 0], j - _INSIDE_PX), j + _INSIDE_PX)
                    y = min(max(place[k, 1], i - _INSIDE_PX), i + _INSIDE_PX)
                    square = (x - place[k, 0]) ** 2 + (y - place[k, 1]) ** 2
                    if square < nearest:
                        nearest = square
                        drawn[k] = x, y
    return drawn
