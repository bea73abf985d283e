"""Long work beside the viewer: one job after the other, in a thread that nobody waits for at the end."""

import threading
from collections.abc import Callable
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
        threading.Thread(target=self._work, daemon=True).start()

    def do(self, job: Callable[[], Result], *, done: Callable[[Result], None], refused: Callable[[str], None]) -> None:
        """Do the job when those before it are done, then `done` with its result, or `refused` with the sentence."""
        self._jobs.put(lambda: self._do(job, done, refused))

    def _work(self) -> None:
        while True:
            self._jobs.get()()

    def _do(self, job: Callable[[], Result], done: Callable[[Result], None], refused: Callable[[str], None]) -> None:
        try:
            result = job()
        except InputError as error:
            sentence = str(error)
            self._post(lambda: refused(sentence))
        else:
            self._post(lambda: done(result))
