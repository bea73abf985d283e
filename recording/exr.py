"""Frames as OpenEXR files: one single-part image, plain channels, attributes that explain it alone."""

import os
import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from recording.camera import PIXEL_CENTRE, Camera
from recording.errors import InputError
from recording.frame import FARTHEST_M, NEAREST_M, Frame, Labels
from recording.xray import Cutout, CutoutXRay, XRay, trimmed_cutouts

Channels = dict[str, np.ndarray]
_CODING = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
"""Lossless, read everywhere. Run lengths take two thirds of the time to write, and up to three times the room."""
_LABELS = {"objectid": np.uint32, "face": np.uint32, "bary.u": np.float32, "bary.v": np.float32}

_MOST_CHANNELS = 64
_ONE_AT_A_TIME = threading.Lock()


def write_frame(path: Path, frame: Frame, *, camera: Camera, fps: float) -> None:
    """Write `Z` and whatever truth the frame has."""
    channels: Channels = {"Z": stored_depth(frame.depth)}
    if frame.labels is not None:
        values = (frame.labels.objectid, frame.labels.face, frame.labels.u, frame.labels.v)
        channels |= {name: value for name, value in zip(_LABELS, values, strict=True) if value is not None}
    if frame.clean_depth is not None:
        same = frame.clean_depth is frame.depth
        channels["Z.clean"] = channels["Z"] if same else stored_depth(frame.clean_depth)
    if frame.reason is not None:
        channels["reason"] = frame.reason
    write_channels(path, channels, attributes=_conventions(camera, fps))


def read_frame(path: Path, *, shape: tuple[int, int]) -> Frame:
    """The frame in a file of the expected shape (rows, columns)."""
    channels = read_channels(path, shape=shape)
    depth = _depth(path, channels, "Z")
    if depth is None:
        raise InputError(f"{path}: expected a channel 'Z', got {sorted(channels)}: is it a depth frame?")
    for name, kind in {**_LABELS, "reason": np.uint32}.items():
        if name in channels and channels[name].dtype != kind:
            raise InputError(f"{path}: expected channel {name!r} as {np.dtype(kind)}, got {channels[name].dtype}")
    labels = None
    if "objectid" in channels:
        labels = Labels(
            objectid=channels["objectid"],
            face=channels.get("face"),
            u=channels.get("bary.u"),
            v=channels.get("bary.v"),
        )
    return Frame(
        depth=depth,
        labels=labels,
        clean_depth=_depth(path, channels, "Z.clean"),
        reason=channels.get("reason"),
    )


def write_xray(path: Path, xray: XRay, *, shape: tuple[int, int]) -> None:
    """Write a part `xray_N` for each object N, as large as the object: its data window lies in the picture."""
    picture = _window(0, 0, shape)
    parts = [
        OpenEXR.Part(
            {
                **_CODING,
                "displayWindow": picture,
                "dataWindow": _window(cutout.row, cutout.column, cutout.depth.shape),
                "unocclude.depth": "metres along the camera's z axis, 0 = not this object",
            },
            {f"xray_{objectid}": np.ascontiguousarray(stored_depth(cutout.depth))},
            f"xray_{objectid}",
        )
        for objectid, cutout in trimmed_cutouts(xray).items()
    ]
    _write(OpenEXR.File(parts), path)


def read_xray(path: Path, *, shape: tuple[int, int]) -> CutoutXRay:
    """The X-ray in a file whose picture has the expected shape (rows, columns)."""
    cutouts = {}
    for header, channels in _parts(path, shape):
        column, row = (int(place) for place in header["dataWindow"][0])
        for name, pixels in channels.items():
            if not re.fullmatch(r"xray_\d+", name):
                raise InputError(f"{path}: expected channels 'xray_' and an object's id, got {name!r}")
            last_row, last_column = row + pixels.shape[0], column + pixels.shape[1]
            if min(row, column) < 0 or last_row > shape[0] or last_column > shape[1]:
                came = f"{name!r} in rows {row} to {last_row - 1} and columns {column} to {last_column - 1}"
                raise InputError(f"{path}: expected parts within {shape[1]}x{shape[0]} pixels, got {came}")
            depth = np.where(pixels > 0, pixels, np.float32(np.nan))
            cutouts[int(name.removeprefix("xray_"))] = Cutout(row=row, column=column, depth=depth)
    return CutoutXRay(cutouts, shape)


def write_channels(path: Path, channels: Channels, *, attributes: dict[str, object]) -> None:
    """Write single channels."""
    contiguous = {name: np.ascontiguousarray(pixels) for name, pixels in channels.items()}
    _write(OpenEXR.File({**_CODING, **attributes}, contiguous), path)


def read_channels(path: Path, *, shape: tuple[int, int]) -> Channels:
    """The channels of a file, each of the expected shape (rows, columns)."""
    channels = {name: pixels for _, part in _parts(path, shape) for name, pixels in part.items()}
    for name, pixels in channels.items():
        if pixels.shape != shape:
            expected, came = f"{shape[1]}x{shape[0]}", "x".join(map(str, pixels.shape[::-1]))
            raise InputError(f"{path}: expected {expected} pixels, as recording.json says, got {came} in {name!r}")
    return channels


def stored_depth(depth: np.ndarray) -> np.ndarray:
    """The depth as it stands on disk: metres, 0 where nothing returned."""
    return np.where(np.isnan(depth), np.float32(0), depth.astype(np.float32, copy=False))


def _write(file: OpenEXR.File, path: Path) -> None:
    try:
        file.write(str(path))
    except RuntimeError as error:
        raise InputError(f"{path}: cannot be written: {_one_line(error)}") from None


def _parts(path: Path, shape: tuple[int, int]) -> list[tuple[dict[str, Any], Channels]]:
    """Header and channels of each part of a file; none is larger than the shape (rows, columns)."""
    if not path.is_file():
        raise InputError(f"{path} is missing: the recording is not complete; make or import it again")
    try:
        with hushed():
            promised = _promised(path, shape)
            with OpenEXR.File(str(path), separate_channels=True) as file:
                parts = [
                    (dict(part.header), {name: np.array(channel.pixels) for name, channel in part.channels.items()})
                    for part in file.parts
                ]
    except InputError:
        raise
    except (RuntimeError, ValueError, MemoryError, TypeError) as error:  # OpenEXR raises what it likes.
        raise InputError(f"{path}: expected an OpenEXR file, but it cannot be read: {_one_line(error)}") from None
    if [len(channels) for _, channels in parts] != promised:  # OpenEXR leaves out what it cannot decode.
        raise InputError(f"{path}: expected an OpenEXR file, but its pixels are damaged: make or import it again")
    return parts


def _promised(path: Path, shape: tuple[int, int]) -> list[int]:
    """How many channels each part has, by its header; refused where no frame has so much, before there is room for it.

    A compressed channel of nothing takes hardly any room on disk, and a picture's in memory.
    """
    with OpenEXR.File(str(path), header_only=True) as file:
        headers = [dict(part.header) for part in file.parts]  # The file empties its own when it closes.
    for header in headers:
        first, last = header["dataWindow"]
        columns, rows = (last.astype(np.int64) - first + 1).tolist()
        if rows * columns > shape[0] * shape[1]:
            expected = f"{shape[1]}x{shape[0]}"
            raise InputError(f"{path}: expected {expected} pixels, as recording.json says, got {columns}x{rows}")
        if len(header["channels"]) > _MOST_CHANNELS:
            raise InputError(f"{path}: expected {_MOST_CHANNELS} channels at the most, got {len(header['channels'])}")
    return [len(header["channels"]) for header in headers]


@contextmanager
def hushed() -> Iterator[None]:
    """Within this block nothing is printed: OpenEXR writes what we say in words of ours, on both outputs.

    It does so by the file's number, or by `sys.stdout`, which all threads share: hence the lock.
    """
    with _ONE_AT_A_TIME, redirect_stdout(StringIO()):
        kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            os.close(nowhere)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _window(row: int, column: int, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The first and the last (column, row) of a rectangle, as OpenEXR wants them."""
    first = np.array([column, row], dtype=np.int32)
    return first, first + np.array(shape[::-1], dtype=np.int32) - 1


def _depth(path: Path, channels: Channels, name: str) -> np.ndarray | None:
    """A depth channel with NaN where there is no return; None where there is no such channel."""
    if name not in channels:
        return None
    stored = channels[name].astype(np.float32)
    wrong = (stored != 0) & ~((stored >= NEAREST_M) & (stored <= FARTHEST_M))
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise InputError(
            f"{path}: expected depth in metres from {NEAREST_M:g} to {FARTHEST_M:g}, 0 where there is none, "
            f"got {stored[row, column]} in {name!r} at row {row}, column {column}"
        )
    return np.where(stored > 0, stored, np.float32(np.nan))


def _conventions(camera: Camera, fps: float) -> dict[str, object]:
    """EXR attributes that let one frame explain itself; matrices as text, for EXR's own are left-handed."""
    matrix = " ".join(repr(float(value)) for value in camera.world_from_camera.ravel())
    return {
        "unocclude.depth": "metres along the camera's z axis, 0 = no return",
        "unocclude.axes": "OpenCV: x right, y down, z forward",
        "unocclude.pixelCentre": f"{PIXEL_CENTRE}",
        "unocclude.intrinsics": f"fx {camera.fx!r} fy {camera.fy!r} cx {camera.cx!r} cy {camera.cy!r}",
        "unocclude.worldFromCamera": f"row-major 4x4: {matrix}",
        "unocclude.fps": f"{fps!r}",
    }
