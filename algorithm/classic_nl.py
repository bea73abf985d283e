"""Classic+NL: the optical flow that the paper uses.

After D. Sun, S. Roth, M. J. Black, "Secrets of optical flow estimation and their principles", CVPR 2010, and "A
quantitative analysis of current practices in optical flow estimation and the principles behind them", IJCV 2014:
a robust energy, made robust by degrees, minimised by warping from coarse to fine, with a median weighted by
colour, distance and occlusion after every step. Written from the articles.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, UInt8

from algorithm.linear_flow import flow_step
from algorithm.pyramid import continued, level_shapes, pyramid, resized_flow
from algorithm.texture import textures
from algorithm.warping import derivatives, warped
from algorithm.weighted_median import median_filtered

_SMOOTHNESS = 3.0
_LARGEST_STEP_PX = 1.0
_COARSEST_PX = 16
_DIVERGENCE_SIGMA, _CHANGE_SIGMA = 0.3, 20.0
"""Pixels a pixel, and grey levels: of the weights that distrust what looks occluded."""


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How much work is spent."""

    quadratic: tuple[float, ...]
    """Stages of graduated non-convexity: the share of x^2 in every penalty."""
    warps: int
    """Steps a stage and pyramid level."""


FULL = Effort(quadratic=(1.0, 0.5, 0.0), warps=10)
"""As published."""
FAST = Effort(quadratic=(1.0, 0.0), warps=3)
"""The articles' Classic+NL-fast."""


@dataclass(frozen=True, kw_only=True)
class View:
    """One of two images, as the flow sees it."""

    image: Float32[np.ndarray, "row column"]
    """What stays constant along the motion, 0 to 255."""
    valid: Bool[np.ndarray, "row column"]
    """False where the image shows nothing."""
    guide: Float32[np.ndarray, "row column channel"]
    """Where this is alike, 0 to 255, the motion is likely to be alike."""


def depth_flow(
    image_a: UInt8[np.ndarray, "row column"], image_b: UInt8[np.ndarray, "row column"], *, effort: Effort
) -> Float32[np.ndarray, "row column 2"]:
    """The flow between depth images with 0 where nothing is: what is there has no say in it.

    Depth has neither texture nor shadows, so it is taken as it is. Empty pixels get a flow too, continued
    smoothly from the others.
    """
    views = []
    for picture in (image_a, image_b):
        valid = picture > 0
        image = continued(picture.astype(np.float32), valid)
        views.append(View(image=image, valid=valid, guide=image[..., None]))
    return classic_nl(views[0], views[1], effort=effort)


def photograph_flow(
    image_a: UInt8[np.ndarray, "row column rgb=3"], image_b: UInt8[np.ndarray, "row column rgb=3"], *, effort: Effort
) -> Float32[np.ndarray, "row column 2"]:
    """The flow between colour photographs, by their texture; CIE Lab colours, with L from 0 to 255, guide it."""
    colours = [picture.astype(np.float32) for picture in (image_a, image_b)]
    views = []
    for colour, image in zip(
        colours, textures(np.stack([cv2.cvtColor(c, cv2.COLOR_RGB2GRAY) for c in colours])), strict=True
    ):
        lab = cv2.cvtColor(colour / 255, cv2.COLOR_RGB2Lab) * np.float32(2.55)
        views.append(View(image=image, valid=np.ones(image.shape, bool), guide=lab))
    return classic_nl(views[0], views[1], effort=effort)


def classic_nl(view_a: View, view_b: View, *, effort: Effort) -> Float32[np.ndarray, "row column 2"]:
    """Where view b shows what view a shows: the motion (column, row) of every pixel of a, in pixels."""
    shape = view_a.image.shape
    flow = np.zeros((*shape, 2), np.float32)
    for stage, quadratic in enumerate(effort.quadratic):
        levels, spacing = (2, 1.25) if stage else (_octaves(shape), 2.0)
        pyramids = (coarse_to_fine(view, levels=levels, spacing=spacing) for view in (view_a, view_b))
        for a, b in zip(*pyramids, strict=True):
            flow = resized_flow(flow, a.image.shape)
            slopes_a = derivatives(a.image)
            for _ in range(effort.warps):
                slopes = data_slopes(a, met(a, b, flow), slopes_a)
                step = flow_step(flow, slopes, smoothness=_SMOOTHNESS, quadratic=quadratic)
                flow = flow + step.clip(-_LARGEST_STEP_PX, _LARGEST_STEP_PX)
                seen = trust(a, met(a, b, flow), flow)
                flow = median_filtered(flow, guide=a.guide, trust=seen, valid=a.valid)
    return flow


def _octaves(shape: tuple[int, int]) -> int:
    """The number of levels, each half the size, until the shorter side is about 16 pixels."""
    return 1 + max(0, int(np.log2(min(shape) / _COARSEST_PX)))


def coarse_to_fine(view: View, *, levels: int, spacing: float) -> Iterator[View]:
    """The view at every size of a pyramid; a pixel is valid if half of what it covers is."""
    shapes = level_shapes(view.image.shape, levels=levels, spacing=spacing)
    parts = (view.image, view.valid.astype(np.float32), view.guide)
    stacks = (pyramid(part, shapes, spacing=spacing)[::-1] for part in parts)
    for image, share, guide in zip(*stacks, strict=True):
        yield View(image=image, valid=share >= 0.5, guide=guide)


def met(a: View, b: View, flow: Float32[np.ndarray, "row column 2"]) -> Float32[np.ndarray, "row column 3"]:
    """What the flow meets in b: value and slopes of the image; NaN in pixels without data.

    Without data is what is empty in a, and what the flow leads to emptiness or beyond the border.
    """
    value_and_slopes = warped(b.image, flow)
    if not (a.valid.all() and b.valid.all()):
        height, width = a.valid.shape
        column = np.arange(width, dtype=np.float32) + flow[..., 0]
        row = np.arange(height, dtype=np.float32)[:, None] + flow[..., 1]
        arrived = cv2.remap(b.valid.astype(np.uint8), column, row, cv2.INTER_NEAREST, borderValue=0)
        value_and_slopes[~a.valid | (arrived == 0)] = np.nan
    return value_and_slopes


def data_slopes(
    a: View, found: Float32[np.ndarray, "row column 3"], slopes_a: Float32[np.ndarray, "row column 2"]
) -> Float32[np.ndarray, "row column 3"]:
    """The image's derivatives along columns, rows (the mean of both images') and time; zero without data."""
    slopes = np.concatenate([(slopes_a + found[..., 1:]) / 2, found[..., :1] - a.image[..., None]], axis=-1)
    return np.nan_to_num(slopes, nan=0.0)


def trust(
    a: View, found: Float32[np.ndarray, "row column 3"], flow: Float32[np.ndarray, "row column 2"]
) -> Float32[np.ndarray, "row column"]:
    """How little each pixel looks occluded, 0 to 1: less where the flow converges, and where the grey changes."""
    change = np.nan_to_num(found[..., 0] - a.image, nan=0.0)
    converging = np.zeros_like(change)
    converging[:, 1:-1] += (flow[:, 2:, 0] - flow[:, :-2, 0]) / 2
    converging[1:-1] += (flow[2:, :, 1] - flow[:-2, :, 1]) / 2
    converging = np.minimum(converging, 0)
    return np.exp(-((converging / _DIVERGENCE_SIGMA) ** 2 + (change / _CHANGE_SIGMA) ** 2) / 2)
