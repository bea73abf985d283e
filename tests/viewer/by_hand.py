"""The viewer's thread, turned by hand: time passes when a test says so."""

import queue
import time
from collections.abc import Callable

from viewer.clock import Action

PATIENCE_SECONDS = 120.0
"""For work in the background, on a busy machine."""


class Waiting:
    """An action that comes when its time does."""

    def __init__(self, at: float, action: Action) -> None:
        self.at, self.action = at, action
        self.cancelled = False

    def cancel(self) -> None:
        """Let it not come."""
        self.cancelled = True


class HandClock:
    """A clock that stands still."""

    def __init__(self) -> None:
        self.now = 0.0
        self._soon: queue.SimpleQueue[Action] = queue.SimpleQueue()
        self._later: list[Waiting] = []

    def call_soon_threadsafe(self, action: Action, /) -> None:
        """Do it in `work_until`."""
        self._soon.put(action)

    def call_later(self, seconds: float, action: Action, /) -> Waiting:
        """Do it in `pass_by`."""
        self._later.append(Waiting(self.now + seconds, action))
        return self._later[-1]

    def pass_by(self, seconds: float) -> None:
        """Let time pass, and everything happen whose time has come."""
        end = self.now + seconds
        while due := [each for each in self._later if not each.cancelled and each.at <= end]:
            first = min(due, key=lambda each: each.at)
            self._later.remove(first)
            self.now = max(first.at, self.now)
            first.action()
        self.now = end

    def work_until(self, done: Callable[[], bool]) -> None:
        """Do what other threads ask for until something has come true."""
        end = time.monotonic() + PATIENCE_SECONDS
        while not done():
            self._soon.get(timeout=max(end - time.monotonic(), 0.01))()
