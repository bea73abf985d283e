"""The unit of the paper's thresholds: the mean distance between neighbouring points."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float32
from scipy.spatial import cKDTree

from recording.camera import Camera
from recording.over_time import spread_numbers

_FRAMES = 12


def mean_point_spacing(depths: Sequence[Float32[np.ndarray, "row column"]], *, camera: Camera) -> float:
    """The mean 3D distance of a return to the nearest other return of its frame, metres.

    Over up to twelve frames spread over the recording. NaN where no frame has two returns.
    """
    nearest = []
    for number in spread_numbers(len(depths), _FRAMES):
        points = camera.world_points(depths[number])
        points = points[np.isfinite(depths[number])]
        if len(points) > 1:
            nearest.append(cKDTree(points).query(points, k=2)[0][:, 1])
    return float(np.concatenate(nearest).mean()) if nearest else float("nan")
