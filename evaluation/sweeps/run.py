"""A sweep, from its plan to its rows: what is known is not made again, what fails does not stop the rest."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from evaluation.sweeps.graph import Trial, graph_of, trial_of
from evaluation.sweeps.journal import Done, journal, remove_journal
from evaluation.sweeps.plan import Point, Sweep, points_of, settings_at
from evaluation.sweeps.subject import Subject, subjects_of
from evaluation.sweeps.table import Row, known_results, numbers_of, row_of, write_results
from recording.cache import Cache
from recording.cluster import Client, Task, finished
from recording.progress import tracked

RECORDINGS = "recordings"
"""The folder of what a sweep has simulated, in its own."""


def swept(
    sweep: Sweep, folder: Path, client: Client, *, cache: Cache | None = None, overwrite: bool = False
) -> list[Row]:
    """The rows of the sweep, by point, then recording; they are `results.parquet` in the folder too.

    The same call again goes on where it ended; after changes to the sweep, the code or a recording it makes what is
    missing then. A trial that fails has its error in its row, and is tried again by the next call. With `overwrite`
    nothing is taken from an earlier call but the recordings; the cache remains in force.
    """
    subjects = subjects_of(client, sweep, folder / RECORDINGS)
    points = points_of(sweep)
    trials = {
        (point.number, subject.label): trial
        for point in points
        for subject, trial in _trials(sweep, point, subjects, cache)
    }
    keys = {name: trial.scores_key() for name, trial in trials.items()}
    with journal(folder, afresh=overwrite) as written:
        known = written.known if overwrite else {**known_results(folder), **written.known}
        graph = graph_of(trial for name, trial in trials.items() if keys[name] not in known)
        wanted = [key for key in dict.fromkeys(keys.values()) if key not in known]
        for done in tracked(_done(client, graph, wanted), f"sweeping {sweep.name}", total=len(wanted)):
            written.add(done)
            known[done.key] = done
    rows = [row_of(points[name[0]], trial, known[keys[name]]) for name, trial in trials.items()]
    write_results(sweep, rows, folder)
    remove_journal(folder)
    return rows


def _trials(
    sweep: Sweep, point: Point, subjects: Sequence[Subject], cache: Cache | None
) -> Iterator[tuple[Subject, Trial]]:
    for subject in subjects:
        settings = settings_at(sweep, point, subject.settings(sweep.preset))
        yield subject, trial_of(subject, settings, cache)


def _done(client: Client, graph: dict[str, Task], wanted: Sequence[str]) -> Iterator[Done]:
    for one in finished(client, graph, wanted):
        scores = None if one.value is None else numbers_of(one.value)
        yield Done(key=one.key, scores=scores, failure=one.failure)
