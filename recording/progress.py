"""Progress of long work: silent in a library, a bar on a terminal when the command line asks for it."""

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

from rich.console import Console
from rich.progress import Progress

Item = TypeVar("Item")
PATIENCE_SECONDS = 2.0
"""Shorter work shows no bar."""

_display: ContextVar[Progress | None] = ContextVar("progress display", default=None)


@contextmanager
def progress_shown(console: Console) -> Iterator[None]:
    """Within this block `tracked` draws its bars on the console, if that is a terminal."""
    display = Progress(console=console, transient=True, disable=not console.is_terminal)
    token = _display.set(display)
    try:
        yield
    finally:
        display.stop()
        _display.reset(token)


def note(message: str) -> None:
    """Say something while long work goes on: a line on the display's console; a library is silent."""
    display = _display.get()
    if display is not None:
        display.console.print(message, markup=False)


def tracked(items: Iterable[Item], description: str, *, total: int) -> Iterator[Item]:
    """The items, counted on the progress display in force, if any."""
    display = _display.get()
    if display is None:
        yield from items
        return
    task = display.add_task(description, total=total)
    begun = time.monotonic()
    for item in items:
        yield item
        display.advance(task)
        if time.monotonic() - begun > PATIENCE_SECONDS:
            display.start()
    display.remove_task(task)
