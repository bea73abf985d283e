"""What stands still is recognised over time and left out: floor, walls, trees."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

_FRAMES_FOR_MEDIAN = 61
_WOBBLE_M = 0.15
_SHARE, _SIGMAS = 0.75, 1.1503
"""So large a share of what is normal lies within so many standard deviations. Of rounded depths the median is 0."""
_SPREADS = 3.0
"""A return within so many standard deviations of its pixel's usual depth stands still ..."""
_WIDEST_M = 0.3
"""... but none that is farther from it than this, metres."""
_USUAL_SHARE, _BEYOND_USUAL = 0.6, 4.0
"""So large a share of the pixels shows what noise is usual; a pixel that scatters this much more sees things move."""
_LEAST_PRESENCE = 0.25
"""What stands still is seen in so large a share of the frames. A ball that is juggled before nothing comes back to
its pixels at the same depth, and to most of them for less."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Background:
    """The depth that every pixel comes back to."""

    depth: Float32[np.ndarray, "row column"]
    """Metres; NaN where nothing stands still."""
    tolerance_m: Float32[np.ndarray, "row column"]
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
    the returns agree with it, in at least a quarter of the frames, over at least half of the recording's time:
    someone who passes agrees with himself for a moment only, and what is juggled is gone between two throws.
    """
    same = np.full(depths[0].shape, tolerance_m, np.float32)
    rough = Background(depth=usual_depth(depths), tolerance_m=same)
    level = [depth - np.float32(rough.wobble(depth)) for depth in depths]
    usual = usual_depth(level)
    tolerance = np.clip(_SPREADS * noise_of_pixels(level, usual), tolerance_m, max(_WIDEST_M, tolerance_m))
    first = np.full(usual.shape, len(depths))
    last = np.full(usual.shape, -1)
    agreeing = np.zeros(usual.shape, int)
    returns = np.zeros(usual.shape, int)
    whole = Background(depth=usual, tolerance_m=tolerance)
    for number, depth in enumerate(depths):
        seen = np.isfinite(depth)
        agrees = seen & ~whole.moving(depth)
        returns += seen
        agreeing += agrees
        first = np.where(agrees, np.minimum(first, number), first)
        last = np.where(agrees, number, last)
    often = (agreeing >= returns / 2) & (agreeing >= len(depths) * _LEAST_PRESENCE) & (agreeing >= 2)
    lasting = often & (last - first + 1 >= len(depths) / 2)
    return Background(depth=np.where(lasting, usual, np.float32(np.nan)), tolerance_m=tolerance)


def usual_depth(depths: Sequence[Float32[np.ndarray, "row column"]]) -> Float32[np.ndarray, "row column"]:
    """The median of every pixel's returns over up to 61 frames spread over the recording; NaN without any."""
    return _quantile(np.stack([depths[number] for number in _spread_frames(len(depths))]), 0.5)


def noise_of_pixels(
    depths: Sequence[Float32[np.ndarray, "row column"]], usual: Float32[np.ndarray, "row column"]
) -> Float32[np.ndarray, "row column"]:
    """The standard deviation of every pixel's returns that is noise, metres; NaN where the usual depth is.

    It is their spread about the usual depth, but not more than four times what is usual in the recording at that
    depth, with noise that grows as depth squared: where arms and balls go by, returns scatter without noise.
    """
    known = np.isfinite(usual)
    if not known.any():
        return usual
    spread = usual_spread(depths, usual)
    usual_noise = np.quantile((spread / usual**2)[known], _USUAL_SHARE) * usual**2
    return np.minimum(spread, np.float32(_BEYOND_USUAL) * usual_noise).astype(np.float32)


def usual_spread(
    depths: Sequence[Float32[np.ndarray, "row column"]], usual: Float32[np.ndarray, "row column"]
) -> Float32[np.ndarray, "row column"]:
    """The standard deviation of every pixel's returns about its usual depth, by three quarters; 0 without any."""
    off = np.stack([np.abs(depths[number] - usual) for number in _spread_frames(len(depths))])
    return np.nan_to_num(_quantile(off, _SHARE) / np.float32(_SIGMAS))


def _spread_frames(count: int) -> list[int]:
    return np.unique(np.linspace(0, count - 1, _FRAMES_FOR_MEDIAN).round().astype(int)).tolist()


def _quantile(values: Float32[np.ndarray, "frame row column"], share: float) -> Float32[np.ndarray, "row column"]:
    """The largest of the lower share of the values over the frames, NaN left out."""
    ordered = np.sort(values, axis=0)  # NaN goes last.
    place = (share * np.maximum(np.isfinite(ordered).sum(axis=0) - 1, 0)).astype(int)
    return np.take_along_axis(ordered, place[None], axis=0)[0]
