"""Real depth recordings: a folder of 16-bit depth images, as TUM RGB-D and many others have it."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float32, UInt32

from recording.camera import PIXEL_CENTRE, Camera
from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.metadata import Metadata, metadata_of
from recording.progress import tracked
from recording.store import write_recording
from recording.version import VERSION
from recording.xray import XRay


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """What a folder of images does not say of its camera."""

    fx: float
    """Focal length along the columns, pixels."""
    fy: float
    """Focal length along the rows, pixels."""
    cx: float
    """Column of the principal point, pixels."""
    cy: float
    """Row of the principal point, pixels."""
    fps: float
    """Frames a second."""
    scale: float = 0.001
    """Metres of one unit of the stored numbers."""
    pixel_centre: float = 0.0
    """Where the calibration has the centre of pixel (0, 0): 0, as most do, or 0.5."""

    def __post_init__(self) -> None:
        for name in ("fx", "fy", "fps", "scale"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise InputError(f"{name}: expected a positive number, got {value:g}")
        for name in ("cx", "cy"):
            if not np.isfinite(getattr(self, name)):
                raise InputError(f"{name}: expected a finite number of pixels, got {getattr(self, name):g}")
        if self.pixel_centre not in (0.0, 0.5):
            raise InputError(f"pixel centre: expected 0 or 0.5, got {self.pixel_centre:g}")

    def camera(self, width: int, height: int) -> Camera:
        """The camera, in the recording's pixel convention; its own axes are the world's."""
        for name, side in (("cx", width), ("cy", height)):
            if not -0.5 * side <= getattr(self, name) <= 1.5 * side:
                raise InputError(f"{name}: expected about {side / 2:g} for {side} pixels, got {getattr(self, name):g}")
        shift = PIXEL_CENTRE - self.pixel_centre
        return Camera(
            width=width,
            height=height,
            fx=self.fx,
            fy=self.fy,
            cx=self.cx + shift,
            cy=self.cy + shift,
            world_from_camera=np.eye(4),
        )


def import_images(
    source: Path,
    folder: Path,
    *,
    calibration: Calibration,
    pattern: str = "*.png",
    masks: str | None = None,
    overwrite: bool = False,
) -> Metadata:
    """Make a recording of the depth images in `source`, in the order of the numbers in their names.

    `masks` is the pattern of images, one for each depth image in the order of their names, whose numbers
    are object ids, 0 for none.
    """
    images = _files(source, pattern, "depth images")
    labels = _files(source, masks, "masks") if masks else []
    if masks and len(labels) != len(images):
        raise InputError(f"{source}: expected a mask for each of the {len(images)} depth images, got {len(labels)}")
    height, width = _numbers(images[0]).shape
    metadata = metadata_of(
        calibration.camera(width, height),
        frames=len(images),
        fps=calibration.fps,
        name=folder.resolve().name,
        made_by=f"unocclude {VERSION}",
    )
    frames = _frames(images, labels, shape=(height, width), scale=calibration.scale)
    write_recording(folder, metadata=metadata, frames=frames, overwrite=overwrite)
    return metadata


def depth_image(path: Path, *, scale: float) -> Float32[np.ndarray, "row column"]:
    """The depth in an image of integers, metres; NaN where it holds 0."""
    numbers = _numbers(path)
    if numbers.itemsize < 2:
        raise InputError(
            f"{path}: expected 16-bit depth, got 8-bit numbers: is it a picture of depth, not depth itself?"
        )
    return np.where(numbers > 0, numbers * np.float32(scale), np.float32(np.nan)).astype(np.float32)


def mask_image(path: Path) -> UInt32[np.ndarray, "row column"]:
    """The object ids in an image of integers."""
    return _numbers(path).astype(np.uint32)


def _frames(
    images: list[Path], masks: list[Path], *, shape: tuple[int, int], scale: float
) -> Iterator[tuple[Frame, XRay | None]]:
    for number, path in enumerate(tracked(images, "importing", total=len(images))):
        depth = _of_shape(path, depth_image(path, scale=scale), shape)
        labels = Labels(objectid=_of_shape(masks[number], mask_image(masks[number]), shape)) if masks else None
        yield Frame(depth=depth, labels=labels), None


def _files(source: Path, pattern: str, what: str) -> list[Path]:
    if not source.is_dir():
        raise InputError(f"{source}: expected a folder of {what}, but there is none")
    if not pattern or Path(pattern).is_absolute() or ".." in Path(pattern).parts:
        raise InputError(f"pattern {pattern!r}: expected file names within the folder, such as 'depth_*.png'")
    found = sorted((path for path in source.glob(pattern) if path.is_file()), key=_natural)
    if not found:
        raise InputError(f"{source}: expected {what} named like {pattern!r}, found none: pass another pattern")
    return found


def _natural(path: Path) -> tuple[list[str | int], Path]:
    """A key that sorts by the numbers in a name: `depth_2` comes before `depth_10`."""
    parts = re.split(r"([0-9]+)", str(path))
    return [int(part) if index % 2 else part for index, part in enumerate(parts)], path


def _numbers(path: Path) -> np.ndarray:
    """The numbers in a single-channel integer image."""
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise InputError(f"{path}: expected an image, but it cannot be read: it may be damaged or of another kind")
    if image.ndim != 2 or image.dtype.kind != "u":
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise InputError(f"{path}: expected one channel of whole numbers, got {channels} of {image.dtype}")
    return np.asarray(image)


def _of_shape(path: Path, image: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    if image.shape != shape:
        expected, came = (f"{size[1]}x{size[0]}" for size in (shape, image.shape))
        raise InputError(f"{path}: expected {expected} pixels, as the first image has, got {came}")
    return image
