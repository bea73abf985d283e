"""Motions as the viewer shows them, and how good they are where the truth is known."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float32

from evaluation.completion import CentreErrors, PointErrors, centre_errors
from evaluation.identity import places_of
from evaluation.scores import Evidence, Scores, evidence_of, hidden_points, scores_of
from recording.motions import Motions, Representative, mean_places
from recording.recording import Recording
from recording.visibility import Visibility


@dataclass(frozen=True, kw_only=True, eq=False)
class Match:
    """The object that a motion stands for."""

    name: str
    f: float
    """How well their points agree, 0 to 1 (`evaluation.segmentation.motions_of_objects`)."""
    hidden: CentreErrors
    """The motion's distance from the object's centre in its hidden frames."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Judgement:
    """What the truth says of motions."""

    scores: Scores
    error_m: Float32[np.ndarray, "observation"]
    """Of completed points of hidden objects the distance from the true place; NaN elsewhere."""
    matches: Mapping[int, Match]
    """By motion."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """Motions, judged or not yet."""

    motions: Motions
    judgement: Judgement | None = None

    @cached_property
    def curves(self) -> tuple[Representative, ...]:
        """The place of every motion over time."""
        return self.motions.representatives or mean_places(self.motions)

    def name(self, motion: int) -> str:
        """A motion's name, with that of its object where it is known."""
        match = self.judgement.matches.get(motion) if self.judgement else None
        return f"{motion}: {match.name}" if match else f"motion {motion}"


def judged(recording: Recording, motions: Motions, visibility: Visibility) -> Judgement | None:
    """The judgement; None where the recording holds no truth."""
    if not visibility.labelled:
        return None
    evidence = evidence_of(recording, motions, visibility)
    return Judgement(
        scores=scores_of(evidence),
        error_m=row_errors(motions, hidden_points(evidence)),
        matches=_matches(evidence),
    )


def row_errors(motions: Motions, errors: PointErrors | None) -> Float32[np.ndarray, "observation"]:
    """The errors of points at the rows of the motions that they were computed from; NaN where there is none."""
    found = np.full(len(motions), np.nan, np.float32)
    if errors is not None and len(errors.frame):
        frames = max(int(motions.frame.max()), int(errors.frame.max())) + 1
        key = motions.trajectory.astype(np.int64) * frames + motions.frame  # Ascending, for the rows are sorted so.
        found[np.searchsorted(key, errors.trajectory * frames + errors.frame)] = errors.error_m
    return found


def _matches(evidence: Evidence) -> dict[int, Match]:
    names = {entry.id: entry.name for entry in evidence.recording.metadata.objects or ()}
    places = places_of(evidence.motions, evidence.recording.metadata.frames)
    return {
        motion: Match(
            name=names.get(objectid, f"object {objectid}"),
            f=f,
            hidden=centre_errors(evidence.visibility, places, {objectid: motion}),
        )
        for objectid, (motion, f) in evidence.motion_of.items()
    }
