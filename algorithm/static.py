"""What stands still is recognised over time and left out: floor, walls, trees."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int

from algorithm.at_hand import AtHand
from recording.over_time import quantile_over_time, spread_numbers, stacked, wobble_m

_FRAMES_FOR_MEDIAN = 61
_SHARE, _SIGMAS = 0.75, 1.1503
"""So large a share of what is normal lies within so many standard deviations. Of rounded depths the median is 0."""
_SPREADS = 3.0
"""A return within so many standard deviations of its pixel's usual depth stands still ..."""
_WIDEST_M = 0.3
"""... but none that is farther from it than this, metres."""
_USUAL_SHARE, _BEYOND_USUAL = 0.3, 4.0
"""So large a share of the pixels scatters less than is usual, for in most of them things may move; and a pixel that
scatters this much more than usual sees things move."""
_SECOND = np.float32(np.sqrt(6.0))
"""Standard deviations of noise in its second difference, a - 2 b + c."""
_LEAST_PRESENCE = 0.25
"""What stands still is seen in so large a share of the frames ..."""
_OPEN_SHARE = 0.6
"""... and in so large a share of those in which nothing nearer hides it: a ball that is juggled before nothing comes
back to its pixels at the same depth, but it is away in between ..."""
_FLICKER = 0.8
"""... or else it comes and goes from frame to frame at least this much as often as at random, as faint returns do. A
ball stays for some frames and stays away for some: .1 to .7; of the returns of a far floor 98 % are above .82."""
_AROUND_PX = (5, 5)


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
        return wobble_m(depth - self.depth)

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
    someone who passes agrees with himself for a moment only. What is juggled before nothing is gone between two
    throws: so where nothing nearer hides it, the background is seen most of the time, or flickers.
    """
    same = np.full(depths[0].shape, tolerance_m, np.float32)
    rough = Background(depth=usual_depth(depths), tolerance_m=same)
    offsets = [np.float32(rough.wobble(depth)) for depth in depths]
    level = AtHand(lambda number: depths[number] - offsets[number], len(depths))
    usual = usual_depth(level)
    tolerance = np.clip(_SPREADS * noise_of_pixels(level, usual), tolerance_m, max(_WIDEST_M, tolerance_m))
    still = _stands_still(level, Background(depth=usual, tolerance_m=tolerance))
    return Background(depth=np.where(still, usual, np.float32(np.nan)), tolerance_m=tolerance)


def _stands_still(
    depths: Sequence[Float32[np.ndarray, "row column"]], usual: Background
) -> Bool[np.ndarray, "row column"]:
    """The pixels whose usual depth belongs to something that stands still."""
    presence = _presence(depths, usual)
    times = presence.times
    often = (times >= presence.seen / 2) & (times >= len(depths) * _LEAST_PRESENCE) & (times >= 2)
    lasting = presence.last - presence.first + 1 >= len(depths) / 2
    stays = times >= _OPEN_SHARE * presence.visible
    return often & lasting & (stays | _flickers(presence))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Presence:
    """In how many frames each pixel shows what."""

    seen: Int[np.ndarray, "row column"]
    """A return."""
    times: Int[np.ndarray, "row column"]
    """Its usual depth."""
    visible: Int[np.ndarray, "row column"]
    """Its usual depth, or nothing that is nearer."""
    pairs: Int[np.ndarray, "row column"]
    """So also in the frame before."""
    changes: Int[np.ndarray, "row column"]
    """And of these two in one alone its usual depth."""
    first: Int[np.ndarray, "row column"]
    """The first frame with its usual depth; 0 without any."""
    last: Int[np.ndarray, "row column"]
    """The last one."""


def _presence(depths: Sequence[Float32[np.ndarray, "row column"]], usual: Background) -> _Presence:
    counts = {field.name: np.zeros(usual.depth.shape, np.int32) for field in fields(_Presence)}
    agreed = was_visible = np.zeros(usual.depth.shape, bool)
    for number, depth in enumerate(depths):
        seen = np.isfinite(depth)
        agrees = seen & ~usual.moving(depth)
        visible = agrees | ~(depth < usual.depth - usual.tolerance_m)  # Nothing is not nearer.
        pairs = visible & was_visible
        counts["first"][agrees & (counts["times"] == 0)] = number
        counts["last"][agrees] = number
        now = {"seen": seen, "times": agrees, "visible": visible, "pairs": pairs, "changes": pairs & (agrees != agreed)}
        for name, where in now.items():
            counts[name] += where
        agreed, was_visible = agrees, visible
    return _Presence(**counts)


def _flickers(presence: _Presence) -> Bool[np.ndarray, "row column"]:
    """Where what is seen in some of the frames in which it might be changes from frame to frame as if at random.

    At random it changes in 2 p (1 - p) of the pairs of consecutive frames, where p is the share in which it is seen.
    Changes are counted over 5x5 pixels, for in a second one pixel says too little.
    """
    share = presence.times / np.maximum(presence.visible, 1)
    at_random = 2 * share * (1 - share) * presence.pairs
    changes = presence.changes.astype(np.float64)
    around, around_at_random = (cv2.boxFilter(each, -1, _AROUND_PX) for each in (changes, at_random))
    return np.asarray(around >= _FLICKER * around_at_random)


def usual_depth(depths: Sequence[Float32[np.ndarray, "row column"]]) -> Float32[np.ndarray, "row column"]:
    """The median of every pixel's returns over up to 61 frames spread over the recording; NaN without any."""
    chosen = spread_numbers(len(depths), _FRAMES_FOR_MEDIAN)
    some = stacked((depths[number] for number in chosen), count=len(chosen), shape=depths[0].shape)
    return quantile_over_time(some, 0.5)


def noise_of_pixels(
    depths: Sequence[Float32[np.ndarray, "row column"]], usual: Float32[np.ndarray, "row column"]
) -> Float32[np.ndarray, "row column"]:
    """The standard deviation of every pixel's returns that is noise, metres; NaN where the usual depth is.

    It is what scatters from frame to frame, but not more than four times what is usual in the recording at that depth,
    with noise that grows as depth squared: where arms and balls go by, returns scatter without noise.
    """
    known = np.isfinite(usual)
    if not known.any():
        return usual
    spread = np.where(known, noise_in_time(depths), np.float32(np.nan))
    usual_noise = np.quantile((spread / usual**2)[known], _USUAL_SHARE) * usual**2
    return np.minimum(spread, np.float32(_BEYOND_USUAL) * usual_noise).astype(np.float32)


def noise_in_time(depths: Sequence[Float32[np.ndarray, "row column"]]) -> Float32[np.ndarray, "row column"]:
    """The standard deviation of every pixel's second differences in time, by three quarters; 0 without any.

    The spread about the usual depth would be no noise where somebody walks by: before nothing, each pixel sees a body
    of 20 cm and nothing else. From frame to frame its surface passes evenly, and second differences leave that out.
    """
    if len(depths) < 3:
        return np.zeros(depths[0].shape, np.float32)
    chosen = spread_numbers(len(depths) - 2, _FRAMES_FOR_MEDIAN)
    bends = (np.abs(depths[number] - 2 * depths[number + 1] + depths[number + 2]) for number in chosen)
    every = stacked(bends, count=len(chosen), shape=depths[0].shape)
    return np.nan_to_num(quantile_over_time(every, _SHARE) / np.float32(_SIGMAS * _SECOND))
