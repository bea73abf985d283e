"""Frames as OpenEXR files: one single-part image, plain channels, attributes that explain it alone."""

from pathlib import Path

import numpy as np
import OpenEXR

from recording.camera import PIXEL_CENTRE, Camera
from recording.errors import InputError
from recording.frame import Frame, Labels

Channels = dict[str, np.ndarray]
_LABELS = {"objectid": np.uint32, "face": np.uint32, "bary.u": np.float32, "bary.v": np.float32}


def write_frame(path: Path, frame: Frame, *, camera: Camera, fps: float) -> None:
    """Write `Z` and whatever truth the frame has."""
    channels: Channels = {"Z": stored_depth(frame.depth)}
    if frame.labels is not None:
        values = (frame.labels.objectid, frame.labels.face, frame.labels.u, frame.labels.v)
        channels |= {name: value for name, value in zip(_LABELS, values, strict=True) if value is not None}
    if frame.clean_depth is not None:
        channels["Z.clean"] = stored_depth(frame.clean_depth)
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


def write_channels(path: Path, channels: Channels, *, attributes: dict[str, object]) -> None:
    """Write single channels, run-length coded: the fastest of the lossless codings on depth and ids."""
    header = {"compression": OpenEXR.RLE_COMPRESSION, "type": OpenEXR.scanlineimage, **attributes}
    contiguous = {name: np.ascontiguousarray(pixels) for name, pixels in channels.items()}
    OpenEXR.File(header, contiguous).write(str(path))


def read_channels(path: Path, *, shape: tuple[int, int]) -> Channels:
    """The channels of a file, each of the expected shape (rows, columns)."""
    if not path.is_file():
        raise InputError(f"{path} is missing: the recording is not complete; make or import it again")
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
    except (RuntimeError, ValueError, MemoryError, TypeError) as error:  # OpenEXR raises what it likes.
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: expected an OpenEXR file, but it cannot be read: {reason}") from None
    for name, pixels in channels.items():
        if pixels.shape != shape:
            expected, came = f"{shape[1]}x{shape[0]}", "x".join(map(str, pixels.shape[::-1]))
            raise InputError(f"{path}: expected {expected} pixels, as recording.json says, got {came} in {name!r}")
    return channels


def stored_depth(depth: np.ndarray) -> np.ndarray:
    """The depth as it stands on disk: metres, 0 where nothing returned."""
    return np.nan_to_num(depth, nan=0.0).astype(np.float32)


def _depth(path: Path, channels: Channels, name: str) -> np.ndarray | None:
    """A depth channel with NaN where there is no return; None where there is no such channel."""
    if name not in channels:
        return None
    stored = channels[name].astype(np.float32)
    wrong = ~np.isfinite(stored) | (stored < 0)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise InputError(
            f"{path}: expected depth in metres, 0 where there is none, "
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
