"""People whose motion was captured: which BVH file, and where on the scene it is performed."""

from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from recording.checks import Frozen, validated
from simulator.bvh import Clip, read_bvh
from simulator.source_file import digest_of_file, file_inside

_KIND = "BVH file"


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
    return _clip(path, digest_of_file(path, kind=_KIND, wanted=motion.sha256))


def _with_motion(person: Any, place: Path, number: int) -> Any:
    """The person with the motion's file found and read, if the person has one."""
    if not isinstance(person, dict) or "motion" not in person:
        return person
    given = validated(Motion, person["motion"], source=f"{place}: people.{number}.motion")
    found = given.model_copy(update={"folder": str(place.parent)})
    clip_of(found)
    digest = digest_of_file(file_inside(place.parent, given.file), kind=_KIND)
    return person | {"motion": found.model_copy(update={"sha256": digest})}


@lru_cache(maxsize=16)
def _clip(path: Path, digest: str) -> Clip:
    """The file's motion, parsed once while its content has the digest."""
    del digest  # Only a part of what the answer is remembered by.
    return read_bvh(path)
