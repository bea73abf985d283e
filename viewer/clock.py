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
