"""Step 1: optical flow between two images. Each method is a function of the two images."""

import math
from collections.abc import Callable, Mapping
from functools import partial

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from algorithm.classic_nl import FAST, FULL, depth_flow, photograph_flow
from algorithm.settings import PixelFlowName

FlowMethod = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Takes two 8-bit images (row, column); gives the motion (column, row) in pixels of every pixel of the first."""

_SMALLEST_SIDE = 48
"""The methods need some pixels for their pyramids, RLOF the most; smaller images are padded with emptiness."""
_MARGIN = 16
"""Pixels of emptiness around what is not empty, so that flow may begin and end there."""


def flow_b_from_a(
    image_a: UInt8[np.ndarray, "row column"],
    image_b: UInt8[np.ndarray, "row column"],
    *,
    method: PixelFlowName,
) -> Float32[np.ndarray, "row column 2"]:
    """Where image b shows what image a shows: the motion (column, row) of every pixel of a, in pixels.

    Only the part of the picture where either image is not empty is paid for; elsewhere the flow is zero.
    Two equal images give exactly zero.
    """
    flow = np.zeros((*image_a.shape, 2), np.float32)
    if np.array_equal(image_a, image_b):
        return flow
    window = _occupied_window(image_a, image_b)
    a, b = _padded(image_a[window]), _padded(image_b[window])
    height, width = image_a[window].shape
    flow[window] = _METHODS[method](a, b)[:height, :width]
    return flow


def photograph_flow_b_from_a(
    image_a: UInt8[np.ndarray, "row column rgb=3"],
    image_b: UInt8[np.ndarray, "row column rgb=3"],
    *,
    method: PixelFlowName,
) -> Float32[np.ndarray, "row column 2"]:
    """The same between colour photographs, where no pixel is empty and the light may change.

    Classic+NL follows their texture and is guided by their colours; all others see them in grey.
    """
    if method in _CLASSIC_NL:
        return photograph_flow(image_a, image_b, effort=_CLASSIC_NL[method])
    greys = [cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for image in (image_a, image_b)]
    return _METHODS[method](*greys)


def _occupied_window(image_a: np.ndarray, image_b: np.ndarray) -> tuple[slice, slice]:
    """The rectangle that holds every pixel that is not empty in both images, with a margin."""
    occupied = (image_a > 0) | (image_b > 0)
    sides = []
    for axis in (1, 0):
        filled = np.flatnonzero(occupied.any(axis=axis))
        sides.append(slice(max(0, int(filled[0]) - _MARGIN), int(filled[-1]) + 1 + _MARGIN))
    return sides[0], sides[1]


def _padded(image: np.ndarray) -> np.ndarray:
    below, right = (max(0, _SMALLEST_SIDE - side) for side in image.shape)
    return cv2.copyMakeBorder(image, 0, below, 0, right, cv2.BORDER_CONSTANT, value=0)


def _dis(image_a: np.ndarray, image_b: np.ndarray) -> np.ndarray:
    """Dense inverse search [Kroeger et al., ECCV 2016], down to the finest scale."""
    method = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    method.setFinestScale(0)
    method.setPatchSize(8)
    method.setPatchStride(2)
    return np.asarray(method.calc(image_a, image_b, _room(image_a)))


def _dis_refined(image_a: np.ndarray, image_b: np.ndarray) -> np.ndarray:
    """DIS, then a variational refinement on the finest scale, started from it [Brox et al., ECCV 2004]."""
    flow = _dis(image_a, image_b)
    return np.asarray(cv2.VariationalRefinement.create().calc(image_a, image_b, flow))


def _deepflow(image_a: np.ndarray, image_b: np.ndarray) -> np.ndarray:
    """DeepFlow without its descriptor matches [Weinzaepfel et al., ICCV 2013]."""
    return np.asarray(cv2.optflow.createOptFlow_DeepFlow().calc(image_a, image_b, _room(image_a)))


def _farneback(image_a: np.ndarray, image_b: np.ndarray) -> np.ndarray:
    """Polynomial expansion [Farneback, SCIA 2003]."""
    return np.asarray(cv2.calcOpticalFlowFarneback(image_a, image_b, _room(image_a), 0.5, 4, 13, 5, 5, 1.1, 0))


def _tvl1(image_a: np.ndarray, image_b: np.ndarray) -> np.ndarray:
    """TV-L1 by duality [Zach, Pock, Bischof, DAGM 2007]."""
    return np.asarray(cv2.optflow.DualTVL1OpticalFlow.create().calc(image_a, image_b, _room(image_a)))


def _rlof(image_a: np.ndarray, image_b: np.ndarray) -> np.ndarray:
    """Robust local flow on a grid, interpolated between [Geistert, Senst, Sikora, PCS 2016], of three channels.

    The interpolation reads beyond its matches if there are fewer than it takes neighbours: so none are thrown
    away for not coming home, and small images take fewer neighbours.
    """
    method = cv2.optflow.DenseRLOFOpticalFlow.create()
    method.setForwardBackward(0.0)
    matches = math.prod(side // method.getGridStep()[0] for side in image_a.shape)
    method.setEPICK(min(method.getEPICK(), matches // 2))
    a, b = (cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) for image in (image_a, image_b))
    return np.asarray(method.calc(a, b, _room(image_a)))


def _room(image: np.ndarray) -> np.ndarray:
    """Room for a flow: OpenCV wants to be handed it."""
    return np.zeros((*image.shape, 2), np.float32)


_CLASSIC_NL = {"classic_nl": FULL, "classic_nl_fast": FAST}
_METHODS: Mapping[PixelFlowName, FlowMethod] = {
    "classic_nl": partial(depth_flow, effort=FULL),
    "classic_nl_fast": partial(depth_flow, effort=FAST),
    "deepflow": _deepflow,
    "dis": _dis,
    "dis_refined": _dis_refined,
    "farneback": _farneback,
    "rlof": _rlof,
    "tvl1": _tvl1,
}
