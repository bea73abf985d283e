"""Answers that a stage of the algorithm gets from elsewhere, so that the error falls apart by stage."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from algorithm.scene_flow import FlowBetween
from algorithm.trajectories import Trajectories

Segments = Int[np.ndarray, "trajectory"]
"""The segment of every trajectory, from 0 without gaps; -1 for noise."""
Segmenter = Callable[[Trajectories], Segments]
Linker = Callable[[Trajectories, Segments], Sequence[tuple[int, int]]]
"""Gives the pairs of segments that go on as one another; the first of each ends before the second begins."""


@dataclass(frozen=True, kw_only=True)
class Given:
    """What takes the place of a stage; None leaves the stage to the algorithm."""

    flow: FlowBetween | None = None
    """Instead of optical flow (step 1)."""
    segments: Segmenter | None = None
    """Instead of affinity and clustering (steps 5 and 6)."""
    links: Linker | None = None
    """Instead of the assignment of segments (step 9); the polynomials between them stay the algorithm's."""


NOTHING_GIVEN = Given()
