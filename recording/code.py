"""Which code a result came from."""

import ast
import hashlib
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path

OURS = ("recording", "simulator", "algorithm", "evaluation")
"""The packages whose source counts."""
LIBRARIES = ("numba", "numpy", "opencv-contrib-python-headless", "scikit-learn", "scipy")
"""What computes for them: another version may give other numbers."""
_ROOT = Path(__file__).parents[1]


@cache
def code_digest(*modules: str, alone: tuple[str, ...] = (), apart: tuple[str, ...] = ()) -> str:
    """SHA-256 of the source of the modules and of all of ours that they import, and of the libraries' versions.

    Modules are named as for `import`. What those of `alone` import does not count; those `apart` do not count at all.
    It is the same in every process and on every machine with the same code, and changes with any character of it.
    """
    content = hashlib.sha256()
    for name in sorted(_needed(modules).union(alone).difference(apart)):
        content.update(name.encode())
        content.update(_source(name).read_bytes())
    content.update(" ".join(f"{name} {version(name)}" for name in LIBRARIES).encode())
    return content.hexdigest()


def _needed(modules: Iterable[str]) -> set[str]:
    """The modules and what they import of ours, directly or not."""
    found, waiting = set(), list(modules)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += imported_modules(name)
    return found


@cache
def imported_modules(module: str) -> tuple[str, ...]:
    """The modules of ours that a module's source imports itself, wherever in it."""
    names: list[str] = []
    for node in ast.walk(ast.parse(_source(module).read_bytes())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return tuple(_ours(dict.fromkeys(names)))


def _ours(names: Iterable[str]) -> Iterator[str]:
    return (name for name in names if name.partition(".")[0] in OURS and _source(name).is_file())


def _source(module: str) -> Path:
    """The file of a module; one that is not there where the name is a package's or a function's."""
    return _ROOT.joinpath(*module.split(".")).with_suffix(".py")
