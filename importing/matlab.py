"""Depth in MATLAB's files: one array (row, column, frame), as MATLAB has them."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError, matfile_version

from importing.arrays import LARGEST_BESIDE, beside_names, calibration_in, depth_name, one_line, three_sides, times_in
from importing.column_major import BLOCK_BYTES
from importing.images import metres
from importing.matlab5 import images_of
from importing.source import DepthSource, Wanted, needed
from recording.errors import DAMAGED, InputError
from recording.frame import Frame

_HDF5 = b"MATLAB 7.3"
_DAMAGED = (*DAMAGED, MatReadError)


@dataclass(frozen=True, kw_only=True)
class _Content:
    name: str
    """Of the depth."""
    shape: tuple[int, ...]
    """Row, column, frame."""
    others: dict[str, np.ndarray]
    """What lies beside the depth."""


def matlab_file(source: Path, wanted: Wanted) -> DepthSource:
    """The array (row, column, frame) of depth in a `.mat`, and beside it what an `.npz` may hold too."""
    try:
        with source.open("rb") as file:
            new = file.read(len(_HDF5)) == _HDF5
        found = _hdf5_content(source, wanted.key) if new else _content(source, wanted.key)
    except _DAMAGED as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{source}: expected a MATLAB file, but {one_line(error)}") from None
    shape = (*found.shape, 1) if len(found.shape) == 2 else found.shape
    frames, height, width = three_sides((*shape[-1:], *shape[:-1]), source=source)
    calibration = calibration_in(found.others, source=source)
    read = _hdf5_images if new else _images
    return DepthSource(
        kind="MATLAB array",
        height=height,
        width=width,
        count=frames,
        times=times_in(found.others, frames, source=source),
        calibration=calibration,
        frames=partial(_frames, partial(read, source, found), source, scale=wanted.known.scale or calibration.scale),
    )


def _frames(images: Any, source: Path, *, scale: float | None) -> Iterator[Frame]:
    try:
        for number, image in enumerate(images()):
            yield Frame(depth=metres(image, scale=scale, source=f"{source}, frame {number}"))
    except _DAMAGED as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{source}: expected a whole MATLAB file, but {one_line(error)}") from None


def _content(source: Path, key: str | None) -> _Content:
    shapes = {name: shape for name, shape, _ in whosmat(source)}
    name = depth_name([*shapes], key, source=source)
    small = [other for other, shape in shapes.items() if np.prod(shape, dtype=np.float64) < LARGEST_BESIDE]
    wanted = [other for other in small if other in beside_names() and other != name]
    others = {other: next(_images_named(source, other, shapes[other])) for other in wanted}
    return _Content(name=name, shape=shapes[name], others=others)


def _images(source: Path, found: _Content) -> Iterator[np.ndarray]:
    return _images_named(source, found.name, found.shape)


def _images_named(source: Path, name: str, shape: tuple[int, ...]) -> Iterator[np.ndarray]:
    """An array's images, one by one, for SciPy crashes on damaged files; of those before version 5 the only one."""
    if matfile_version(source)[0] == 1:
        return images_of(source, name, shape)
    return iter([loadmat(source, variable_names=[name])[name]])


def _hdf5_content(source: Path, key: str | None) -> _Content:
    """The content of a file of version 7.3, whose arrays lie in it with their sides turned round."""
    h5py = needed("h5py", extra="matlab", what=f"{source}, a MATLAB file of version 7.3")
    with h5py.File(source) as file:
        arrays = {name: value for name, value in file.items() if isinstance(value, h5py.Dataset)}
        name = depth_name([*arrays], key, source=source)
        small = [other for other, value in arrays.items() if (value.size or 0) < LARGEST_BESIDE]
        others = {other: np.asarray(arrays[other]).T for other in small if other in beside_names() and other != name}
        return _Content(name=name, shape=arrays[name].shape[::-1], others=others)


def _hdf5_images(source: Path, found: _Content) -> Iterator[np.ndarray]:
    """The images; where some lie in one deflated chunk, as many at a time."""
    h5py = needed("h5py", extra="matlab", what=f"{source}, a MATLAB file of version 7.3")
    with h5py.File(source) as file:
        depth = file[found.name]
        if depth.ndim == 2:
            yield np.ascontiguousarray(depth[()].T)
            return
        count, width, height = depth.shape
        fitting = max(1, BLOCK_BYTES // (width * height * depth.dtype.itemsize))
        at_once = min(depth.chunks[0] if depth.chunks else 1, fitting)
        for first in range(0, count, at_once):
            for image in depth[first : first + at_once]:
                yield np.ascontiguousarray(image.T)
