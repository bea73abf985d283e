"""Bags of ROS 1 and ROS 2, and RealSense's: depth images as 16UC1 or 32FC1, with CameraInfo and transforms."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from importing.calibration import Calibration
from importing.camera_file import foreign_calibration
from importing.compressed_depth import MARK, unpacked
from importing.images import metres
from importing.source import DepthSource, Wanted, needed
from importing.transforms import camera_place
from recording.errors import DAMAGED, InputError
from recording.frame import Frame
from recording.progress import tracked

IMAGE, CAMERA, NUMBER = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo", "std_msgs/msg/Float32"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
_WHOLE, _FLOATING = np.dtype(np.uint16), np.dtype(np.float32)
_KINDS: dict[str, "np.dtype[Any]"] = {"16UC1": _WHOLE, "mono16": _WHOLE, "32FC1": _FLOATING}
"""Encodings of depth; `mono16` is how RealSense calls its own."""
_ERRORS = {
    "rosbags.highlevel": "AnyReaderError",
    "rosbags.rosbag1": "ReaderError",
    "rosbags.rosbag2": "ReaderError",
    "rosbags.serde": "SerdeError",
    "rosbags.typesys": "TypesysError",
    "rosbags.rosbag2.reader": "zstd.ZstdError",
    "apsw": "Error",
}
"""The errors of rosbags and of the libraries that it reads with, none of which is another's."""
_UNITS = "/option/Depth_Units/value"
"""Where RealSense's bags say metres of one unit."""


@dataclass(frozen=True, kw_only=True)
class _About:
    """What one pass over a bag says."""

    topic: str
    height: int
    width: int
    times: tuple[float, ...]
    calibration: Calibration


def bag(source: Path, wanted: Wanted) -> DepthSource:
    """The depth images of a topic, by default of the only one that has depth, with their own time stamps."""
    place = source.parent if source.suffix.lower() in (".db3", ".mcap") else source
    with _opened(place) as reader:
        about = _about(reader, wanted, source)
    scale = wanted.known.scale or about.calibration.scale
    return DepthSource(
        kind=f"bag, topic {about.topic},",
        height=about.height,
        width=about.width,
        count=len(about.times),
        times=about.times,
        calibration=about.calibration,
        frames=partial(_frames, place, about, scale),
    )


@contextmanager
def _opened(place: Path) -> Iterator[Any]:
    """The bag's reader; whatever it does not like about the bag is an InputError."""
    highlevel = needed("rosbags.highlevel", extra="bags", what=f"{place}, a bag")
    typesys = needed("rosbags.typesys", extra="bags", what=f"{place}, a bag")
    usual = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)  # Bags before ROS 2 Iron do not describe their types.
    damaged: tuple[type[Exception], ...] = (*_damaged(), *DAMAGED)
    try:
        with highlevel.AnyReader([place], default_typestore=usual) as reader:
            yield reader
    except damaged as error:
        if isinstance(error, InputError):
            raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{place}: expected a bag of ROS 1 or 2, but it cannot be read: {reason}") from None


def _damaged() -> tuple[type[Exception], ...]:
    """What rosbags, and what it reads SQLite and Zstandard with, raise of their own."""
    return tuple(attrgetter(name)(import_module(module)) for module, name in _ERRORS.items())


def _about(reader: Any, wanted: Wanted, source: Path) -> _About:
    """Size, times and camera of a topic; all of its messages are looked at."""
    connection = _connection(reader, wanted.key, source)
    times, first = [], None
    messages = reader.messages(connections=[connection])
    for _, arrival_ns, content in tracked(messages, "looking at the time stamps", total=connection.msgcount):
        image = reader.deserialize(content, connection.msgtype)
        first = first or image
        stamp = image.header.stamp.sec + image.header.stamp.nanosec * 1e-9
        times.append(stamp or arrival_ns * 1e-9)
    if first is None:
        raise InputError(f"{source}: expected depth images in topic {connection.topic}, got none")
    calibration = _camera_beside(reader, connection.topic, source).under(_unit(reader, connection.topic))
    place = camera_place(reader, first.header.frame_id, tuple(times), wanted=wanted.world_frame, source=str(source))
    height, width = _numbers(first, f"{source}, frame 0").shape
    return _About(
        topic=connection.topic, height=height, width=width, times=tuple(times), calibration=calibration.under(place)
    )


def _connection(reader: Any, key: str | None, source: Path) -> Any:
    """The topic of depth images: the one that is asked for, or the only one whose first image is depth."""
    images = [each for each in reader.connections if each.msgtype in (IMAGE, COMPRESSED)]
    listed = ", ".join(sorted({each.topic for each in images})) or "none"
    if key is not None:
        chosen = [each for each in images if each.topic == key]
        if not chosen:
            raise InputError(f"{source}: expected images in topic {key!r}, got {listed}: name one of them by --key")
        return chosen[0]
    depth = [each for each in images if _first(reader, each, _is_depth)]
    if len(depth) != 1:
        many = ", ".join(sorted(each.topic for each in depth))
        raise InputError(
            f"{source}: expected a topic with images of {' or '.join(_KINDS)} or {MARK}, "
            + (f"got {many}: say which by --key TOPIC" if depth else f"got images of another kind, in topics {listed}")
        )
    return depth[0]


def _camera_beside(reader: Any, topic: str, source: Path) -> Calibration:
    """What the CameraInfo beside the images says; nothing where there is none.

    ROS has it beside the image's topic, RealSense one level above, in `info`.
    """
    space = topic.removesuffix(f"/{MARK}").rsplit("/", 1)[0]
    names = (f"{space}/camera_info", f"{space.rsplit('/', 1)[0]}/info/camera_info")
    found = [each for each in reader.connections if each.msgtype == CAMERA and each.topic in names]
    if not found:
        return Calibration()
    info = _first(reader, found[0], lambda message: message)
    if info is None:
        return Calibration()
    document = {
        "K": info.K if hasattr(info, "K") else info.k,
        "D": info.D if hasattr(info, "D") else info.d,
        "width": info.width,
        "height": info.height,
        "distortion_model": info.distortion_model,
    }
    return foreign_calibration(document, source=f"{source}: {found[0].topic}")


def _unit(reader: Any, topic: str) -> Calibration:
    """Metres of one unit where RealSense says it, of the sensor that the topic belongs to."""
    sensor = "/".join(topic.split("/")[:3])
    found = [each for each in reader.connections if each.msgtype == NUMBER and each.topic == f"{sensor}{_UNITS}"]
    value = _first(reader, found[0], lambda message: float(message.data)) if found else None
    return Calibration() if not value else Calibration(scale=round(value, 9))  # A float32 that means 0.001.


def _first(reader: Any, connection: Any, part: Callable[[Any], Any]) -> Any:
    """A part of a topic's first message; None where it has none."""
    for _, _, content in reader.messages(connections=[connection]):
        return part(reader.deserialize(content, connection.msgtype))
    return None


def _frames(place: Path, about: _About, scale: float | None) -> Iterator[Frame]:
    with _opened(place) as reader:
        connection = _connection(reader, about.topic, place)
        for number, (_, _, content) in enumerate(reader.messages(connections=[connection])):
            source = f"{place}, frame {number}"
            image = _numbers(reader.deserialize(content, connection.msgtype), source)
            if image.shape != (about.height, about.width):
                came = f"{image.shape[1]}x{image.shape[0]}"
                raise InputError(
                    f"{source}: expected {about.width}x{about.height} pixels, as the first image has, got {came}"
                )
            yield Frame(depth=metres(image, scale=scale, source=source))


def _is_depth(message: Any) -> bool:
    """Whether a message is an image of depth."""
    return MARK in message.format if message.__msgtype__ == COMPRESSED else message.encoding in _KINDS


def _numbers(message: Any, source: str) -> np.ndarray:
    """The numbers of an image message; its rows may be longer than its pixels are."""
    if message.__msgtype__ == COMPRESSED:
        return unpacked(message.format, message.data, source=source)
    kind = _KINDS.get(message.encoding)
    if kind is None:
        raise InputError(f"{source}: expected an image of {' or '.join(_KINDS)}, got {message.encoding!r}")
    length = message.width * kind.itemsize
    if message.step < length or len(message.data) != message.height * message.step:
        came = f"got {len(message.data)} bytes"
        raise InputError(f"{source}: expected {message.height} rows of {message.step} bytes, {came}")
    rows = np.ascontiguousarray(message.data.reshape(message.height, message.step)[:, :length])
    return rows.view(kind.newbyteorder(">" if message.is_bigendian else "<"))
