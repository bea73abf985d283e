"""The one interface of all formats: depth images with their times, read one by one."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from importlib import import_module
from types import ModuleType

from importing.calibration import Calibration
from recording.camera import Camera
from recording.errors import InputError
from recording.frame import Frame


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What the user says of the source; each format takes what concerns it."""

    known: Calibration = field(default_factory=Calibration)
    """Of the camera; it overrides what the source says itself."""
    pattern: str | None = None
    """Names of the files in a folder; the only kind of file that is there by default."""
    masks: str | None = None
    """Names of images of object ids, one for each depth image."""
    key: str | None = None
    """Name of the array in an archive, or of the topic in a bag."""
    world_frame: str | None = None
    """Name of the frame of a bag's transforms that is the world; by default one that ROS fixes."""
    axes: str = "opencv"
    """Which way the axes of point clouds point: a key of `clouds.AXES`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DepthSource:
    """Depth images as the files have them, with whatever the files say of their times and their camera."""

    kind: str
    """What it is, for messages."""
    height: int
    width: int
    count: int
    """How many frames `frames` gives."""
    frames: Callable[[], Iterator[Frame]]
    """Reads them from the first on, one at a time, whenever it is called."""
    times: tuple[float, ...] | None = None
    """Seconds, one a frame; None where they are not known."""
    calibration: Calibration = field(default_factory=Calibration)
    """What the files say of the camera."""
    camera: Camera | None = None
    """The camera itself, where the source made the pictures and nothing is left to be said of it."""


def needed(module: str, *, extra: str, what: str) -> ModuleType:
    """The optional module; InputError where it is not installed."""
    try:
        return import_module(module)
    except ModuleNotFoundError:
        package = module.split(".", maxsplit=1)[0]
        raise InputError(
            f"{what}: expected the package {package}, which is not installed: run pip install 'unocclude[{extra}]'"
        ) from None
