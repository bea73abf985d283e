"""Depth in NumPy's files: one array of all frames in an `.npz` or `.npy`, read frame by frame."""

import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from importing.calibration import Calibration
from importing.column_major import Read, frames_across
from importing.images import metres
from importing.source import DepthSource, Wanted
from recording.checks import validated
from recording.errors import DAMAGED, InputError
from recording.frame import Frame

DEPTH_NAMES = ("depth", "depths", "Z", "z")
_MATRIX, _TIMES = ("K", "intrinsics", "camera_matrix"), ("timestamps", "times", "t")
LARGEST_BESIDE = 1_000_000
"""Cameras and time stamps are fewer numbers than this."""


@runtime_checkable
class _Bytes(Protocol):
    """What is read from its beginning to its end, a file or a member of an archive."""

    def read(self, size: int = -1, /) -> bytes: ...


@dataclass(frozen=True, kw_only=True)
class _Header:
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    column_major: bool


def numpy_file(source: Path, wanted: Wanted) -> DepthSource:
    """The array (frame, row, column) of depth in an `.npz` or `.npy`.

    An archive may also hold `fx`, `fy`, `cx`, `cy` or the matrix `K`, `fps`, `scale`, `width`, `height`,
    `distortion`, `pixel_centre`, `world_from_camera`, and `timestamps` in seconds.
    """
    try:
        if source.suffix.lower() == ".npy":
            member, others, sizes = None, {}, {}
        else:
            with zipfile.ZipFile(source) as archive:
                sizes = {
                    each.filename.removesuffix(".npy"): each.file_size
                    for each in archive.infolist()
                    if each.filename.endswith(".npy")
                }
            names, small = [*sizes], [name for name, size in sizes.items() if size < 8 * LARGEST_BESIDE]
            member = depth_name(names, wanted.key, source=source)
            with np.load(source, allow_pickle=False) as arrays:
                others = {name: np.asarray(arrays[name]) for name in small if name in beside_names() and name != member}
        header = _read_header(source, member)
    except DAMAGED as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{source}: expected arrays of numbers as NumPy saves them: {one_line(error)}") from None
    frames, height, width = three_sides(header.shape, source=source)
    if header.dtype.kind not in "uif":
        raise InputError(f"{source}: expected numbers, got {header.dtype}")
    promised, there = (
        frames * height * width * header.dtype.itemsize,
        sizes[member] if member else source.stat().st_size,
    )
    if promised > there:
        raise InputError(f"{source}: expected {promised} bytes of depth, got {there}: the file is not complete")
    return DepthSource(
        kind="NumPy array",
        height=height,
        width=width,
        count=frames,
        times=times_in(others, frames, source=source),
        calibration=calibration_in(others, source=source),
        frames=partial(_frames, source, member, header, scale=_scale(wanted, others)),
    )


def depth_name(names: list[str], key: str | None, *, source: Path) -> str:
    """Which of the arrays is the depth: the one that is asked for, or is called so, or is alone."""
    listed = ", ".join(sorted(names)) or "none"
    if key is not None:
        if key not in names:
            raise InputError(f"{source}: expected an array {key!r}, got {listed}: name one of them by --key")
        return key
    likely = [name for name in DEPTH_NAMES if name in names]
    others = [name for name in names if name not in beside_names()]
    if likely:
        return likely[0]
    if len(others) != 1:
        raise InputError(f"{source}: expected an array 'depth', got {listed}: say which it is by --key NAME")
    return others[0]


def beside_names() -> set[str]:
    """The names of what may lie beside the depth."""
    return {*Calibration.model_fields, *_MATRIX, *_TIMES}


def calibration_in(arrays: Mapping[str, np.ndarray], *, source: Path) -> Calibration:
    """The camera by the arrays that lie beside the depth."""
    known: dict[str, Any] = {}
    matrix = next((arrays[name] for name in _MATRIX if name in arrays), None)
    if matrix is not None:
        if matrix.shape != (3, 3) or matrix.dtype.kind not in "iuf":
            raise InputError(f"{source}: expected a 3x3 camera matrix, got shape {matrix.shape}")
        known = {"fx": matrix[0, 0], "fy": matrix[1, 1], "cx": matrix[0, 2], "cy": matrix[1, 2]}
    for name in Calibration.model_fields:
        if name in arrays:
            value = np.asarray(arrays[name])
            known[name] = value.item() if value.size == 1 else np.squeeze(value).tolist()
    return validated(Calibration, {name: _plain(value) for name, value in known.items()}, source=str(source))


def times_in(arrays: Mapping[str, np.ndarray], frames: int, *, source: Path) -> tuple[float, ...] | None:
    """The frames' times, seconds."""
    found = next((arrays[name] for name in _TIMES if name in arrays), None)
    if found is None:
        return None
    if found.size != frames or found.dtype.kind not in "iuf":
        raise InputError(f"{source}: expected {frames} time stamps, one a frame, got {found.size} of {found.dtype}")
    return tuple(map(float, found.ravel()))


def three_sides(shape: tuple[int, ...], *, source: Path) -> tuple[int, int, int]:
    """Frames, rows and columns; a single image is one frame."""
    sides = (1, *shape) if len(shape) == 2 else shape
    if len(sides) != 3 or min(sides) < 1:
        raise InputError(f"{source}: expected depth of shape (frame, row, column), got {shape}")
    return sides[0], sides[1], sides[2]


def one_line(error: Exception) -> str:
    """What an error says, without its line breaks."""
    return " ".join(str(error).split()) or type(error).__name__


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _scale(wanted: Wanted, others: Mapping[str, np.ndarray]) -> float | None:
    if wanted.known.scale is not None or "scale" not in others:
        return wanted.known.scale
    return float(others["scale"])


@contextmanager
def _stream(source: Path, member: str | None) -> Iterator[_Bytes]:
    if member is None:
        with source.open("rb") as file:
            yield file
    else:
        with zipfile.ZipFile(source) as archive, archive.open(f"{member}.npy") as file:
            yield file


def _read_header(source: Path, member: str | None) -> _Header:
    with _stream(source, member) as file:
        return _header(file)


def _header(file: _Bytes) -> _Header:
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, column_major, dtype = read(file)
    if dtype.hasobject:
        raise ValueError("it holds Python objects, which are never read")
    return _Header(shape=shape, dtype=dtype, column_major=column_major)


def _frames(source: Path, member: str | None, header: _Header, *, scale: float | None) -> Iterator[Frame]:
    """Frame by frame: in the order of the bytes, or block by block where the columns come first."""
    shape = three_sides(header.shape, source=source)
    opened = partial(_content, source, member)
    images = frames_across(opened, shape, header.dtype) if header.column_major else _in_order(opened, shape, header)
    for number, image in enumerate(images):
        yield Frame(depth=metres(image, scale=scale, source=f"{source}, frame {number}"))


def _in_order(
    opened: Callable[[], AbstractContextManager[Read]], shape: tuple[int, int, int], header: _Header
) -> Iterator[np.ndarray]:
    count, height, width = shape
    with opened() as read:
        for _ in range(count):
            yield np.frombuffer(read(height * width * header.dtype.itemsize), header.dtype).reshape(height, width)


@contextmanager
def _content(source: Path, member: str | None) -> Iterator[Read]:
    """Reads the array's numbers, from the first on."""
    with _stream(source, member) as file:
        _header(file)
        yield partial(_exactly, file, source)


def _exactly(file: _Bytes, source: Path, size: int) -> bytes:
    try:
        content = file.read(size)
    except DAMAGED as error:
        raise InputError(f"{source}: expected a whole archive, but {one_line(error)}") from None
    if len(content) != size:
        raise InputError(f"{source}: expected {size} more bytes, got {len(content)}: the file is not complete")
    return content
