"""Depth in MATLAB's files: one array (row, column, frame), as MATLAB has them."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError

from importing.arrays import beside_names, calibration_in, depth_name, one_line, three_sides, times_in
from importing.images import metres
from importing.source import DepthSource, Wanted, needed
from recording.errors import InputError
from recording.frame import Frame

_HDF5 = b"MATLAB 7.3"
_DAMAGED = (OSError, ValueError, TypeError, KeyError, EOFError, MatReadError, NotImplementedError, MemoryError)
"""What the readers raise at files that are none."""


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
    frames, height, width = three_sides((shape[-1], *shape[:-1]), source=source)
    calibration = calibration_in(found.others, source=source)
    read = _hdf5_images if new else _images
    return DepthSource(
        kind="MATLAB array",
        height=height,
        width=width,
        count=frames,
        times=times_in(found.others, frames, source=source),
        calibration=calibration,
        frames=partial(
            _frames, partial(read, source, found.name), source, scale=wanted.known.scale or calibration.scale
        ),
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
    wanted = [other for other in shapes if other in beside_names() and other != name]
    others = loadmat(source, variable_names=wanted) if wanted else {}
    return _Content(name=name, shape=shapes[name], others={other: np.asarray(others[other]) for other in wanted})


def _images(source: Path, name: str) -> Iterator[np.ndarray]:
    """The images; files of this kind hold at most 2 GB an array, which is read whole."""
    depth = np.atleast_3d(loadmat(source, variable_names=[name])[name])
    for number in range(depth.shape[2]):
        yield np.ascontiguousarray(depth[..., number])


def _hdf5_content(source: Path, key: str | None) -> _Content:
    """The content of a file of version 7.3, whose arrays lie in it with their sides turned round."""
    h5py = needed("h5py", extra="matlab", what=f"{source}, a MATLAB file of version 7.3")
    with h5py.File(source) as file:
        arrays = {name: value for name, value in file.items() if isinstance(value, h5py.Dataset)}
        name = depth_name([*arrays], key, source=source)
        others = {other: np.asarray(arrays[other]).T for other in arrays if other in beside_names() and other != name}
        return _Content(name=name, shape=arrays[name].shape[::-1], others=others)


def _hdf5_images(source: Path, name: str) -> Iterator[np.ndarray]:
    h5py = needed("h5py", extra="matlab", what=f"{source}, a MATLAB file of version 7.3")
    with h5py.File(source) as file:
        depth = file[name]
        for number in range(depth.shape[0] if depth.ndim == 3 else 1):
            image = depth[number] if depth.ndim == 3 else depth[()]
            yield np.ascontiguousarray(image.T)
