"""Work shared out by Dask: among processes of this machine, or on any cluster whose scheduler runs.

A task is a function with its arguments under a key; a result under the same key is made once, whoever needs it.
"""

import logging
import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from typing import Any

import dask
from dask.task_spec import Task, TaskRef
from distributed import Client, Future, KilledWorker, LocalCluster, as_completed

from recording.code import code_digest
from recording.errors import InputError

__all__ = ["Client", "Finished", "Task", "TaskRef", "cluster", "finished", "require_code"]
_ONE_THREAD = {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OPENCV_FOR_THREADS_NUM": "1"}
"""A worker is a process with one thread: workers, not their libraries, share the cores."""
_PATIENCE_SECONDS = 10.0
"""A scheduler that has not answered by then is not there."""
_DEAF = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
"""For workers that are begun later: a key that interrupts the program reaches them too, and they need not say so."""
_KILLED = "KilledWorker: every worker that had it died: is there memory for it?"


@dataclass(frozen=True, kw_only=True)
class Finished:
    """What became of a task."""

    key: str
    value: Any = None
    failure: str | None = None
    """Why there is no value."""


@contextmanager
def cluster(scheduler: str | None = None, *, workers: int = 1) -> Iterator[Client]:
    """A client of the scheduler at the address, such as `tcp://host:8786`; without one, of workers of its own.

    Workers of its own are processes with one thread each on this machine, and end with the block, or with this
    process, however it ends. A program that is a file starts them only under `if __name__ == "__main__":`.
    """
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # What goes wrong is told once, by the command.
    if scheduler is not None:
        with _connected(scheduler) as client:
            yield client
        return
    with dask.config.set({"distributed.nanny.pre-spawn-environ": _ONE_THREAD}):
        with _deaf():
            own = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
                preload=[_DEAF],
            )
        with own, Client(own) as client:
            yield client


def finished(
    client: Client, tasks: Mapping[str, Task], wanted: Sequence[str], *, at_once: int | None = None
) -> Iterator[Finished]:
    """The wanted tasks, each when it is done or has failed; tasks of the graph that none of them needs are left out.

    A task that fails takes those with it that need its result, and no others. When workers die, the scheduler blames
    every task that was waiting on them; so those it gives up are tried again, a few at a time and then alone, and only
    what brings its workers down when it is alone has failed. With `at_once` the scheduler hears of so many at a time.
    """
    waiting = list(wanted)
    for width in (at_once or len(waiting), None, 1):
        workers = len(client.scheduler_info(n_workers=-1)["workers"])  # Its answer comes after the blame is forgotten.
        blamed = []
        for one in _tried(client, tasks, waiting, max(width or workers, 1)):
            if one.failure == _KILLED and width != 1:
                blamed.append(one.key)
            else:
                yield one
        waiting = blamed


def _tried(client: Client, tasks: Mapping[str, Task], wanted: Sequence[str], at_once: int) -> Iterator[Finished]:
    """What becomes of the tasks when no more than `at_once` of them wait for the workers."""
    waiting = iter(wanted)
    pool = as_completed(_futures(client, tasks, list(islice(waiting, at_once))))
    try:
        for batch in pool.batches():
            fetched = _fetched(client, batch)  # Before more is begun, which may bring the worker down that holds them.
            pool.update(_futures(client, tasks, list(islice(waiting, len(batch)))))
            for future, values in fetched:
                if values:
                    yield Finished(key=str(future.key), value=values[0])
                elif future.status == "error":
                    yield Finished(key=str(future.key), failure=_sentence(future.exception()))
                else:
                    pool.add(future)  # Its worker died before the result was fetched: it is being made again.
    finally:
        client.cancel(list(pool.futures))  # Nothing goes on for somebody who has gone.


def _fetched(client: Client, futures: Sequence[Future[Any]]) -> list[tuple[Future[Any], list[Any]]]:
    """The result of each, alone in a list; an empty list where there is none."""
    every = client.gather(futures, errors="skip")
    if len(every) == len(futures):
        return [(future, [value]) for future, value in zip(futures, every, strict=True)]
    return [(future, client.gather([future], errors="skip")) for future in futures]


def _futures(client: Client, tasks: Mapping[str, Task], keys: Sequence[str]) -> list[Future[Any]]:
    """The tasks and all they need, handed to the scheduler."""
    needed: dict[str, Task] = {}
    waiting = list(keys)
    while waiting:
        key = waiting.pop()
        if key not in needed:
            needed[key] = tasks[key]
            waiting += tasks[key].dependencies
    return client.get(needed, list(keys), sync=False) if keys else []


def require_code(expected: str, *modules: str) -> None:
    """Raise where this process has other code than the one that gave it the task."""
    if code_digest(*modules) != expected:
        raise InputError("this worker has other code than the client, or other libraries: install the same version")


@contextmanager
def _deaf() -> Iterator[None]:
    """Within this block a key that interrupts is not heard, nor ever by the processes that are begun in it."""
    if threading.current_thread() is not threading.main_thread():  # Only that one hears signals, and may say so.
        yield
        return
    heard = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, heard)


@contextmanager
def _connected(scheduler: str) -> Iterator[Client]:
    try:
        client = Client(scheduler, timeout=_PATIENCE_SECONDS)
    except (OSError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"--scheduler: expected a Dask scheduler at {scheduler!r}, but {reason}") from None
    with client:
        yield client


def _sentence(error: BaseException) -> str:
    if isinstance(error, KilledWorker):
        return _KILLED
    return " ".join(f"{type(error).__name__}: {error}".split())
