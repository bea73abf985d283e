"""One array out of a MATLAB file of version 5 to 7, read image by image.

SciPy reads whole arrays. Here only the way to the numbers is gone, as "MAT-File Format" (The MathWorks) describes it:
after 128 bytes elements follow one another, each a tag (type and length, 4 bytes each) and its content, which may be
deflated. An array is an element of elements: flags, sides, name, numbers.
"""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

_HEADER_BYTES, _ORDER_AT, _TAG_BYTES = 128, 126, 8
_ARRAY, _DEFLATED = 14, 15
_STORED = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""How numbers lie in the file, by the type in their tag; MATLAB takes the smallest that holds them all."""
_CLASSES = {6: "f8", 7: "f4", 8: "i1", 9: "u1", 10: "i2", 11: "u2", 12: "i4", 13: "u4", 14: "i8", 15: "u8"}
"""What they are in MATLAB, by the class in the array's flags."""
_OPAQUE, _COMPLEX = 17, 0x800
"""The class of what has no sides, and the flag of complex numbers."""
_LONGEST_PART = 10_000
"""Flags, sides and names are shorter than this."""
_CHUNK_BYTES = 1_000_000


class _Plain:
    """The bytes of an element as they are."""

    def __init__(self, file: BinaryIO, size: int) -> None:
        self._file, self._left = file, size

    def read(self, size: int) -> bytes:
        """The next so many bytes."""
        if size > self._left:
            raise ValueError("an array ends too early")
        content = self._file.read(size)
        if len(content) != size:
            raise ValueError("the file is not complete")
        self._left -= size
        return content


class _Inflated:
    """The bytes of an element that is deflated."""

    def __init__(self, file: BinaryIO, size: int) -> None:
        self._file, self._left = file, size
        self._inflater, self._waiting = zlib.decompressobj(), b""

    def read(self, size: int) -> bytes:
        """The next so many bytes."""
        parts = []
        while size > 0:
            if not self._waiting and not self._inflater.eof and self._left:
                self._waiting = self._file.read(min(_CHUNK_BYTES, self._left))
                self._left -= len(self._waiting)
            try:
                part = self._inflater.decompress(self._waiting, size)
            except zlib.error as error:
                raise ValueError(str(error)) from None
            if not part and (self._inflater.eof or not self._waiting):
                raise ValueError("the file is not complete")
            self._waiting = self._inflater.unconsumed_tail
            size -= len(part)
            parts.append(part)
        return b"".join(parts)


_Bytes = _Plain | _Inflated


@dataclass(frozen=True, kw_only=True)
class _Array:
    """An array whose numbers come next."""

    name: str
    sides: tuple[int, ...]
    kind: "np.dtype[Any] | None"
    """What its numbers are in MATLAB; None where they are none, or complex."""
    content: _Bytes


def images_of(source: Path, name: str, shape: tuple[int, ...]) -> Iterator[np.ndarray]:
    """The images of the array (row, column, frame) with this name and shape; ValueError where the file is damaged."""
    with source.open("rb") as file:
        file.seek(_ORDER_AT)
        order = {b"IM": "<", b"MI": ">"}.get(file.read(2))
        if order is None:
            raise ValueError("it does not say the order of its bytes")
        array = _array(file, name, order)
        if array.kind is None:
            raise ValueError("the array holds no real numbers")
        if array.sides != shape:
            raise ValueError(f"there are two arrays {name!r}")
        yield from _images(array, array.kind, order)


def _images(array: _Array, kind: "np.dtype[Any]", order: str) -> Iterator[np.ndarray]:
    stored_kind, size, inside = _tag(array.content, order)
    if stored_kind not in _STORED:
        raise ValueError("the array's numbers are of no kind that is known")
    stored = np.dtype(order + _STORED[stored_kind])
    height, width, count = (*array.sides, 1)[:3]
    if size != height * width * count * stored.itemsize:
        raise ValueError(f"{size} bytes are not {height}x{width}x{count} numbers")
    content = array.content if inside is None else BytesIO(inside)
    for _ in range(count):
        image = np.frombuffer(content.read(height * width * stored.itemsize), stored)
        yield image.reshape(width, height).T.astype(kind)


def _array(file: BinaryIO, name: str, order: str) -> _Array:
    """The array with this name."""
    place = _HEADER_BYTES
    while True:
        file.seek(place)
        outer = _Plain(file, _TAG_BYTES)
        kind, size, _ = _tag(outer, order)
        content = _Inflated(file, size) if kind == _DEFLATED else _Plain(file, size)
        if kind == _DEFLATED:
            kind, _, _ = _tag(content, order)
        if kind == _ARRAY:
            array = _head(content, order)
            if array.name == name:
                return array
        place += _TAG_BYTES + size


def _head(content: _Bytes, order: str) -> _Array:
    flags = struct.unpack(f"{order}I", _part(content, order)[:4])[0]
    sides = b"" if flags & 255 == _OPAQUE else _part(content, order)
    real = flags & 255 in _CLASSES and not flags & _COMPLEX
    return _Array(
        name=_part(content, order).decode("latin-1"),
        sides=tuple(np.frombuffer(sides, f"{order}i4").tolist()),
        kind=np.dtype(_CLASSES[flags & 255]) if real else None,
        content=content,
    )


def _part(content: _Bytes, order: str) -> bytes:
    """The content of a small element, without what fills it up to a multiple of eight bytes."""
    _, size, inside = _tag(content, order)
    if size > _LONGEST_PART:
        raise ValueError(f"{size} bytes are too many for the head of an array")
    return content.read(size + -size % 8)[:size] if inside is None else inside


def _tag(content: _Bytes, order: str) -> tuple[int, int, bytes | None]:
    """Type and length of the next element, and its content where that is so short that it lies in the tag itself."""
    tag = content.read(_TAG_BYTES)
    kind, size = struct.unpack(f"{order}2I", tag)
    if kind >> 16:
        return kind & 0xFFFF, kind >> 16, tag[4 : 4 + (kind >> 16)]
    return kind, size, None
