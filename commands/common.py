"""What the commands share: the options that all of them take, messages, and how a program ends."""

import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import App, CycloptsError, Parameter
from rich.console import Console

from recording.errors import InputError
from recording.progress import progress_shown

messages = Console(stderr=True, soft_wrap=True, highlight=False)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Common:
    """What every command takes."""

    quiet: Annotated[bool, Parameter(negative="")] = False
    """No messages and no progress bar; results are printed all the same."""

    def say(self, message: str) -> None:
        """A message on standard error, unless it is to be quiet."""
        if not self.quiet:
            messages.print(message, markup=False)

    def progress(self) -> AbstractContextManager[None]:
        """Within this block long work shows a progress bar, unless it is to be quiet."""
        return nullcontext() if self.quiet else progress_shown(messages)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Writing(Common):
    """What every command takes that writes files."""

    overwrite: Annotated[bool, Parameter(negative="")] = False
    """Replace results that exist already, with everything in their folders."""


COMMON, WRITING = Common(), Writing()
Output = Annotated[Path, Parameter(name=["--output", "-o"])]


def run(app: App, arguments: list[str] | None = None, *, name: str) -> None:
    """Run a program, by default on the arguments that it was called with; its messages begin with its name.

    Exit status 0 done, 1 a check failed, 2 the input or the arguments are wrong, 130 interrupted.
    """
    try:
        app(arguments, exit_on_error=False, print_error=False)
    except (InputError, CycloptsError) as error:
        messages.print(f"{name}: " + " ".join(str(error).split()), markup=False)
        sys.exit(2)
    except KeyboardInterrupt:
        messages.print(f"{name}: interrupted; nothing half-written is left")
        sys.exit(130)
