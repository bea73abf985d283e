"""What stands still is recognised over time and left out: floor, walls, trees."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

_FRAMES_FOR_MEDIAN = 61
_WOBBLE_M = 0.15


@dataclass(frozen=True, kw_only=True, eq=False)
class Background:
    """The depth that every pixel comes back to."""

    depth: Float32[np.ndarray, "row column"]
    """Metres; NaN where nothing stands still."""
    tolerance_m: float
    """A return nearer than this to the background belongs to it."""

    def wobble(self, depth: Float32[np.ndarray, "row column"]) -> float:
        """The offset of the whole frame against the background, metres.

        Time-of-flight cameras shift a whole frame by some centimetres. It is the median over the pixels
        that come within 15 cm of the background; 0 where there are none.
        """
        residual = depth - self.depth
        near = residual[np.abs(residual) < _WOBBLE_M]
        return float(np.median(near)) if near.size else 0.0

    def moving(self, depth: Float32[np.ndarray, "row column"]) -> Bool[np.ndarray, "row column"]:
        """The returns that are no background, neither as it stands nor shifted by the frame's wobble."""
        residual = depth - self.depth
        still = np.abs(residual) < self.tolerance_m
        still |= np.abs(residual - self.wobble(depth)) < self.tolerance_m
        return np.isfinite(depth) & ~still


def background(depths: Sequence[Float32[np.ndarray, "row column"]], *, tolerance_m: float) -> Background:
    """What stands still in the recording.

    A pixel's usual depth is the median of its returns, less each frame's wobble: else pixels that were
    hidden in other frames would take their depth from other shifts. It is background if at least half of
    the returns agree with it, and if they do so over at least half of the recording's time: someone who
    passes agrees with himself for a moment only.
    """
    rough = Background(depth=usual_depth(depths), tolerance_m=tolerance_m)
    usual = usual_depth([depth - np.float32(rough.wobble(depth)) for depth in depths])
    first = np.full(usual.shape, len(depths))
    last = np.full(usual.shape, -1)
    agreeing = np.zeros(usual.shape, int)
    returns = np.zeros(usual.shape, int)
    whole = Background(depth=usual, tolerance_m=tolerance_m)
    for number, depth in enumerate(depths):
        seen = np.isfinite(depth)
        agrees = seen & ~whole.moving(depth)
        returns += seen
        agreeing += agrees
        first = np.where(agrees, np.minimum(first, number), first)
        last = np.where(agrees, number, last)
    lasting = (last - first + 1 >= len(depths) / 2) & (agreeing >= returns / 2) & (agreeing >= 2)
    return Background(depth=np.where(lasting, usual, np.float32(np.nan)), tolerance_m=tolerance_m)


def usual_depth(depths: Sequence[Float32[np.ndarray, "row column"]]) -> Float32[np.ndarray, "row column"]:
    """The median of every pixel's returns over up to 61 frames spread over the recording; NaN without any."""
    chosen = np.unique(np.linspace(0, len(depths) - 1, _FRAMES_FOR_MEDIAN).round().astype(int))
    ordered = np.sort(np.stack([depths[number] for number in chosen]), axis=0)  # NaN goes last.
    count = np.isfinite(ordered).sum(axis=0)
    middle = np.maximum(count - 1, 0) // 2
    return np.take_along_axis(ordered, middle[None], axis=0)[0]
