"""A user who knows the truth and corrects a solution by hand, the worst mistake first."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

from algorithm.settings import Settings
from algorithm.staged import solve
from evaluation.mistakes import Mistake, mistakes
from evaluation.scores import Scores, evidence_of, scores_of
from recording.cache import Cache
from recording.corrections import Correction, Corrections
from recording.errors import InputError
from recording.recording import Recording
from recording.visibility import Visibility, visibility_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Guided:
    """A solution after some corrections."""

    corrections: Corrections
    scores: Scores
    mistakes: tuple[Mistake, ...]
    """That are left."""
    seconds: float
    """That the solve took."""

    @property
    def perfect(self) -> bool:
        """Whether every object is found and no link is wrong."""
        motions, links = self.scores["motions"], self.scores["links"]
        return bool(motions["found"] == self.scores["objects"] and links["precision"] in (None, 1.0))


def guided(
    recording: Recording, settings: Settings | None = None, *, cache: Cache | None = None, most: int = 20
) -> Iterator[Guided]:
    """The solution as it is, then after each further correction, until no mistake is left or `most` were made.

    The user says what is right of the mistake that concerns the most points. What he said already, and what the solver
    refuses, he does not say again.
    """
    visibility = visibility_of(recording)
    said: set[Correction] = set()
    state = _solved(recording, settings, cache, Corrections(recording_digest=recording.digest()), visibility)
    yield state
    while len(state.corrections.correction) < most:
        fresh = [mistake.correction for mistake in state.mistakes if mistake.correction not in said]
        if not fresh:
            return
        said.add(fresh[0])
        try:
            state = _solved(recording, settings, cache, state.corrections.plus(fresh[0]), visibility)
        except InputError:
            continue
        yield state


def _solved(
    recording: Recording,
    settings: Settings | None,
    cache: Cache | None,
    corrections: Corrections,
    visibility: Visibility,
) -> Guided:
    begun = time.perf_counter()
    motions = solve(recording, settings, cache=cache, corrections=corrections)
    seconds = time.perf_counter() - begun
    evidence = evidence_of(recording, motions, visibility)
    return Guided(
        corrections=corrections,
        scores=scores_of(evidence),
        mistakes=tuple(mistakes(evidence.observations, recording.camera)),
        seconds=seconds,
    )
