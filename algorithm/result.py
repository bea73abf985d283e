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
    completed = np.concatenate([np.zeros(0, int), *parts])
    count = len(completed)
    index = np.concatenate([trajectories.trajectory, completed])
    number = _joined_numbers(solution)[index]
    frame = _stacked(trajectories.frame, solution, "frame")
    order = np.lexsort((frame, number))
    return Motions(
        frame=frame.astype(np.int32),
        trajectory=number.astype(np.int32),
        position=_stacked(trajectories.position, solution, "position").astype(np.float32),
        column_row=np.concatenate([trajectories.column_row, np.full((count, 2), np.nan)]).astype(np.float32),
        segment=solution.segments[index].astype(np.int32),
        motion=motion[index].astype(np.int32),
        source=_stacked(np.full(len(trajectories.frame), OBSERVED), solution, "source").astype(np.uint8),
        confidence=_stacked(np.ones(len(trajectories.frame)), solution, "confidence").astype(np.float32),
        representatives=tuple(_representative(number, found) for number, found in enumerate(solution.motions)),
        links=solution.links,
        alternatives=solution.alternatives,
        events=solution.events,
        making=making,
    ).rows(order)


def _stacked(observed: np.ndarray, solution: Solution, name: str) -> np.ndarray:
    """A column of the observed rows, followed by that of the completed ones."""
    return np.concatenate([observed, *(getattr(motion.completion, name) for motion in solution.motions)])


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
