"""What points share is made once: counted, not timed."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import patch

import dask
import pytest

from algorithm.flow_parts import FlowParts
from algorithm.settings import Settings
from algorithm.staged import Course, solve
from evaluation.scores import evaluate
from evaluation.sweeps.graph import Trial, graph_of, trial_of
from evaluation.sweeps.plan import Sweep, points_of, settings_at
from evaluation.sweeps.subject import Subject, digest_of_files
from recording.cache import Cache
from recording.errors import InputError
from recording.store import load_recording


@pytest.fixture(scope="module")
def subject(small: Path) -> Subject:
    return Subject(
        label="small",
        place=str(small),
        scene="small",
        seed=1,
        digest=load_recording(small).digest(),
        files=digest_of_files(small),
        of_scene=None,
    )


@pytest.fixture
def calls() -> Iterator[Counter[str]]:
    """How often each stage was made."""
    made: Counter[str] = Counter()

    def counting(name: str, owner: type = Course) -> object:
        original = getattr(owner, name)

        def counted(*arguments: object) -> object:
            made[name] += 1
            return original(*arguments)

        return patch.object(owner, name, counted)

    with counting("_made", FlowParts), counting("_made_observed"), counting("_made_grouped"), counting("motions"):
        yield made


def sixteen(subject: Subject, cache: Cache | None = None) -> list[Trial]:
    """Sixteen points with two settings of the flow, four of the trajectories, eight of the segments."""
    axes = {
        "flow": ["dis", "farneback"],
        "eps1": [1.0, 1.5],
        "widest_m": [1.2, 1.25],
        "eps6": [0.1, 0.2],
    }
    sweep = Sweep.model_validate({"name": "sixteen", "recordings": [subject.place], "axes": axes})
    return [trial_of(subject, settings_at(sweep, point, Settings()), cache) for point in points_of(sweep)]


def computed(trials: list[Trial]) -> list[dict[str, object]]:
    """The scores of the trials, made in this process."""
    return list(dask.get(graph_of(trials), [trial.scores_key() for trial in trials]))


def test_sixteen_points_with_two_flow_settings_run_the_flow_twice(subject: Subject, calls: Counter[str]) -> None:
    scores = computed(sixteen(subject))
    assert calls == {"_made": 2, "_made_observed": 4, "_made_grouped": 8, "motions": 16}
    assert len(scores) == 16


def test_the_same_again_runs_nothing_from_the_cache(subject: Subject, calls: Counter[str], tmp_path: Path) -> None:
    cache = Cache(folder=tmp_path)
    first = computed(sixteen(subject, cache))
    before = calls.copy()
    assert computed(sixteen(subject, cache)) == first
    assert calls == before
    assert calls["_made"] == 2


def test_solve_and_a_sweep_share_their_cache(subject: Subject, calls: Counter[str], tmp_path: Path) -> None:
    cache = Cache(folder=tmp_path)
    settings = Settings(flow="dis")
    solve(load_recording(subject.place), settings, cache=cache)
    computed([trial_of(subject, settings, cache)])
    assert calls == {"_made": 1, "_made_observed": 1, "_made_grouped": 1, "motions": 2}


def test_the_scores_are_those_of_solve_and_evaluate(subject: Subject) -> None:
    recording, settings = load_recording(subject.place), Settings(flow="dis")
    (found,) = computed([trial_of(subject, settings, None)])
    wanted = evaluate(recording, solve(recording, settings))
    del found["seconds"], wanted["seconds"]
    assert found == wanted


def test_a_worker_without_the_results_that_the_client_has_makes_them(subject: Subject, tmp_path: Path) -> None:
    trials = sixteen(subject, Cache(folder=tmp_path))[:1]
    computed(trials)
    graph = graph_of(trials)
    for path in tmp_path.rglob("*-*"):
        path.unlink()
    assert len(graph) == 1
    assert len(dask.get(graph, [trials[0].scores_key()])) == 1


def test_other_code_than_the_clients_is_refused(subject: Subject) -> None:
    trial = Trial(subject=subject, settings=Settings(), cache=None, code="of another version")
    with pytest.raises(InputError, match="other code"):
        trial.course()
