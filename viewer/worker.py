"""Long work beside the viewer: one job after the other, in a thread that nobody waits for at the end."""

import sys
import threading
from collections.abc import Callable
from functools import partial
from queue import SimpleQueue
from typing import Generic, TypeVar

from recording.errors import InputError
from viewer.clock import Action

Result = TypeVar("Result")
Post = Callable[[Action], None]
"""Hands an action to the thread that everything but long work is done in."""


class Worker(Generic[Result]):
    """Does jobs in their order and posts what comes of them."""

    def __init__(self, post: Post) -> None:
        self._post = post
        self._jobs: SimpleQueue[Action] = SimpleQueue()
        self._begin()

    def do(self, job: Callable[[], Result], *, done: Callable[[Result], None], refused: Callable[[str], None]) -> None:
        """Do the job when those before it are done, then `done` with its result, or `refused` with the sentence.

        A defect is refused too, in one line, and its traceback goes to standard error.
        """
        self._jobs.put(lambda: self._do(job, done, refused))

    def _begin(self) -> None:
        threading.Thread(target=self._work, daemon=True).start()

    def _work(self) -> None:
        try:
            while True:
                self._jobs.get()()
        finally:
            self._begin()  # A defect ends its thread with a traceback; the jobs after it are another one's.

    def _do(self, job: Callable[[], Result], done: Callable[[Result], None], refused: Callable[[str], None]) -> None:
        outcome: Action | None = None
        try:
            outcome = partial(done, job())
        except InputError as error:
            outcome = partial(refused, str(error))
        finally:
            self._post(outcome or partial(refused, _line(sys.exception())))


def _line(defect: BaseException | None) -> str:
    told = " ".join(f"{type(defect).__name__}: {defect}".split())
    return f"a defect in the program, whose traceback stands in the terminal: {told}"
