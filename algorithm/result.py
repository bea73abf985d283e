"""The solver's answer as the rows that `motions.parquet` holds."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from algorithm.completion import Completion
from algorithm.representative import Curve
from algorithm.trajectories import Trajectories
from recording.motions import NOISE, OBSERVED, Event, Link, Making, Motions, Representative


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """Segments that are one motion."""

    segments: tuple[int, ...]
    """In order of time."""
    curve: Curve
    """Its representative."""
    members: Bool[np.ndarray, "trajectory"]
    """Which trajectories belong to it."""
    completion: Completion
    """In numbers of the members."""


Keep = Callable[[Bool[np.ndarray, "trajectory"], Int[np.ndarray, "member"], Callable[[], Motion]], Motion]
"""Gives the motion of some members, whose segments are told: made now by what is told last, or at another time."""


def made_now(
    _members: Bool[np.ndarray, "trajectory"], _segments: Int[np.ndarray, "member"], make: Callable[[], Motion]
) -> Motion:
    """The motion, made now."""
    return make()


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """What the algorithm found."""

    trajectories: Trajectories
    segments: Int[np.ndarray, "trajectory"]
    """-1 for noise."""
    motions: tuple[Motion, ...]
    links: tuple[Link, ...]
    alternatives: tuple[Link, ...] = ()
    """Links that might have been made instead."""
    events: tuple[Event, ...] = ()
    """Of motions that merge or split, which are numbered as in `motions`."""


def motions_of(solution: Solution, making: Making) -> Motions:
    """The solution as rows, with how it was made."""
    trajectories = solution.trajectories
    motion = np.full(trajectories.count, NOISE)
    for number, found in enumerate(solution.motions):
        motion[found.members] = number
    parts = [np.flatnonzero(found.members)[found.completion.trajectory] for found in solution.motions]
    index = np.concatenate([trajectories.trajectory, *parts], dtype=np.int32)
    trajectory = _joined_numbers(solution)[index].astype(np.int32)
    frame = _stacked(trajectories.frame, solution, "frame", np.int32)
    order = np.lexsort((frame, trajectory))
    index = index[order]
    count = len(order) - len(trajectories.frame)
    nowhere = np.full((count, 2), np.nan, np.float32)
    return Motions(
        frame=frame[order],
        trajectory=trajectory[order],
        position=_stacked(trajectories.position, solution, "position", np.float32)[order],
        column_row=np.concatenate([trajectories.column_row, nowhere], dtype=np.float32)[order],
        segment=solution.segments.astype(np.int32)[index],
        motion=motion.astype(np.int32)[index],
        source=_stacked(np.full(len(trajectories.frame), OBSERVED, np.uint8), solution, "source", np.uint8)[order],
        confidence=_stacked(np.ones(len(trajectories.frame), np.float32), solution, "confidence", np.float32)[order],
        representatives=tuple(_representative(number, found) for number, found in enumerate(solution.motions)),
        links=solution.links,
        alternatives=solution.alternatives,
        events=solution.events,
        making=making,
    )


def _stacked(observed: np.ndarray, solution: Solution, name: str, kind: type[np.generic]) -> np.ndarray:
    """A column of the observed rows, followed by that of the completed ones."""
    parts = [getattr(motion.completion, name) for motion in solution.motions]
    return np.concatenate([observed, *parts], dtype=kind, casting="unsafe")


def _joined_numbers(solution: Solution) -> Int[np.ndarray, "trajectory"]:
    """A number for every trajectory, the same for those that completion joined."""
    count = solution.trajectories.count
    before, after = [np.zeros(0, int)], [np.zeros(0, int)]
    for motion in solution.motions:
        members = np.flatnonzero(motion.members)
        before.append(members[motion.completion.joins[0]])
        after.append(members[motion.completion.joins[1]])
    ends = (np.concatenate(before), np.concatenate(after))
    graph = sparse.coo_array((np.ones(len(ends[0])), ends), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _representative(number: int, motion: Motion) -> Representative:
    return Representative(
        motion=number,
        frame=motion.curve.frames.astype(np.int32),
        position=motion.curve.position,
        observed=motion.curve.observed,
    )
