"""A folder of depth images: 16-bit PNG, TIFF or PGM, or floating-point TIFF or EXR."""

import re
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
from jaxtyping import Float32, UInt32

from importing.png import LARGEST_PIXELS, png_numbers
from importing.source import DepthSource, Wanted
from recording.errors import InputError
from recording.exr import hushed
from recording.frame import FARTHEST_M, NEAREST_M, Frame, Labels

SUFFIXES = (".png", ".tif", ".tiff", ".pgm", ".exr")
MILLIMETRE = 0.001
_EXR_CHANNELS = ("Z", "depth", "Depth", "depth.Z", "Depth.Z", "depth.V", "Depth.V", "Y", "V", "R")
"""Where renderers put depth, the likeliest first."""


def image_folder(source: Path, wanted: Wanted) -> DepthSource:
    """The depth images in a folder, in the order of the numbers in their names."""
    images = series(source, wanted.pattern, SUFFIXES, "depth images")
    labels = files_like(source, wanted.masks, "masks") if wanted.masks else []
    return image_list(images, labels, scale=wanted.known.scale, source=source)


def image_list(
    images: list[Path],
    masks: list[Path],
    *,
    scale: float | None,
    source: Path,
    times: tuple[float, ...] | None = None,
) -> DepthSource:
    """Depth images one by one, and a mask for each if there are any."""
    if masks and len(masks) != len(images):
        raise InputError(f"{source}: expected a mask for each of the {len(images)} depth images, got {len(masks)}")
    height, width = _numbers(images[0]).shape
    return DepthSource(
        kind="depth images",
        height=height,
        width=width,
        count=len(images),
        times=times,
        frames=partial(_frames, images, masks, shape=(height, width), scale=scale),
    )


def depth_image(path: Path, *, scale: float | None = None) -> Float32[np.ndarray, "row column"]:
    """The depth in an image, metres; NaN where it holds 0, or no finite number.

    `scale` is metres of one unit; by default a thousandth for whole numbers, and 1 for others.
    """
    return metres(_numbers(path), scale=scale, source=str(path))


def metres(numbers: np.ndarray, *, scale: float | None, source: str) -> Float32[np.ndarray, "row column"]:
    """Stored numbers as depth in metres; NaN where there is none."""
    if numbers.dtype.kind == "u" and numbers.itemsize < 2:
        raise InputError(
            f"{source}: expected 16-bit depth, got 8-bit numbers: is it a picture of depth, not depth itself?"
        )
    if numbers.dtype.kind not in "uif":
        raise InputError(f"{source}: expected numbers, got {numbers.dtype}")
    if numbers.dtype.kind in "if" and np.any(numbers < 0):
        raise InputError(f"{source}: expected depth before the camera, got {np.nanmin(numbers):g}")
    unit = scale if scale is not None else (1.0 if numbers.dtype.kind == "f" else MILLIMETRE)
    known = np.isfinite(numbers) & (numbers > 0)
    depth = np.where(known, numbers * np.float64(unit), np.nan).astype(np.float32)
    return usual_depth(depth, source=source)


def usual_depth(depth: Float32[np.ndarray, "row column"], *, source: str) -> Float32[np.ndarray, "row column"]:
    """The depth, if a recording may have it; InputError where a wrong unit makes it tiny or huge."""
    nearest, farthest = np.fmin.reduce(depth, axis=None), np.fmax.reduce(depth, axis=None)
    if nearest < NEAREST_M or farthest > FARTHEST_M:
        raise InputError(
            f"{source}: expected depths from {NEAREST_M:g} to {FARTHEST_M:g} m, got {nearest:g} to {farthest:g} m: "
            "pass another --scale"
        )
    return depth


def mask_image(path: Path) -> UInt32[np.ndarray, "row column"]:
    """The object ids in an image of whole numbers."""
    numbers = _numbers(path)
    if numbers.dtype.kind != "u":
        raise InputError(f"{path}: expected whole numbers, the ids of objects, got {numbers.dtype}")
    return numbers.astype(np.uint32)


def files_like(source: Path, pattern: str, what: str) -> list[Path]:
    """The files in a folder, in the order of the numbers in their names."""
    if not source.is_dir():
        raise InputError(f"{source}: expected a folder of {what}, but there is none")
    if not pattern or Path(pattern).is_absolute() or ".." in Path(pattern).parts:
        raise InputError(f"pattern {pattern!r}: expected file names within the folder, such as 'depth_*.png'")
    found = sorted((path for path in source.glob(pattern) if path.is_file()), key=_natural)
    if not found:
        raise InputError(f"{source}: expected {what} named like {pattern!r}, found none: pass another pattern")
    return found


def series(source: Path, pattern: str | None, suffixes: tuple[str, ...], what: str) -> list[Path]:
    """The files that a pattern names, or without one all of them, if their names are alike but for the numbers."""
    if pattern is not None:
        return files_like(source, pattern, what)
    found = files_like(source, f"*{only_suffix(source, suffixes)}", what)
    kinds = Counter(re.sub(r"[0-9]+", "*", path.name) for path in found)
    if len(kinds) > 1 and min(kinds.values()) > 1:  # Where each has a name of its own, these say nothing.
        listed = " and ".join(sorted(kinds))
        raise InputError(
            f"{source}: expected one series of {what}, found {listed}: say which by --pattern '{min(kinds)}'"
        )
    return found


def only_suffix(source: Path, suffixes: tuple[str, ...]) -> str:
    """The one of the suffixes that files in the folder have; InputError where there is none, or several."""
    if not source.is_dir():
        raise InputError(f"{source}: expected a folder of files like *{suffixes[0]}, but there is none")
    names = {path.suffix for path in source.iterdir() if path.is_file() and not path.name.startswith(".")}
    there = sorted(name for name in names if name.lower() in suffixes)
    if not there:
        folders = sorted(path.name for path in source.iterdir() if path.is_dir())
        within = f" but folders: import one of them, such as {source / folders[0]}" if folders else ""
        raise InputError(
            f"{source}: expected files named like {' or '.join(f'*{name}' for name in suffixes)}, found none{within}"
        )
    if len(there) > 1:
        raise InputError(
            f"{source}: expected one kind of file, found {' and '.join(there)}: say which by --pattern '*{there[0]}'"
        )
    return there[0]


def _frames(images: list[Path], masks: list[Path], *, shape: tuple[int, int], scale: float | None) -> Iterator[Frame]:
    for number, path in enumerate(images):
        depth = _of_shape(path, depth_image(path, scale=scale), shape)
        labels = Labels(objectid=_of_shape(masks[number], mask_image(masks[number]), shape)) if masks else None
        yield Frame(depth=depth, labels=labels)


def _natural(path: Path) -> tuple[list[str | int], Path]:
    """A key that sorts by the numbers in a name: `depth_2` comes before `depth_10`."""
    parts = re.split(r"([0-9]+)", str(path))
    return [int(part) if index % 2 else part for index, part in enumerate(parts)], path


def _numbers(path: Path) -> np.ndarray:
    """The numbers in an image of one channel."""
    if path.suffix.lower() == ".exr":
        return _exr_numbers(path)
    image = png_numbers(path, source=str(path)) if path.suffix.lower() == ".png" else _other_numbers(path)
    if image.ndim != 2 or image.dtype.kind not in "uf":
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise InputError(f"{path}: expected one channel of numbers, got {channels} of {image.dtype}")
    return image


def _other_numbers(path: Path) -> np.ndarray:
    """The numbers in a TIFF or PGM."""
    loud = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # More pixels than OpenCV takes.
        image = None
    finally:
        cv2.utils.logging.setLogLevel(loud)
    if image is None:
        raise InputError(f"{path}: expected an image, but it cannot be read: it may be damaged or of another kind")
    return np.asarray(image)


def _exr_numbers(path: Path) -> np.ndarray:
    """The depth channel of an OpenEXR image, as numbers of any kind."""
    try:
        with hushed(), OpenEXR.File(str(path), separate_channels=True, header_only=True) as file:
            first, last = file.header()["dataWindow"]
        if np.prod(np.subtract(last, first, dtype=np.float64) + 1) > LARGEST_PIXELS:
            raise InputError(f"{path}: expected a depth image, got one of more than {LARGEST_PIXELS} pixels")
        with hushed(), OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
    except (RuntimeError, ValueError, MemoryError, TypeError) as error:  # OpenEXR raises what it likes.
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: expected an OpenEXR image, but it cannot be read: {_one_line(error)}") from None
    name = next((name for name in _EXR_CHANNELS if name in channels), None)
    if name is None and len(channels) != 1:
        raise InputError(f"{path}: expected a channel 'Z' or 'depth', or one channel alone, got {sorted(channels)}")
    return channels[name or next(iter(channels))]


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _of_shape(path: Path, image: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    if image.shape != shape:
        expected, came = (f"{size[1]}x{size[0]}" for size in (shape, image.shape))
        raise InputError(f"{path}: expected {expected} pixels, as the first image has, got {came}")
    return image
