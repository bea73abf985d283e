"""Files that a scene or a family names: found beside it, and known by their content rather than by their place."""

import hashlib
from pathlib import Path

from recording.errors import InputError


def file_inside(folder: Path, file: str) -> Path:
    """The file's path; refused where it leads out of the folder."""
    try:
        path = (folder / file).resolve()
    except (OSError, RuntimeError, ValueError):  # Links in a circle, or a NUL in the name.
        raise InputError(f"file {file!r}: expected the path of a file from the scene's folder {folder}") from None
    if not path.is_relative_to(folder.resolve()):
        raise InputError(f"file {file!r}: expected one in the scene's folder {folder} or below: copy it there")
    return path


def digest_of_file(path: Path, *, kind: str, wanted: str = "") -> str:
    """SHA-256 of the file's content; refused where another is wanted, or where the file cannot be read.

    `kind` says in the refusal what the file should be.
    """
    try:
        found = hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{path}: expected a readable {kind}, got: {error.strerror}") from None
    if wanted not in ("", found):
        raise InputError(
            f"{path}: expected the file with the SHA-256 {wanted}, got {found}: bring the file back, or "
            "leave 'sha256' out to take this one"
        )
    return found
