"""NumPy archives that are written piece by piece, so that no array has to be in memory as a whole."""

import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike


class Archive:
    """An `.npz` that is being written."""

    def __init__(self, file: zipfile.ZipFile) -> None:
        self._file = file

    def add(self, name: str, array: np.ndarray) -> None:
        """Write an array that is there."""
        self.stream(name, [array], shape=array.shape, dtype=array.dtype)

    def stream(self, name: str, pieces: Iterable[np.ndarray], *, shape: tuple[int, ...], dtype: DTypeLike) -> None:
        """Write an array of that shape of which the pieces follow one another along the first axis."""
        kind = np.dtype(dtype)
        about: dict[str, Any] = {"descr": np.lib.format.dtype_to_descr(kind), "fortran_order": False, "shape": shape}
        entry = zipfile.ZipInfo(f"{name}.npy")  # Without the time of day: the same arrays give the same bytes.
        entry.compress_type = zipfile.ZIP_DEFLATED
        with self._file.open(entry, "w", force_zip64=True) as member:
            np.lib.format.write_array_header_2_0(member, about)
            for piece in pieces:
                member.write(np.ascontiguousarray(piece, kind).tobytes())


@contextmanager
def new_archive(path: Path) -> Iterator[Archive]:
    """An archive to add arrays to, compressed."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        yield Archive(file)
