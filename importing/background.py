"""The background: the farthest depth that a pixel comes back to, whoever stands before it in between."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from importing.source import DepthSource
from recording.errors import InputError
from recording.over_time import quantile_over_time, spread_numbers, wobble_m
from recording.progress import tracked

LEAST_FRAMES = 10
"""Fewer do not tell what stands still from what is slow."""
_FRAMES = 61
"""So many frames, spread over the recording, say what the background is; no more are held in memory."""
_ROWS = 32
"""So many rows are looked at together, for which some copies of the frames are needed."""
_LEAST_SHARE = 0.1
"""Background is seen in so large a share of the frames ..."""
_OPEN_SHARE, _ALWAYS = 0.3, 0.9
"""... and in so large a share of those in which nothing nearer hides it: someone who passes before nothing is not. From
the first time to the last it is half of the recording, unless it is as good as always there when nothing hides it."""
_SPREADS, _NARROWEST_M, _WIDEST_M = 3.0, 0.03, 0.3
"""A return within so many standard deviations of its pixel's background belongs to it, within these bounds."""
_OF_QUARTER, _OF_THREE_QUARTERS = 0.4506, 1.6269
"""A quarter, and three, of the differences of two numbers are smaller than so many of their standard deviations."""
_USUAL_SHARE, _BEYOND_USUAL = 0.3, 4.0
"""So large a share of the pixels scatters less than is usual at its depth; what scatters this much more is no noise."""
_LEAST_PIXELS = 50


@dataclass(frozen=True, kw_only=True, eq=False)
class Background:
    """What stands still behind everything."""

    depth: Float32[np.ndarray, "row column"]
    """Metres; NaN where nothing stands still."""
    tolerance_m: Float32[np.ndarray, "row column"]
    """A return nearer than this to the background belongs to it."""

    def covers(self, depth: Float32[np.ndarray, "row column"]) -> Bool[np.ndarray, "row column"]:
        """Which returns are background, after the frame's own shift against it.

        At the edges of things pixels flicker from one side to the other: so the backgrounds of those beside count too.
        """
        level = depth - np.float32(wobble_m(depth - self.depth, least=_LEAST_PIXELS))
        height, width = depth.shape
        around = [np.pad(each, 1, constant_values=np.nan) for each in (self.depth, self.tolerance_m)]
        covered = np.zeros(depth.shape, bool)
        for down, across in np.ndindex(3, 3):
            still, tolerance = (each[down : down + height, across : across + width] for each in around)
            covered |= np.abs(level - still) <= tolerance  # NaN: no.
        return covered


def background_of(source: DepthSource) -> Background:
    """The background of a recording.

    It is the farthest depth that a pixel has, to within its noise, in a tenth of the frames or more, and again and
    again when nothing nearer is before it. So a place that a crowd leaves free for moments only counts by what is
    behind the crowd, and who stands still for long does not become a wall.
    """
    if source.count < LEAST_FRAMES:
        raise InputError(
            f"background: expected at least {LEAST_FRAMES} frames to tell what stands still, got {source.count}: leave "
            "--remove-background out"
        )
    depths = _level_frames(source)
    tolerance = np.clip(_SPREADS * _noise(depths), _NARROWEST_M, _WIDEST_M)
    depth = np.concatenate([_farthest(depths[:, rows], tolerance[rows]) for rows in _bands(depths.shape[1])])
    if not np.isfinite(depth).any():
        raise InputError(
            "background: expected something that stands still, found nothing: leave --remove-background out"
        )
    return Background(depth=depth, tolerance_m=tolerance)


def _level_frames(source: DepthSource) -> Float32[np.ndarray, "frame row column"]:
    """Some frames spread over the recording, each without its shift against the usual depth."""
    wanted = set(spread_numbers(source.count, _FRAMES))
    frames = tracked(source.frames(), "looking for the background", total=source.count)
    depths = np.stack([frame.depth for number, frame in enumerate(frames) if number in wanted])
    usual = quantile_over_time(depths, 0.5)
    for number, depth in enumerate(depths):
        depths[number] = depth - np.float32(wobble_m(depth - usual, least=_LEAST_PIXELS))
    return depths


def _noise(depths: Float32[np.ndarray, "frame row column"]) -> Float32[np.ndarray, "row column"]:
    """The standard deviation of each pixel's returns where it sees one thing, metres; NaN where it sees nothing twice.

    By the smaller differences of frames that follow one another, for the larger ones are somebody's. A pixel has at
    least what is usual in the recording, which grows as depth squared, and at most four times as much. What is usual is
    found in the pixels that few pass, by the larger differences: of rounded depths the smaller ones are 0.
    """
    few, many, squared = [], [], []
    for rows in _bands(depths.shape[1]):
        differences = np.abs(np.diff(depths[:, rows], axis=0))
        few.append(quantile_over_time(differences, 0.25) / np.float32(_OF_QUARTER))
        many.append(quantile_over_time(differences, 0.75) / np.float32(_OF_THREE_QUARTERS))
        squared.append(quantile_over_time(depths[:, rows], 0.5) ** 2)
    low, high, square = (np.concatenate(parts) for parts in (few, many, squared))
    known = np.isfinite(low)
    if not known.any():
        return low
    usual = np.float32(np.quantile((high / square)[known], _USUAL_SHARE)) * square
    return np.clip(low, usual, np.float32(_BEYOND_USUAL) * usual)


def _farthest(
    depths: Float32[np.ndarray, "frame row column"], tolerance: Float32[np.ndarray, "row column"]
) -> Float32[np.ndarray, "row column"]:
    """The farthest depth that each pixel comes back to; NaN where there is none."""
    count = len(depths)
    least = max(3, int(np.ceil(_LEAST_SHARE * count)))
    ordered = np.sort(depths, axis=0)  # NaN goes last.
    together = ordered[least - 1 :] - ordered[: count - least + 1] <= 2 * tolerance  # NaN: no.
    top = count - 1 - np.argmax(together[::-1], axis=0)
    high = np.take_along_axis(ordered, top[None], axis=0)[0]
    first = (ordered < high - 2 * tolerance).sum(axis=0)
    middle = np.take_along_axis(ordered, (first + top)[None] // 2, axis=0)[0]
    agrees = np.abs(depths - middle) <= tolerance
    open_ = ~(depths < middle - tolerance)  # Nothing is not nearer.
    times = agrees.sum(axis=0)
    lasting = count - np.argmax(agrees, axis=0) - np.argmax(agrees[::-1], axis=0) >= count / 2
    always = times >= _ALWAYS * open_.sum(axis=0)
    again = times >= _OPEN_SHARE * open_.sum(axis=0)
    still = together.any(axis=0) & (times >= least) & (always | (again & lasting))
    return np.where(still, middle, np.float32(np.nan))


def _bands(rows: int) -> list[slice]:
    return [slice(first, first + _ROWS) for first in range(0, rows, _ROWS)]
