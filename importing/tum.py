"""TUM RGB-D: `depth.txt` with time stamps and file names, and `groundtruth.txt` with the camera's place."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from importing.calibration import Calibration
from importing.images import files_like, image_list
from importing.pose import placed, still_pose
from importing.source import DepthSource, Wanted
from recording.checks import text_of
from recording.errors import InputError

LIST = "depth.txt"
_SCALE = 1 / 5000
"""Metres of one unit, by the data set's description of its file formats."""


def tum_folder(source: Path, wanted: Wanted) -> DepthSource:
    """The depth images of a sequence with their times; the camera's place where the data set says it.

    A sequence whose camera moves by more than 1 cm or half a degree while it records is refused.
    """
    times, images = _listed(source)
    masks = files_like(source, wanted.masks, "masks") if wanted.masks else []
    found = image_list(images, masks, scale=wanted.known.scale or _SCALE, source=source, times=times)
    return replace(found, kind="TUM RGB-D", calibration=_place(source / "groundtruth.txt", times))


def _listed(source: Path) -> tuple[tuple[float, ...], list[Path]]:
    """The times and the files of `depth.txt`."""
    rows = _rows(source / LIST)
    times, images = [], []
    for number, row in rows:
        try:
            stamp, name = float(row[0]), row[1]
        except (ValueError, IndexError):
            raise InputError(
                f"{source / LIST}: expected a time and a file name, got {' '.join(row)[:60]!r} in line {number}"
            ) from None
        path = source / name
        try:
            inside, there = path.resolve().is_relative_to(source.resolve()), path.is_file()
        except (OSError, RuntimeError, ValueError):  # Too long, links in a circle, or a NUL in it.
            inside = there = False
        if not inside:
            raise InputError(f"{source / LIST}: expected files within the folder, got {name[:60]!r} in line {number}")
        if not there:
            raise InputError(f"{path} is missing: line {number} of {source / LIST} promises it")
        times.append(stamp)
        images.append(path)
    if not images:
        raise InputError(f"{source / LIST}: expected a line with a time and a file name for each image, got none")
    return tuple(times), images


def _place(path: Path, times: tuple[float, ...]) -> Calibration:
    """Where the camera stands, by the data set's own measurement while it records; nothing where there is none."""
    if not path.is_file():
        return Calibration()
    rows = _rows(path)
    try:
        poses = np.array([[float(value) for value in row] for _, row in rows]).reshape(len(rows), -1)
    except ValueError:
        poses = np.empty((0, 0))
    if poses.shape[1:] != (8,):
        raise InputError(f"{path}: expected 'time x y z qx qy qz qw' in every line")
    during = poses[(poses[:, 0] >= min(times)) & (poses[:, 0] <= max(times)), 1:]
    return placed(still_pose(during, source=str(path)), source=str(path)) if len(during) else Calibration()


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """The lines that are no comments, in words, with their numbers."""
    lines = text_of(path, "text file as TUM RGB-D has it").splitlines()
    rows = [(number, line.replace(",", " ").split()) for number, line in enumerate(lines, start=1)]
    return [(number, row) for number, row in rows if row and not row[0].startswith("#")]
