"""Work shared out among processes, which say as they go how far they are.

A worker is a Python of its own that reads its task from standard input: it imports what the task needs, not the program
that asked for it, and a key that interrupts the program does not reach it.
"""

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, BinaryIO, Protocol, TypeVar, runtime_checkable

from recording.errors import InputError

_COMMAND = "from recording.workers import main; main()"
Report_co = TypeVar("Report_co", covariant=True)


@runtime_checkable
class Task(Protocol[Report_co]):
    """A piece of work; it is pickled on its way to a worker, and what it reports on the way back."""

    def reports(self) -> Iterator[Report_co]:
        """Do the work, and say as it goes what is done."""


@dataclass(frozen=True, kw_only=True)
class _Said:
    """A report."""

    report: Any


@dataclass(frozen=True, kw_only=True)
class _Refused:
    """The task cannot be done: the sentence of its `InputError`."""

    sentence: str


@dataclass(frozen=True, kw_only=True)
class _Ended:
    """A worker is no more."""

    status: int


_Messages = queue.Queue[_Said | _Refused | _Ended]


def reported(tasks: Sequence[Task[Report_co]], *, at_once: int) -> Generator[Report_co]:
    """What the tasks report, in any order, while up to `at_once` of them are done at the same time.

    Each task has a process of its own; where only one is done at a time, all are done in this one. Whatever ends
    this iterator ends the workers first: a failure of one of them, which is an error here, or that no more is
    asked for.
    """
    if at_once < 1:
        raise InputError(f"expected at least one worker, got {at_once}")
    if min(at_once, len(tasks)) <= 1:
        for task in tasks:
            yield from task.reports()
        return
    waiting = iter(tasks)
    with _team() as (hire, messages):
        at_work = sum(1 for _ in map(hire, islice(waiting, at_once)))
        while at_work:
            message = messages.get()
            if isinstance(message, _Said):
                yield message.report
            elif isinstance(message, _Refused):
                raise InputError(message.sentence)
            else:
                _check_ended_well(message.status)
                at_work += sum(1 for _ in map(hire, islice(waiting, 1))) - 1


def main() -> None:
    """What a worker does: the task that it reads."""
    task: Task[Any] = pickle.load(sys.stdin.buffer)
    channel = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # What a library prints is no message.
    try:
        for report in task.reports():
            _tell(channel, _Said(report=report))
    except InputError as error:
        _tell(channel, _Refused(sentence=" ".join(str(error).split())))
    except BrokenPipeError:  # Whoever asked is gone.
        os._exit(1)


def _tell(channel: BinaryIO, message: _Said | _Refused) -> None:
    pickle.dump(message, channel)
    channel.flush()


@contextlib.contextmanager
def _team() -> Iterator[tuple[Callable[[Task[Any]], None], _Messages]]:
    """How to set a new worker to a task, and what they all say as it comes; none is left after the block."""
    messages: _Messages = queue.Queue()
    running: list[subprocess.Popen[bytes]] = []
    listeners: list[threading.Thread] = []

    def hire(task: Task[Any]) -> None:
        running.append(_started())
        listeners.append(threading.Thread(target=_attend, args=(running[-1], task, messages)))
        listeners[-1].start()

    try:
        yield hire, messages
    finally:
        for worker in running:
            worker.kill()
        for listener in listeners:
            listener.join()


def _started() -> "subprocess.Popen[bytes]":
    search_path = os.pathsep.join(path or os.getcwd() for path in sys.path)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", _COMMAND],
        env=os.environ | {"PYTHONPATH": search_path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
    )


def _attend(worker: "subprocess.Popen[bytes]", task: Task[Any], messages: _Messages) -> None:
    """Hand the worker its task, then pass on what it says, and at last its exit status."""
    if worker.stdin is None or worker.stdout is None:
        raise ValueError("expected a worker with pipes")
    with worker.stdout:
        with contextlib.suppress(BrokenPipeError), worker.stdin:  # One that is dead says so by its status.
            pickle.dump(task, worker.stdin)
        with contextlib.suppress(EOFError, pickle.UnpicklingError):  # The end, or that of one that was killed.
            while True:
                messages.put(pickle.load(worker.stdout))
    messages.put(_Ended(status=worker.wait()))


def _check_ended_well(status: int) -> None:
    if status < 0:
        raise InputError(f"a worker was ended by signal {-status}: is there memory for so many? pass fewer workers")
    if status > 0:
        raise RuntimeError(f"a worker failed with exit status {status}")
