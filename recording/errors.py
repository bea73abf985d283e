"""The one error that a user's input can raise, and those that become it."""

import lzma
import struct
import tokenize
import zipfile
import zlib


class InputError(ValueError):
    """The input or the arguments are wrong: one sentence with what was expected, what came, what to do.

    It is raised once, at the boundary, and the command line turns it into one line on standard error
    and exit status 2.
    """


DAMAGED = (
    *(ArithmeticError, AssertionError, AttributeError, EOFError, LookupError, MemoryError, NameError, OSError),
    *(RuntimeError, SyntaxError, TypeError, ValueError),
    *(lzma.LZMAError, struct.error, tokenize.TokenError, zipfile.BadZipFile, zlib.error),
)
"""What readers that others wrote end with where a file is damaged, as fuzzing has shown; an `InputError` is among them.

Those of NumPy, SciPy, h5py, Arrow, trimesh, zipfile; some raise errors of their own beside them. `NameError` is a
variable without a value: SciPy and trimesh leave some so.
"""
