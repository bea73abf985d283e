"""The thread in which everything happens, and how one part of the viewer hears of another's change."""

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

Action = Callable[[], None]


@runtime_checkable
class Timer(Protocol):
    """An action that is to come."""

    def cancel(self) -> None:
        """Let it not come."""


@runtime_checkable
class Clock(Protocol):
    """The thread in which everything happens; an event loop of asyncio is such."""

    def call_soon_threadsafe(self, action: Action, /) -> Any:
        """Do it as soon as what is being done is done; any thread may ask for it."""

    def call_later(self, seconds: float, action: Action, /) -> Timer:
        """Do it after some time."""


class Delay:
    """Does something as soon as it was not asked for again for some time."""

    def __init__(self, clock: Clock, seconds: float) -> None:
        self._clock, self._seconds = clock, seconds
        self._timer: Timer | None = None

    def do(self, action: Action) -> None:
        """Do it later, in place of what was to be done before."""
        self.cancel()
        self._timer = self._clock.call_later(self._seconds, action)

    def cancel(self) -> None:
        """Let what is to be done not come."""
        if self._timer is not None:
            self._timer.cancel()


class Signal:
    """Tells those who asked for it that something has changed."""

    def __init__(self) -> None:
        self._listeners: list[Action] = []

    def connect(self, listener: Action) -> None:
        """Tell this one from now on."""
        self._listeners.append(listener)

    def __call__(self) -> None:
        """It has changed."""
        for listener in self._listeners:
            listener()
