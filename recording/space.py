"""Room on the disk: what a long run will fill is said before it, and refused where it does not fit."""

import shutil
from pathlib import Path

from rich.filesize import decimal

from recording.cache import GIGABYTE
from recording.errors import InputError
from recording.progress import note


def check_room(expected_bytes: int, folder: Path) -> None:
    """Refuse what the disk of a folder that exists cannot hold; say how large it becomes where that is over 1 GB."""
    free = shutil.disk_usage(folder).free
    if expected_bytes > free:
        raise InputError(
            f"{folder}: expected room for about {decimal(expected_bytes)}, but {decimal(free)} are free: choose "
            "another disk, or take fewer frames"
        )
    if expected_bytes > GIGABYTE:
        note(f"about {decimal(expected_bytes)} will be written to {folder}; {decimal(free)} are free")
