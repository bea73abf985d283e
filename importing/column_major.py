"""Arrays in which all frames of one pixel lie together, as column-major NumPy files have them: read in blocks."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import Any

import numpy as np

BLOCK_BYTES = 256_000_000
"""So much of the frames is held at a time; the file is read once for every block."""
_CHUNK_BYTES = 8_000_000
Read = Callable[[int], bytes]
"""Gives the next so many bytes; InputError where they are not there."""


def frames_across(
    opened: Callable[[], AbstractContextManager[Read]], shape: tuple[int, int, int], dtype: np.dtype[Any]
) -> Iterator[np.ndarray]:
    """The frames of an array (frame, row, column) whose bytes count frames first, then rows, then columns.

    A frame's numbers are strewn over all of the file. So as many frames as fit into 256 MB are picked out of one
    reading from beginning to end, then the next ones out of another: an array of 2 GB is read eight times.
    """
    count, height, width = shape
    pixels = height * width
    at_once = min(count, max(1, BLOCK_BYTES // (pixels * dtype.itemsize)))
    step = max(1, _CHUNK_BYTES // (count * dtype.itemsize))
    for first in range(0, count, at_once):
        block = np.empty((min(at_once, count - first), pixels), dtype)
        with opened() as read:
            for pixel in range(0, pixels, step):
                part = min(step, pixels - pixel)
                values = np.frombuffer(read(part * count * dtype.itemsize), dtype).reshape(part, count)
                block[:, pixel : pixel + part] = values[:, first : first + len(block)].T
        for number in range(len(block)):
            yield block[number].reshape(width, height).T.copy()  # A view would keep the block beside the next one.
        del block
