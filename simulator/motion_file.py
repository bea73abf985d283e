"""People whose motion was captured: which BVH file, and where on the scene it is performed."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from recording.checks import Frozen, validated
from recording.errors import InputError
from simulator.bvh import Clip, read_bvh
from simulator.trajectory_rows import file_inside


class Motion(Frozen):
    """Which captured motion, and where it begins."""

    file: str
    """Path from the scene's file; it stays in that file's folder or below."""
    position: tuple[float, float] = (0.0, 0.0)
    """Where on the ground the pelvis is in the scene's first frame, metres."""
    heading_deg: float = 0.0
    """Where the pelvis faces in the scene's first frame: 0 along x, 90 along y, degrees."""
    start_s: Annotated[float, Field(ge=0)] = 0.0
    """What of the motion is over in the scene's first frame, seconds."""
    sha256: str = ""
    """Digest of the file's content, filled in when the scene is loaded; one that is given must be the file's."""
    folder: str = Field(default=".", exclude=True)
    """The scene's folder, filled in when the scene is loaded. No part of what a recording keeps: it says nothing
    about the motion."""


def with_motion_files(document: dict[str, Any], *, place: Path) -> dict[str, Any]:
    """The scene's document with the folder and the digest of every motion file; each file is read once to check it.

    `place` is the scene's file. What else may be wrong with the document is left to the schema.
    """
    people = document.get("people")
    if not isinstance(people, list):
        return document
    return document | {"people": [_with_motion(person, place, number) for number, person in enumerate(people)]}


def clip_of(motion: Motion) -> Clip:
    """The motion in the file; an `InputError` where the file is not the one that the scene was loaded with."""
    path = file_inside(Path(motion.folder), motion.file)
    found = _digest(path)
    if motion.sha256 not in ("", found):
        raise InputError(
            f"{path}: expected the file with the SHA-256 {motion.sha256}, got {found}: bring the file back, or "
            "leave 'sha256' out to take this one"
        )
    return _clip(path, found)


def _with_motion(person: Any, place: Path, number: int) -> Any:
    """The person with the motion's file found and read, if the person has one."""
    if not isinstance(person, dict) or "motion" not in person:
        return person
    given = validated(Motion, person["motion"], source=f"{place}: people.{number}.motion")
    found = given.model_copy(update={"folder": str(place.parent)})
    clip_of(found)
    digest = _digest(file_inside(place.parent, given.file))
    return person | {"motion": found.model_copy(update={"sha256": digest})}


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{path}: expected a readable BVH file, got: {error.strerror}") from None


@lru_cache(maxsize=16)
def _clip(path: Path, digest: str) -> Clip:
    """The file's motion, parsed once while its content has the digest."""
    del digest  # Only a part of what the answer is remembered by.
    return read_bvh(path)
