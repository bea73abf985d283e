"""What the commands share: the options that all of them take, messages, and how a program ends."""

import os
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import App, CycloptsError, Parameter, UnknownOptionError
from cyclopts.validators import Number
from platformdirs import user_cache_path
from rich.console import Console

from algorithm.settings import Settings
from recording.cache import GIGABYTE, Cache
from recording.cluster import Client, cluster
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


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Caching:
    """What commands take that keep the results of the solver's stages for the next time."""

    cache: Annotated[Path | None, Parameter(env_var="UNOCCLUDE_CACHE")] = None
    """Folder to keep results of the solver's stages in; one in the user's cache folder by default."""
    cache_gb: Annotated[float, Parameter(env_var="UNOCCLUDE_CACHE_GB", validator=Number(gt=0))] = 10.0
    """Its size in gigabytes: what was not used for the longest time goes first."""
    no_cache: Annotated[bool, Parameter(negative="")] = False
    """Make everything anew and keep nothing."""

    def chosen(self) -> Cache | None:
        """The cache, if there is to be one."""
        if self.no_cache:
            return None
        folder = self.cache or user_cache_path("unocclude")
        return Cache(folder=folder.absolute(), limit_bytes=round(self.cache_gb * GIGABYTE))


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Scaling:
    """What commands take that share their work out."""

    workers: Annotated[int | None, Parameter(validator=Number(gte=1))] = None
    """Processes on this machine, one for each core by default; results are the same for any number."""
    scheduler: str | None = None
    """Address of a running Dask scheduler, such as `tcp://host:8786`, whose workers do the work (docs/cluster.md)."""

    @contextmanager
    def team(self, common: Common) -> Iterator[Client]:
        """The workers; where to watch them is said."""
        with cluster(self.scheduler, workers=self.workers or os.cpu_count() or 1) as client:
            common.say(f"dashboard: {client.dashboard_link}")
            yield client

    def team_if_needed(self, common: Common, *, tasks: int) -> AbstractContextManager[Client | None]:
        """The workers; none where this process can do the tasks as well."""
        alone = self.scheduler is None and min(self.workers or os.cpu_count() or 1, tasks) == 1
        return nullcontext() if alone else self.team(common)


COMMON, WRITING, CACHING, SCALING = Common(), Writing(), Caching(), Scaling()
Output = Annotated[Path, Parameter(name=["--output", "-o"])]


def run(app: App, arguments: list[str] | None = None, *, name: str) -> None:
    """Run a program, by default on the arguments that it was called with; its messages begin with its name.

    Exit status 0 done, 1 a check failed, 2 the input or the arguments are wrong, 130 interrupted.
    """
    try:
        app(arguments, exit_on_error=False, print_error=False)
    except (InputError, CycloptsError) as error:
        sentence = (isinstance(error, UnknownOptionError) and _setting_hint(error)) or str(error)
        messages.print(f"{name}: " + " ".join(sentence.split()), markup=False)
        sys.exit(2)
    except OSError as error:  # A name that is too long, a disk that fails: what no reader can foresee.
        messages.print(f"{name}: {error.filename or 'a file'}: cannot be used: {error.strerror}", markup=False)
        sys.exit(2)
    except MemoryError:
        messages.print(f"{name}: expected less to hold in memory: fewer frames, smaller pictures or fewer workers")
        sys.exit(2)
    except KeyboardInterrupt:
        messages.print(f"{name}: interrupted; nothing half-written is left")
        sys.exit(130)


def _setting_hint(error: UnknownOptionError) -> str | None:
    """What to write in place of an unknown option that is a setting of the solver; None of any other option."""
    option = (error.token.keyword or error.token.value).partition("=")[0]
    setting = option.strip("-").replace("-", "_")
    if setting not in Settings.model_fields:
        return None
    words = " ".join(error.root_input_tokens or ()).replace("=", " ").split()
    following = words[words.index(option) + 1 :][:1]
    value = following[0] if following and not following[0].startswith("--") else "VALUE"
    known = {name for argument in error.argument_collection for name in argument.names}
    advice = "pass" if "--set" in known else "run 'unocclude solve' with"
    return f"unknown option {option}: it is a setting of the solver: {advice} --set {setting}={value}"
