"""Medians of a flow field over what belongs together: the non-local term of Classic+NL.

The weights are those of Sun, Roth, Black, "Secrets of optical flow estimation and their principles", CVPR
2010, section 5: near in space, near in colour, not occluded.
"""

import math

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int64

from algorithm.compiled import compiled

_SIDE = 5
"""Pixels: side of the plain median's window, and how far the surroundings of an edge reach."""
_RADIUS = 7
"""Pixels: the window of the weighted median is 15x15."""
_SPATIAL_SIGMA, _GUIDE_SIGMA = 7.0, 7.0
"""In pixels, and in grey levels of 0 to 255."""
_EDGE_SHARE = 4.0
"""At an edge the squared gradient is more than this many times its mean [Pratt, Digital image processing]."""
_FAINTEST = 12.0
"""A weight below exp(-12) is none."""
_BINS = 64

Spare = tuple[np.ndarray, np.ndarray]
"""Room for a histogram, and for the values of one bin with their weights."""


def median_filtered(
    flow: Float32[np.ndarray, "row column 2"],
    *,
    guide: Float32[np.ndarray, "row column channel"],
    trust: Float32[np.ndarray, "row column"],
    valid: Bool[np.ndarray, "row column"],
) -> Float32[np.ndarray, "row column 2"]:
    """The flow, every component replaced by its median: over 5x5, near flow edges over 15x15 and weighted.

    Only valid pixels count; one that has none around it keeps its flow. `guide` is the image, 0 to 255, whose
    likeness weighs; `trust` weighs every pixel by how little it looks occluded.
    """
    filtered = np.stack([cv2.medianBlur(np.ascontiguousarray(flow[..., c]), _SIDE) for c in (0, 1)], axis=-1)
    square = np.ones((_SIDE, _SIDE), np.uint8)
    beside_empty = cv2.dilate((~valid).astype(np.uint8), square) > 0
    weight = valid.astype(np.float32)
    _medians(flow, weight, _places(beside_empty), filtered)
    near_edges = cv2.dilate(flow_edges(flow).astype(np.uint8), square) > 0
    _weighted_medians(flow, guide, weight * trust, _places(near_edges), filtered)
    return filtered


def _places(mask: Bool[np.ndarray, "row column"]) -> Int64[np.ndarray, "place 2"]:
    return np.ascontiguousarray(np.argwhere(mask))  # Else its memory order depends on whether there are any.


def flow_edges(flow: Float32[np.ndarray, "row column 2"]) -> Bool[np.ndarray, "row column"]:
    """The pixels where either component of the flow has a Sobel gradient well above its mean."""
    edges = np.zeros(flow.shape[:2], bool)
    for c in (0, 1):
        along, down = (cv2.Sobel(flow[..., c], cv2.CV_32F, *order) for order in ((1, 0), (0, 1)))
        square = along**2 + down**2
        edges |= square > _EDGE_SHARE * square.mean()
    return edges


@compiled
def _medians(flow: np.ndarray, weight: np.ndarray, places: np.ndarray, filtered: np.ndarray) -> None:
    """Into `filtered`: at every place the median of both components over the pixels of 5x5 that weigh anything."""
    u, v, weights, spare = _room(_SIDE**2)
    radius = _SIDE // 2
    for place in range(len(places)):
        row, column = places[place]
        count = 0
        for i in range(max(0, row - radius), min(weight.shape[0], row + radius + 1)):
            for j in range(max(0, column - radius), min(weight.shape[1], column + radius + 1)):
                if weight[i, j] > 0:
                    u[count], v[count], weights[count] = flow[i, j, 0], flow[i, j, 1], weight[i, j]
                    count += 1
        filtered[row, column] = flow[row, column]
        if count:
            filtered[row, column, 0] = weighted_median(u, weights, count, spare)
            filtered[row, column, 1] = weighted_median(v, weights, count, spare)


@compiled
def _weighted_medians(
    flow: np.ndarray, guide: np.ndarray, weight: np.ndarray, places: np.ndarray, filtered: np.ndarray
) -> None:
    """The same over 15x15, where a pixel weighs the less the farther away and the less alike it is."""
    u, v, weights, spare = _room((2 * _RADIUS + 1) ** 2)
    per_square_pixel = 1 / (2 * _SPATIAL_SIGMA**2)
    per_square_level = 1 / (2 * _GUIDE_SIGMA**2 * guide.shape[2])
    for place in range(len(places)):
        row, column = places[place]
        count = 0
        for i in range(max(0, row - _RADIUS), min(weight.shape[0], row + _RADIUS + 1)):
            for j in range(max(0, column - _RADIUS), min(weight.shape[1], column + _RADIUS + 1)):
                unlike = np.float32(0)
                for c in range(guide.shape[2]):
                    unlike += (guide[i, j, c] - guide[row, column, c]) ** 2
                exponent = ((i - row) ** 2 + (j - column) ** 2) * per_square_pixel + unlike * per_square_level
                if weight[i, j] > 0 and exponent < _FAINTEST:
                    u[count], v[count] = flow[i, j, 0], flow[i, j, 1]
                    weights[count] = weight[i, j] * math.exp(-exponent)
                    count += 1
        if count:
            filtered[row, column, 0] = weighted_median(u, weights, count, spare)
            filtered[row, column, 1] = weighted_median(v, weights, count, spare)


@compiled
def _room(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, Spare]:
    """Room for two lists of values and their weights, and for what the median needs besides."""
    room = np.empty((3, count), np.float32)
    return room[0], room[1], room[2], (np.empty(_BINS), np.empty((2, count + 1), np.float32))


@compiled
def weighted_median(values: np.ndarray, weights: np.ndarray, count: int, spare: Spare) -> float:
    """The smallest of the first `count` values with at least half of their weight at or below it.

    A histogram of the weight shows in which bin it lies; among the few values of that bin it is selected.
    """
    heights, (few, few_weights) = spare[0], spare[1]
    lowest, highest, total = values[0], values[0], 0.0
    for k in range(count):
        lowest = min(lowest, values[k])
        highest = max(highest, values[k])
        total += weights[k]
    if lowest == highest:
        return lowest
    scale = (_BINS - 1) / np.float64(highest - lowest)
    heights[:] = 0
    for k in range(count):
        heights[int((values[k] - lowest) * scale)] += weights[k]
    below, middle = 0.0, 0
    while middle < _BINS - 1 and below + heights[middle] < total / 2:
        below += heights[middle]
        middle += 1
    inside = 0
    for k in range(count):  # Without a branch, for it would be mispredicted: what is not kept is overwritten.
        few[inside], few_weights[inside] = values[k], weights[k]
        inside += int((values[k] - lowest) * scale) == middle
    return _selected(few, few_weights, inside, total / 2 - below)


@compiled
def _selected(values: np.ndarray, weights: np.ndarray, count: int, wanted: float) -> float:
    """The smallest of the first `count` values with the wanted weight at or below it; quickselect, in place."""
    first, last, below = 0, count - 1, 0.0
    while first < last:
        pivot = values[(first + last) // 2]
        i, j, upto = first, last, below
        while i <= j:
            while values[i] < pivot:
                upto += weights[i]
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                weights[i], weights[j] = weights[j], weights[i]
                upto += weights[i]
                i += 1
                j -= 1
        # Now the values up to j are not above the pivot, those from i on not below; one between them equals it.
        between = weights[i - 1] if i - j == 2 else 0.0
        if upto - between >= wanted:
            last = j
        elif upto >= wanted:
            return pivot
        else:
            first, below = i, upto
    return values[first]
