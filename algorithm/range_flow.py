"""Steps 1 and 2 of the default preset: how a surface moves in the picture and in depth, found at once.

As an image, depth shows little of a body but its outline; as a surface it shows much. So the unknowns are u, v
(pixels) and w (metres) of every moving pixel, and the energy has three robust terms:

- range flow: the surface is met where it has gone, Z_b(p + (u, v)) = Z_a(p) + w
  [Spies, Jahne, Barron, CVIU 2002; Gottfried, Fehr, Garbe, ISVC 2011];
- constancy of the image and of its slopes, normalised by gradients [Zimmer, Bruhn, Weickert, IJCV 2011];
- smoothness of (u, v, w) over neighbours on the same surface.

It is minimised by warping, reweighting and over-relaxation [Brox et al., ECCV 2004] from a fast optical flow. What
it costs grows with the moving pixels alone.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from jaxtyping import Float32, Float64, UInt8

from algorithm.compiled import compiled
from algorithm.flow import flow_b_from_a
from algorithm.lifting import SceneFlow
from algorithm.range_energy import UNITS_PER_M, firmness, minimise
from algorithm.sampling import on_surface

_START_REACH_M, _HOME_REACH_M = 0.15, 0.1
_SMOOTHED_PX = 0.6
_HOME_PX = 2.0
"""Flows there and back that miss each other by less are averaged."""


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """What the flow sees of a frame."""

    surface: Float32[np.ndarray, "row column"]
    """Depth of what moves, smoothed, metres; NaN elsewhere."""
    image: UInt8[np.ndarray, "row column"]
    """The image whose constancy counts, and that the fast optical flow follows; 0 = empty."""

    @cached_property
    def aspects(self) -> Float64[np.ndarray, "row column slot"]:
        """What of the image stays the same where a surface goes: brightness and its slopes, each with its own slopes.

        Of the image smoothed a little and divided by 255; for one aspect after the other the value, its slope along
        the columns and that along the rows.
        """
        value = cv2.GaussianBlur(self.image.astype(np.float64) / 255, (0, 0), _SMOOTHED_PX)
        aspects = (value, *_slopes(value))
        return np.ascontiguousarray(
            np.stack([slot for aspect in aspects for slot in (aspect, *_slopes(aspect))], axis=-1)
        )


def range_flow(a: View, b: View, *, noise_m: float = 0.0) -> SceneFlow:
    """The motion of every moving pixel of view a to view b; NaN in depth elsewhere.

    `noise_m` is the standard deviation of the surfaces' depth. A surface that does not move has exactly no flow;
    neither has what is empty.
    """
    start = flow_b_from_a(a.image, b.image, method="dis")
    if np.array_equal(a.surface, b.surface, equal_nan=True):
        start = np.zeros_like(start)
    surfaces = a.surface.astype(np.float64), b.surface.astype(np.float64)
    pixels = np.argwhere(np.isfinite(a.surface))
    flow = _lifted_start(start.astype(np.float64), surfaces, pixels)
    minimise((a.aspects, b.aspects), surfaces, pixels, flow, firmness(noise_m))
    return _as_image(flow, pixels, a.surface.shape)


def _slopes(values: Float64[np.ndarray, "row column"]) -> tuple[np.ndarray, np.ndarray]:
    """The change a pixel along the columns and along the rows."""
    along, down = (cv2.Scharr(values, cv2.CV_64F, *order, scale=1 / 32) for order in ((1, 0), (0, 1)))
    return along, down


def agreed(forward: SceneFlow, backward: SceneFlow, a: View, b: View) -> SceneFlow:
    """The forward flow, averaged with the backward one where both tell the same motion to within 2 pixels.

    Each is the other's negative at the place it leads to; their errors are not the same.
    """
    pixels = np.argwhere(np.isfinite(forward.depth))
    flows = tuple(
        np.dstack([flow.column_row, UNITS_PER_M * flow.depth]).astype(np.float64) for flow in (forward, backward)
    )
    surfaces = a.surface.astype(np.float64), b.surface.astype(np.float64)
    return _as_image(_mean_of_both(flows, surfaces, pixels), pixels, a.surface.shape)


def _as_image(flow: Float64[np.ndarray, "pixel 3"], pixels: np.ndarray, shape: tuple[int, ...]) -> SceneFlow:
    column_row = np.zeros((*shape, 2), np.float32)
    depth = np.full(shape, np.nan, np.float32)
    column_row[pixels[:, 0], pixels[:, 1]] = flow[:, :2]
    depth[pixels[:, 0], pixels[:, 1]] = flow[:, 2] / UNITS_PER_M
    return SceneFlow(column_row=column_row, depth=depth)


@compiled
def _lifted_start(start: np.ndarray, surfaces: tuple[np.ndarray, np.ndarray], pixels: np.ndarray) -> np.ndarray:
    """The optical flow at the pixels, with the change of depth that it leads to; 0 where it misses the surface."""
    flow = np.zeros((len(pixels), 3))
    for k in range(len(pixels)):
        row, column = pixels[k]
        flow[k, 0], flow[k, 1] = start[row, column, 0], start[row, column, 1]
        depth = surfaces[0][row, column]
        place = (row + flow[k, 1], column + flow[k, 0])
        change = on_surface(surfaces[1], surfaces[1], place, depth, _START_REACH_M) - depth
        flow[k, 2] = 0.0 if math.isnan(change) else UNITS_PER_M * change
    return flow


@compiled
def _mean_of_both(
    flows: tuple[np.ndarray, np.ndarray], surfaces: tuple[np.ndarray, np.ndarray], pixels: np.ndarray
) -> np.ndarray:
    """The flow at the pixels, half of it the other one's way back where they agree."""
    mean = np.empty((len(pixels), 3))
    for k in range(len(pixels)):
        there = flows[0][pixels[k, 0], pixels[k, 1]]
        place = (pixels[k, 0] + there[1], pixels[k, 1] + there[0])
        depth = surfaces[0][pixels[k, 0], pixels[k, 1]] + there[2] / UNITS_PER_M
        back = np.empty(3)
        for c in range(3):
            back[c] = on_surface(flows[1][..., c], surfaces[1], place, depth, _HOME_REACH_M)
        agrees = (there[0] + back[0]) ** 2 + (there[1] + back[1]) ** 2 <= _HOME_PX**2  # NaN does not.
        for c in range(3):
            mean[k, c] = (there[c] - back[c]) / 2 if agrees else there[c]
    return mean
