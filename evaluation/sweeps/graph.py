"""A sweep as one graph of tasks: what points share is a task that they share."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from algorithm.settings import Settings
from algorithm.staged import Course
from algorithm.stages import STAGES, Flowing, Grouped, Observed, keys_of
from evaluation.scores import Scores, scores
from evaluation.sweeps.subject import Subject
from recording.cache import Cache, Form, kept, key_of
from recording.cluster import Task, TaskRef, require_code
from recording.code import code_digest
from recording.recording import Recording
from recording.store import load_recording
from recording.visibility import Visibility, visibility_of

_CODE = ("evaluation.sweeps.graph",)
_AT_HAND = 4
"""Recordings that a worker has open."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A recording under some settings, for a worker that may know nothing of it yet."""

    subject: Subject
    settings: Settings
    cache: Cache | None
    code: str
    """Digest of the code that the results are to come from."""

    def course(self) -> Course:
        """The solver's way through it; InputError where this process has other code."""
        require_code(self.code, *_CODE)
        recording = _recording(self.subject.place, self.subject.files)
        return Course(recording=recording, digest=self.subject.digest, settings=self.settings, cache=self.cache)

    def scores_key(self) -> str:
        """What the scores are made of."""
        motions = keys_of(self.subject.digest, self.settings)["motions"]
        document = {"before": motions, "recording": self.subject.files, "code": code_digest("evaluation.scores")}
        return key_of("scores", document)


def trial_of(subject: Subject, settings: Settings, cache: Cache | None) -> Trial:
    """The trial of the settings, by the code of this process."""
    return Trial(subject=subject, settings=settings, cache=cache, code=code_digest(*_CODE))


def graph_of(trials: Iterable[Trial]) -> dict[str, Task]:
    """The tasks of the trials: for each its scores, and once each what they are made of.

    Keys are those of the cache, hence the same for what is the same. What the cache holds already needs nothing made
    before it; and a worker that lacks something after all, for it has another disk, makes it itself.
    """
    tasks: dict[str, Task] = {}
    for trial in trials:
        key = trial.scores_key()
        if key not in tasks:
            tasks[key] = Task(key, _scores, trial, None, None)
            if not _holds(trial.cache, key):
                tasks.update(_stages(trial, key))
    return tasks


def _stages(trial: Trial, key: str) -> Iterator[tuple[str, Task]]:
    """The tasks that a trial's scores are made by."""
    keys = keys_of(trial.subject.digest, trial.settings)
    flow, trajectories, segments = (keys[stage] for stage in STAGES[:3])
    seen = f"visibility-{trial.subject.files}"
    yield key, Task(key, _scores, trial, TaskRef(segments), TaskRef(seen))
    yield seen, Task(seen, _visibility, trial)
    yield segments, Task(segments, _grouped, trial, TaskRef(trajectories))
    if _holds(trial.cache, trajectories):
        yield trajectories, Task(trajectories, _observed, trial, ())
    else:
        yield trajectories, Task(trajectories, _observed, trial, TaskRef(flow))
        yield flow, Task(flow, _flowing, trial)


def _holds(cache: Cache | None, key: str) -> bool:
    return cache is not None and cache.holds(key)


def _flowing(trial: Trial) -> tuple[Flowing, ...]:
    return trial.course().flowing()


def _observed(trial: Trial, flowing: tuple[Flowing, ...]) -> Observed:
    return trial.course().observed(flowing)


def _grouped(trial: Trial, observed: Observed) -> Grouped:
    return trial.course().grouped(observed)


def _visibility(trial: Trial) -> Visibility:
    return visibility_of(trial.course().recording)


def _scores(trial: Trial, grouped: Grouped | None, visibility: Visibility | None) -> Scores:
    course = trial.course()
    key = trial.scores_key()
    return kept(trial.cache, key, lambda: scores(course.recording, course.motions(grouped), visibility), SCORES)


def _write(found: Scores, path: Path) -> None:
    path.write_text(json.dumps(found, allow_nan=False), encoding="utf-8")


def _read(path: Path) -> Scores:
    return dict(json.loads(path.read_text(encoding="utf-8")))


SCORES: Form[Scores] = Form(read=_read, write=_write)


@lru_cache(maxsize=_AT_HAND)
def _recording(place: str, files: str) -> Recording:
    """The recording, opened once while its files are the same."""
    del files  # Part of what it is known by.
    return load_recording(place)
