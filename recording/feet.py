"""Feet that stand: how far a foot on the ground slides, and how deep it sinks, by the mesh alone.

Nothing is asked about gait or skeleton. A vertex *stands* in a frame where it is one of the lowest of its body
and near the ground; while it stands, frame after frame, it must stay where it came down.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float64

from recording.truth import MeshSequence

NEAR_GROUND_M = 0.01
"""A vertex stands only below this height above the ground, z = 0."""
LOWEST_M = 0.002
"""A vertex stands only within this height above the lowest of its body: a foot that swings over the ground does
not, nor does the sole that rolls off it."""


def foot_slide_m(mesh: MeshSequence) -> float:
    """The longest way, along the ground, that any vertex gets from where it came down while it stands, metres.

    0 for a body that never stands. World axes, z up, the ground at z = 0.
    """
    came_down = np.full((mesh.vertices.shape[1], 2), np.nan)
    slide = 0.0
    for vertices, stands in _moments(mesh):
        before = stands & np.isfinite(came_down[:, 0])
        came_down[~before] = np.where(stands[~before, None], vertices[~before, :2], np.nan)
        way = np.linalg.norm(vertices[before, :2] - came_down[before], axis=1)
        slide = max(slide, float(way.max(initial=0.0)))
    return slide


def foot_sink_m(mesh: MeshSequence) -> float:
    """How far the lowest vertex of any frame lies below the ground z = 0, metres; 0 where none does."""
    return max(0.0, -float(mesh.vertices[..., 2].min()))


def _moments(
    mesh: MeshSequence,
) -> Iterator[tuple[Float64[np.ndarray, "vertex 3"], Bool[np.ndarray, "vertex"]]]:
    """The vertices of each frame, and which of them stand."""
    for vertices in mesh.vertices:
        height = vertices[:, 2].astype(np.float64)
        limit = min(NEAR_GROUND_M, float(height.min()) + LOWEST_M)
        yield vertices.astype(np.float64), height <= limit
