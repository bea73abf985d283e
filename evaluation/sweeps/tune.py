"""The search for the best settings: trials that a sampler chooses, on development recordings, error against time."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

import optuna
from optuna.distributions import BaseDistribution, CategoricalDistribution, FloatDistribution, IntDistribution
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
from optuna.trial import Trial, TrialState

from algorithm.settings import Settings
from evaluation.sweeps.graph import graph_of, trial_of
from evaluation.sweeps.plan import Axis, Point, Sweep, settings_at
from evaluation.sweeps.run import RECORDINGS
from evaluation.sweeps.subject import Subject, subjects_of
from evaluation.sweeps.table import numbers_of
from evaluation.sweeps.worth import worth
from recording.cache import Cache, key_of
from recording.cluster import Client, Finished, finished
from recording.code import code_digest
from recording.errors import InputError
from recording.progress import tracked

STUDY = "study.log"
"""Optuna's journal; other programs, such as optuna-dashboard, read it as it is."""
_MADE_OF = "made of"
_FIRST_REPORTING_SEED = 1000


@dataclass(frozen=True, kw_only=True)
class Attempt:
    """What some settings have reached."""

    number: int
    values: dict[str, Any]
    error: float
    """1 less the mean worth over the recordings (`evaluation.sweeps.worth`); where it fails, its worth is 0."""
    seconds: float
    """That a recording takes, mean."""
    front: bool
    """Whether no other attempt has a smaller error and fewer seconds."""


def tuned(
    sweep: Sweep, folder: Path, client: Client, *, trials: int, at_once: int = 1, cache: Cache | None = None
) -> list[Attempt]:
    """The attempts of a study that has so many trials, the best first; its first has the preset's own values.

    Values are drawn by Optuna's tree-structured Parzen estimator for two goals, error and seconds; `at_once` trials
    are drawn before the first of them is known. The study is a file in the folder: the same call again goes on with
    it, and draws other values than an undisturbed one would have.
    """
    if any(seed >= _FIRST_REPORTING_SEED for seed in sweep.seeds):
        raise InputError(f"expected development seeds, below {_FIRST_REPORTING_SEED}, got {sweep.seeds}")
    subjects = subjects_of(client, sweep, folder / RECORDINGS)
    study = _study(sweep, folder, subjects)
    spaces = {name: _distribution(name, axis) for name, axis in sweep.axes.items()}
    left = trials - len(study.get_trials(deepcopy=False, states=[TrialState.COMPLETE]))
    for begun in tracked(range(0, left, at_once), f"tuning {sweep.name}", total=len(range(0, left, at_once))):
        asked = [study.ask(spaces) for _ in range(min(at_once, left - begun))]
        for trial, goals in zip(asked, _reached(sweep, asked, subjects, client, cache), strict=True):
            study.tell(trial, goals)
    return _attempts(study)


def _study(sweep: Sweep, folder: Path, subjects: Sequence[Subject]) -> optuna.Study:
    """The study in the folder, new or gone on with; InputError where it is of something else."""
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    folder.mkdir(parents=True, exist_ok=True)
    storage = JournalStorage(JournalFileBackend(str(folder / STUDY)))
    known = {study.study_name for study in storage.get_all_studies()}
    study = optuna.create_study(
        storage=storage, study_name=sweep.name, directions=["minimize", "minimize"], load_if_exists=True
    )
    made_of = _made_of(sweep, subjects)
    if sweep.name not in known:
        study.set_user_attr(_MADE_OF, made_of)
        base = subjects[0].settings(sweep.preset).model_dump()
        study.enqueue_trial({name: _within(base[name], axis) for name, axis in sweep.axes.items()})
    elif study.user_attrs.get(_MADE_OF) != made_of:
        raise InputError(
            f"{folder / STUDY}: expected a study of the same axes, recordings and code, got another: its trials do not "
            "compare with these; choose another folder, or another name in the file"
        )
    for unfinished in study.get_trials(deepcopy=False, states=[TrialState.RUNNING]):  # Of a call that was killed.
        study.tell(unfinished.number, state=TrialState.FAIL)
    study.sampler = optuna.samplers.TPESampler(seed=sweep.sampling_seed + len(study.get_trials(deepcopy=False)))
    return study


def _made_of(sweep: Sweep, subjects: Sequence[Subject]) -> str:
    """What trials must have in common to compare."""
    document = {
        "sweep": sweep.model_dump(mode="json", by_alias=True, exclude={"description", "recordings", "scenes"}),
        "recordings": [subject.files for subject in subjects],
        "code": code_digest("evaluation.sweeps.tune"),
    }
    return key_of("study", document)


def _reached(
    sweep: Sweep, asked: Sequence[Trial], subjects: Sequence[Subject], client: Client, cache: Cache | None
) -> list[tuple[float, float]]:
    """Error and seconds of each trial; those that are drawn together share what they have in common."""
    wanted = []
    for trial in asked:
        point = Point(number=trial.number, values=trial.params)
        settings = [settings_at(sweep, point, subject.settings(sweep.preset)) for subject in subjects]
        wanted.append([trial_of(subject, one, cache) for subject, one in zip(subjects, settings, strict=True)])
    keys = [[one.scores_key() for one in trials] for trials in wanted]
    graph = graph_of(one for trials in wanted for one in trials)
    every = list(dict.fromkeys(key for own in keys for key in own))
    done = {one.key: one for one in finished(client, graph, every)}
    return [_goals([done[key] for key in own]) for own in keys]


def _goals(done: Sequence[Finished]) -> tuple[float, float]:
    flat = [numbers_of(one.value) for one in done if one.failure is None]
    if not flat:
        raise InputError(f"every recording failed, the first: {done[0].failure}")
    worths = [worth(scores) or 0.0 for scores in flat] + [0.0] * (len(done) - len(flat))
    return 1.0 - fmean(worths), fmean(scores["seconds.total"] or 0.0 for scores in flat)


def _attempts(study: optuna.Study) -> list[Attempt]:
    front = {trial.number for trial in study.best_trials}
    complete = study.get_trials(deepcopy=False, states=[TrialState.COMPLETE])
    attempts = [
        Attempt(
            number=trial.number,
            values=dict(trial.params),
            error=trial.values[0],
            seconds=trial.values[1],
            front=trial.number in front,
        )
        for trial in complete
    ]
    return sorted(attempts, key=lambda one: (one.error, one.seconds))


def _distribution(name: str, axis: Axis) -> BaseDistribution:
    if axis.values is not None:
        return CategoricalDistribution(axis.values)
    low, high = float(axis.first or 0), float(axis.last or 0)
    logarithmic = axis.scale == "logarithmic"
    if Settings.model_fields[name].annotation is int:
        return IntDistribution(round(low), round(high), log=logarithmic)
    return FloatDistribution(low, high, log=logarithmic)


def _within(value: Any, axis: Axis) -> Any:
    """The preset's value, or the nearest that the axis has."""
    if axis.values is not None:
        return value if value in axis.values else axis.values[0]
    return min(max(value, axis.first), axis.last)
