"""How noisy the depth of a surface is, from the recording alone."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float32

from recording.over_time import spread_numbers

_FRAMES = 12
_BINOMIAL = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
"""The fourth difference: what is smooth vanishes in it, noise of a standard deviation s has sqrt(70) s."""
_SHARE, _SIGMAS = 0.7, 1.0364
"""So large a share of what is normal lies within so many standard deviations. Of rounded depths the median is 0."""
_JUMP_M = 1.0


def surface_noise_m(depths: Sequence[Float32[np.ndarray, "row column"]]) -> float:
    """The standard deviation of the depth of neighbouring pixels on a surface, metres; 0 where there is no surface.

    It is that of their fourth differences along rows and columns, over up to 12 frames spread over the recording.
    Above 5 cm it says too little, for differences of a metre are edges.
    """
    found = [np.zeros(0)]
    for number in spread_numbers(len(depths), _FRAMES):
        for depth in (depths[number], depths[number].T):
            if depth.shape[1] >= len(_BINOMIAL):
                windows = np.lib.stride_tricks.sliding_window_view(depth, len(_BINOMIAL), axis=1)
                difference = np.abs(windows @ _BINOMIAL)
                found.append(difference[difference < _JUMP_M])
    every = np.concatenate(found)
    if not every.size:
        return 0.0
    return float(np.quantile(every, _SHARE)) / (_SIGMAS * float(np.linalg.norm(_BINOMIAL)))
