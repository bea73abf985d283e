"""Which format a source has: by what it is called and by what lies in it."""

from collections.abc import Callable
from pathlib import Path

from importing import images
from importing.arrays import numpy_file
from importing.bags import bag
from importing.cloud_files import SUFFIXES as CLOUDS
from importing.clouds import cloud_folder
from importing.images import image_folder, only_suffix
from importing.matlab import matlab_file
from importing.source import DepthSource, Wanted
from importing.tum import LIST, tum_folder
from recording.errors import InputError

Opener = Callable[[Path, Wanted], DepthSource]
FILES: dict[str, Opener] = {
    ".npz": numpy_file,
    ".npy": numpy_file,
    ".mat": matlab_file,
    ".bag": bag,
    ".db3": bag,
    ".mcap": bag,
}
"""What a file is by its suffix."""


def opened(source: Path, wanted: Wanted) -> DepthSource:
    """The source, ready to be read; InputError where it has no format that is known."""
    if not source.exists():
        raise InputError(f"{source}: expected a folder or a file to import, but there is none")
    if source.is_dir():
        return _folder(source, wanted)(source, wanted)
    opener = FILES.get(source.suffix.lower())
    if opener is None:
        known = ", ".join(FILES)
        raise InputError(
            f"{source}: expected a folder, or a file that ends in {known}, got {source.suffix or 'none'!r}"
        )
    return opener(source, wanted)


def _folder(source: Path, wanted: Wanted) -> Opener:
    """What a folder is: a pattern says it, else a file that one format alone has, else what kind of file is in it."""
    if (source / "recording.json").is_file():
        raise InputError(f"{source}: expected depth to import, got a recording, which is one already")
    if wanted.pattern is not None:
        return cloud_folder if Path(wanted.pattern).suffix.lower() in CLOUDS else image_folder
    if (source / LIST).is_file():
        return tum_folder
    if (source / "metadata.yaml").is_file():
        return bag
    return cloud_folder if only_suffix(source, (*images.SUFFIXES, *CLOUDS)).lower() in CLOUDS else image_folder
