"""Loops over pixels, compiled to machine code."""

import inspect
from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function compiled by numba at its first call and kept on disk; it lets other threads run meanwhile.

    Arrays of another type or memory order are compiled for anew, so callers always hand over the same. Whatever
    the tests wrap around a function to check its annotations is taken off first: numba compiles plain functions.
    """
    return njit(cache=True, nogil=True)(inspect.unwrap(function))
