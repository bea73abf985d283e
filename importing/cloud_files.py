"""The points in one file: PLY, PCD, XYZ text, or NumPy's NPY."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from jaxtyping import Float
from trimesh.exchange.ply import load_ply

from importing.source import needed
from recording.checks import text_of
from recording.errors import DAMAGED, InputError

_HEAD_BYTES, _LONGEST_COUNT = 10_000, 4
"""So much of a PCD file is its header, and so many digits may say how many numbers a field has."""


def cloud(path: Path) -> Float[np.ndarray, "point 3"]:
    """The points that a file holds, metres if the file has metres; those that are not finite left out."""
    try:
        points = _READERS[path.suffix.lower()](path)
    except InputError:
        raise
    except DAMAGED as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(
            f"{path}: expected points, but it cannot be read: {reason}"
        ) from None  # Readers raise all sorts.
    if points.ndim < 2 or points.shape[-1] < 3 or points.dtype.kind not in "iuf":
        raise InputError(f"{path}: expected rows of x, y, z, got shape {points.shape} of {points.dtype}")
    places = points.reshape(-1, points.shape[-1])[:, :3].astype(np.float64)
    return places[np.isfinite(places).all(axis=1)]


def _ply(path: Path) -> np.ndarray:
    with path.open("rb") as file:
        if file.read(3) != b"ply":
            raise ValueError("it does not begin with 'ply'")
        file.seek(0)
        return np.asarray(load_ply(file)["vertices"])


def _pcd(path: Path) -> np.ndarray:
    with path.open("rb") as file:
        lines = [line.split() for line in file.read(_HEAD_BYTES).splitlines() if line.startswith(b"COUNT")]
    if any(len(count) > _LONGEST_COUNT for _, *counts in lines for count in counts):  # The reader would name each.
        raise ValueError("a field has too many numbers")
    pypcd4 = needed("pypcd4", extra="clouds", what=f"{path}, a PCD file")
    return np.asarray(pypcd4.PointCloud.from_path(path).numpy(("x", "y", "z")))


def _text(path: Path) -> np.ndarray:
    """Words or comma-separated values, the first three of a line; lines of comments begin with # or //."""
    lines = text_of(path, "text file of points").replace(",", " ").splitlines()
    rows = [words for words in (line.split() for line in lines) if words and not words[0].startswith(("#", "//"))]
    if rows and len(rows[0]) == 1 and rows[0][0].isdigit():  # Some write the number of points first.
        rows = rows[1:]
    return np.array([row[:3] for row in rows], dtype=np.float64).reshape(len(rows), -1 if rows else 3)


def _npy(path: Path) -> np.ndarray:
    return np.load(path, allow_pickle=False)


_READERS: dict[str, Callable[[Path], np.ndarray]] = {
    ".ply": _ply,
    ".pcd": _pcd,
    ".xyz": _text,
    ".txt": _text,
    ".csv": _text,
    ".npy": _npy,
}
SUFFIXES = tuple(_READERS)
