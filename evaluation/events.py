"""Merging and splitting motions: whether a solver says when somebody takes hold of something, and lets it go."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool
from scipy.optimize import linear_sum_assignment

from recording.motions import Event, EventKind, Motions
from recording.recording import Recording

WITHIN_S = 0.3
"""An event this near in time to the true one is right, seconds."""


@dataclass(frozen=True, kw_only=True)
class TrueEvent:
    """An object that somebody catches or lets go."""

    kind: EventKind
    frame: int
    """The first frame in which both move as one, or apart."""
    objects: tuple[int, int]
    """What is carried, and who carries it."""


@dataclass(frozen=True, kw_only=True)
class EventCounts:
    """How many events there are, how many are told, and how many of these are right."""

    true: int
    told: int
    right: int

    @property
    def precision(self) -> float | None:
        """The share of the told events that are right, in [0, 1]; None where none is told."""
        return self.right / self.told if self.told else None

    @property
    def recall(self) -> float | None:
        """The share of the true events that are told, in [0, 1]; None where there is none."""
        return self.right / self.true if self.true else None


def true_events(recording: Recording) -> list[TrueEvent]:
    """What is caught and let go in the recording; what is held in its first or last frame begins or ends unseen."""
    events = []
    for each in recording.metadata.carried or ():
        objects = (each.object, each.by)
        if each.first > 0:
            events.append(TrueEvent(kind="merge", frame=each.first, objects=objects))
        if each.stop < recording.metadata.frames:
            events.append(TrueEvent(kind="split", frame=each.stop, objects=objects))
    return events


def event_counts(recording: Recording, motions: Motions, motion_of: Mapping[int, int]) -> EventCounts:
    """The events of the motions against the true ones.

    An event is right when its kind is that of a true one, its two motions are those of the true one's objects
    (`motion_of`), and its frame is at most 0.3 s off. Each true event makes one told event right, and no two true
    ones the same.
    """
    true = true_events(recording)
    fits = np.array([[_fits(told, event, motion_of, recording.fps) for told in motions.events] for event in true], bool)
    pairs = _most_pairs(fits.reshape(len(true), len(motions.events)))
    return EventCounts(true=len(true), told=len(motions.events), right=pairs)


def event_scores(counts: EventCounts) -> dict[str, Any]:
    """The counts, precision where any event is told, and recall where there is any."""
    shares = {"precision": counts.precision, "recall": counts.recall}
    known = {name: share for name, share in shares.items() if share is not None}
    return {"count": counts.told, "true": counts.true, **known}


def _fits(told: Event, true: TrueEvent, motion_of: Mapping[int, int], fps: float) -> bool:
    wanted = {motion_of.get(objectid) for objectid in true.objects}
    near = abs(told.frame - true.frame) <= WITHIN_S * fps + 1e-9
    return told.kind == true.kind and set(told.motions) == wanted and near


def _most_pairs(fits: Bool[np.ndarray, "event told"]) -> int:
    """How many events can be paired one to one with told ones that fit."""
    return int(fits[linear_sum_assignment(fits, maximize=True)].sum())
