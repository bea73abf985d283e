"""Step 4 of the paper: matches chained from frame to frame (paper, section 4, Trajectory computation)."""

from collections.abc import Iterable, Sequence

import numpy as np
from jaxtyping import Float32

from algorithm.matching import Pairs
from algorithm.observations import Observations
from recording.camera import pixel_grid


def chained(depths: Sequence[Float32[np.ndarray, "row column"]], matches: Iterable[Pairs]) -> list[Observations]:
    """Every point of every frame, on the trajectory that its matches make.

    `matches` are those of consecutive frames, one item less than frames. A point without a match before
    it begins a trajectory; one without a match after it ends it.
    """
    number = np.full(depths[0].size, -1)
    centre = pixel_grid(*depths[0].shape).reshape(-1, 2)
    history = []
    begun = 0
    for depth, (source, goal) in zip(depths, _after_nothing(matches), strict=True):
        carried = np.full(depth.size, -1)
        carried[goal] = number[source]
        fresh = np.isfinite(depth).ravel() & (carried < 0)
        carried[fresh] = begun + np.arange(fresh.sum())
        begun += int(fresh.sum())
        number = carried
        pixel = np.flatnonzero(number >= 0)
        history.append(
            Observations(
                number=number[pixel].astype(np.int32),
                column_row=centre[pixel].astype(np.float32),
                depth=depth.ravel()[pixel],
            )
        )
    return history


def _after_nothing(matches: Iterable[Pairs]) -> Iterable[Pairs]:
    """The matches into each frame; nothing leads into the first."""
    nothing = np.zeros(0, int)
    yield nothing, nothing
    yield from matches
