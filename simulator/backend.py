"""Which of Mitsuba's backends works on this machine.

The compiled one needs LLVM, which no wheel contains, and a wrong LLVM aborts the process without a Python
exception. So each candidate is tried in a process of its own.
"""

import ctypes.util
import functools
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from recording.errors import InputError

BackendName = Literal["llvm", "scalar"]
BackendWish = Literal["auto", "llvm", "scalar"]

LIBRARY_VARIABLE = "DRJIT_LIBLLVM_PATH"
"""The environment variable by which the user, or this module, tells Dr.Jit its LLVM."""

OLDEST_LLVM = 15
"""Dr.Jit refuses older ones. From 15 to 18 bare ray casts work, and no more is asked here."""

_ADVICE = "install LLVM 19 (Debian: libllvm19) or set DRJIT_LIBLLVM_PATH to its library"
_PROBE_SECONDS = 30  # A probe takes one or two; a hang must not be taken for patience.
_PROBE = """
import sys
from simulator.backend import Backend
from simulator.raycast import casts_known_answer
backend = Backend(name="llvm", reason="on probation", library=sys.argv[1])
sys.exit("a known ray cast came out wrong" if not casts_known_answer(backend) else 0)
"""
_DIRECTORIES = (
    "/usr/lib",
    "/usr/lib64",
    "/usr/lib/*-linux-gnu",
    "/usr/lib/llvm-*/lib",
    "/usr/lib/llvm*/lib64",
    "/usr/local/lib",
    "/usr/local/opt/llvm*/lib",
    "/opt/homebrew/opt/llvm*/lib",
)


@dataclass(frozen=True, kw_only=True)
class Backend:
    """The way rays are cast."""

    name: BackendName
    """`llvm`: compiled, all pixels at once; `scalar`: one ray after the other, needs nothing."""
    reason: str
    """Why this one, in one sentence."""
    library: str | None = None
    """The LLVM library, as a path or as a name that the system's loader finds; None for `scalar`."""


@functools.cache
def find_backend(wish: BackendWish = "auto") -> Backend:
    """The backend to use: `auto` is `llvm` where a probe passes, else `scalar`.

    Only the library that `DRJIT_LIBLLVM_PATH` names is tried where that is set, else those found in the
    usual places, the newest first. Found once for each process. A wish for `llvm` that cannot be met is
    an `InputError`.
    """
    if wish == "scalar":
        return Backend(name="scalar", reason="The scalar backend was asked for.")
    failures = []
    for library in _candidates():
        failure = _probe_failure(library)
        if failure is None:
            return Backend(name="llvm", reason=f"LLVM at {library} passed the probe.", library=library)
        failures.append(f"{library}: {failure}")
    found = "; ".join(failures) if failures else "no LLVM library was found"
    if wish == "llvm":
        raise InputError(f"The llvm backend needs an LLVM that works, but {found}; {_ADVICE}.")
    return Backend(name="scalar", reason=f"No LLVM that works ({found}); to be faster, {_ADVICE}.")


def likely_library() -> str | None:
    """The library that a probe would try first; None where there is none."""
    return next(iter(_candidates()), None)


def llvm_version(library: str) -> int | None:
    """The major version that a library's path or name tells, or None."""
    name = Path(library).name
    match = re.search(r"LLVM(?:-|\.so\.|\.)(\d{2,})", name) or re.search(r"llvm[-@]?(\d{2,})", library)
    return int(match.group(1)) if match else None


@functools.cache
def _candidates() -> list[str]:
    """The libraries worth a probe, best first: what the user named alone, else the newest first."""
    named = os.environ.get(LIBRARY_VARIABLE)
    if named:
        return [named]
    libraries = sorted(set(_installed_libraries()))
    versions = {library: llvm_version(library) for library in libraries}
    # One that does not tell its version comes last: it may be anything.
    usable = [library for library in libraries if (versions[library] or OLDEST_LLVM) >= OLDEST_LLVM]
    newest_of: dict[int, str] = {versions[library] or 0: library for library in usable}
    return [newest_of[version] for version in sorted(newest_of, reverse=True)]


def _installed_libraries() -> Iterator[str]:
    """Every LLVM library in the usual places, links resolved."""
    for directory in _DIRECTORIES:
        for pattern in ("libLLVM*.so*", "libLLVM*.dylib"):
            for path in Path("/").glob(directory.lstrip("/") + "/" + pattern):
                if path.is_file():
                    yield str(path.resolve())
    system_library = ctypes.util.find_library("LLVM-C" if sys.platform == "win32" else "LLVM")
    if system_library:
        yield system_library


def _probe_failure(library: str) -> str | None:
    """Why a known ray cast with this library fails in a process of its own; None where it does not."""
    search_path = os.pathsep.join(path or os.getcwd() for path in sys.path)
    environment = os.environ | {LIBRARY_VARIABLE: library, "PYTHONPATH": search_path}
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _PROBE, library],
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PROBE_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {_PROBE_SECONDS} s"
    if probe.returncode == 0:
        return None
    if probe.returncode < 0:
        return f"it aborts the process (signal {-probe.returncode})"
    return (probe.stderr.strip().splitlines() or [f"exit status {probe.returncode}"])[0]
