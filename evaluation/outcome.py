"""What one method reaches on one recording, kept in a folder and used again while it holds."""

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import cv2

import algorithm
import evaluation
import recording as recording_package
from evaluation.methods import METHODS
from evaluation.scores import Scores, check_belongs, completion_by_length, evidence_of, scores_of
from recording.atomic import whole_file
from recording.checks import Frozen, json_document, validated
from recording.errors import InputError
from recording.motions import Motions
from recording.parquet import load_motions, save_motions
from recording.recording import Recording
from recording.store import load_recording
from recording.version import VERSION
from recording.visibility import Visibility, visibility_of

FAILURES = (ArithmeticError, MemoryError, OSError, RuntimeError, ValueError, cv2.error)
"""What a method may end with on a recording that it cannot deal with; it does not stop the others.

InputError and LinAlgError are ValueErrors, ARPACK's errors are RuntimeErrors. Anything else is a mistake of ours.
"""
_NUMBERED = re.compile(r"[-_]\d+$")
_EXACT = "ideal"
"""The sensor that needs no mention."""


class MadeOf(Frozen):
    """What an outcome depends on: another outcome is due where any of it is another."""

    recording_digest: str
    settings: dict[str, Any]
    """Of the method; of motions from elsewhere the digest of their file."""
    version: str
    code: str
    """Digest of the source of the algorithm, the baselines and the scores."""


class HiddenLength(Frozen):
    """The completion of all runs of hidden frames of one length; errors are None where nothing was completed."""

    seconds: float
    """Length of the runs."""
    object_frames: int
    recall: float
    points: int
    """Completed points with a known true place."""
    mean_m: float | None
    centres: int
    """Object-frames with a place of the object's motion."""
    centre_mean_m: float | None


class Outcome(Frozen):
    """The scores of a method on a recording, or why there are none."""

    recording: str
    """Its place below the folder that all recordings of the comparison lie in."""
    name: str
    """As the recording calls itself."""
    seed: int | None
    sensor: str | None
    """Preset of the simulated sensor."""
    method: str
    made_of: MadeOf
    scores: Scores | None = None
    by_length: tuple[HiddenLength, ...] = ()
    failure: str | None = None

    @property
    def group(self) -> str:
        """The kind of recording: its name without the number that a data set gives it, `/`, sensor unless `ideal`."""
        kind = _NUMBERED.sub("", self.name)
        return kind if self.sensor in (None, _EXACT) else f"{kind}/{self.sensor}"


@dataclass(frozen=True, kw_only=True)
class Contest:
    """Some methods on one recording: a task for a worker, which reports the outcomes."""

    place: Path
    """Of the recording."""
    label: str
    methods: tuple[str, ...]
    files: Mapping[str, Path]
    """The motions of methods from elsewhere."""
    folder: Path
    """To keep outcomes in."""
    overwrite: bool
    """Whether what is kept is made again."""

    def reports(self) -> Iterator[Outcome]:
        """The outcome of each method; InputError where motions from elsewhere cannot be of the recording."""
        subject = _Subject(load_recording(self.place))
        for method in self.methods:
            folder = self.folder / f"{self.place.resolve().name}-{subject.digest[:12]}" / method
            made_of = MadeOf(
                recording_digest=subject.digest,
                settings=self._settings(method, subject.recording),
                version=VERSION,
                code=code_digest(),
            )
            known = None if self.overwrite else _kept(folder, made_of)
            if known is not None:
                yield known.model_copy(update={"recording": self.label})
            else:
                outcome = self._made(method, subject, folder, made_of)
                _keep(outcome, folder)
                yield outcome

    def _settings(self, method: str, recording: Recording) -> dict[str, Any]:
        if method in self.files:
            return {"file": hashlib.sha256(self.files[method].read_bytes()).hexdigest()}
        return METHODS[method].settings(recording)

    def _made(self, method: str, subject: "_Subject", folder: Path, made_of: MadeOf) -> Outcome:
        metadata = subject.recording.metadata
        sensor = (metadata.sensor or {}).get("preset")
        outcome = Outcome(
            recording=self.label,
            name=metadata.name or self.place.resolve().name,
            seed=metadata.seed,
            sensor=None if sensor is None else str(sensor),
            method=method,
            made_of=made_of,
        )
        if method in self.files:
            motions = load_motions(self.files[method])
            check_belongs(subject.recording, motions)
            return _scored(outcome, subject, motions)
        try:
            motions = METHODS[method].motions(subject.recording)
            save_motions(motions, folder / "motions.parquet", overwrite=True)
            return _scored(outcome, subject, motions)
        except FAILURES as error:
            return outcome.model_copy(update={"failure": " ".join(f"{type(error).__name__}: {error}".split())})


class _Subject:
    """A recording, and what all outcomes need of it, worked out once."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording

    @cached_property
    def digest(self) -> str:
        return self.recording.digest()

    @cached_property
    def visibility(self) -> Visibility:
        return visibility_of(self.recording)


def one_group(outcomes: Iterable[Outcome]) -> bool:
    """Whether all are of one kind of recording, so that a mean over them has an interval."""
    return len({outcome.group for outcome in outcomes}) <= 1


def code_digest() -> str:
    """SHA-256 of the Python files of the packages that outcomes come from."""
    content = hashlib.sha256()
    for package in (recording_package, algorithm, evaluation):
        for path in sorted(Path(package.__path__[0]).glob("*.py")):
            content.update(path.read_bytes())
    return content.hexdigest()


def _scored(outcome: Outcome, subject: _Subject, motions: Motions) -> Outcome:
    evidence = evidence_of(subject.recording, motions, subject.visibility)
    lengths = tuple(
        HiddenLength(
            seconds=row.hidden_frames / subject.recording.fps,
            object_frames=row.object_frames,
            recall=row.recall,
            points=row.points,
            mean_m=row.mean_m,
            centres=row.centres,
            centre_mean_m=row.centre_mean_m,
        )
        for row in completion_by_length(evidence)
    )
    return outcome.model_copy(update={"scores": scores_of(evidence), "by_length": lengths})


def _kept(folder: Path, made_of: MadeOf) -> Outcome | None:
    """The outcome in the folder, if it was made of the same; a failure is tried again."""
    place = folder / "outcome.json"
    if not place.is_file():
        return None
    try:
        found = validated(Outcome, json_document(place), source=str(place))
    except InputError:  # Damaged, or of another version: it is made again.
        return None
    return found if found.made_of == made_of and found.failure is None else None


def _keep(outcome: Outcome, folder: Path) -> None:
    with whole_file(folder / "outcome.json", overwrite=True) as partial:
        partial.write_text(outcome.model_dump_json(indent=1) + "\n", encoding="utf-8")
