"""The worker: jobs in their order, refusals and defects as one line each, and it goes on after both."""

import queue
import threading

import pytest

from recording.errors import InputError
from viewer.worker import Worker


def refused_input() -> str:
    raise InputError("expected a cat, got a dog")


def defect() -> str:
    raise ZeroDivisionError("never\nso")


def test_refusals_and_defects_are_told_in_one_line_and_the_next_job_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    traces: queue.SimpleQueue[str] = queue.SimpleQueue()
    monkeypatch.setattr(threading, "excepthook", lambda failure: traces.put(failure.exc_type.__name__))
    told: queue.SimpleQueue[str] = queue.SimpleQueue()
    worker: Worker[str] = Worker(lambda action: action())
    for job in (lambda: "done", refused_input, defect, lambda: "done again"):
        worker.do(job, done=told.put, refused=told.put)
    lines = [told.get(timeout=30) for _ in range(4)]
    assert lines == [
        "done",
        "expected a cat, got a dog",
        "a defect in the program, whose traceback stands in the terminal: ZeroDivisionError: never so",
        "done again",
    ]
    assert traces.get(timeout=30) == "ZeroDivisionError"
