"""A data set: a folder of recordings, and `manifest.json`, which lists them."""

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt, model_validator

from recording.atomic import whole_file
from recording.checks import Frozen, json_document, lack_of, validated
from recording.errors import InputError
from recording.metadata import Metadata
from recording.occlusion import Achieved
from recording.progress import tracked
from recording.recording import Recording
from recording.store import load_recording

MANIFEST = "manifest.json"
Split = Literal["development", "reporting", "none"]


class ManifestFormat(Frozen):
    """Which kind of document this is."""

    name: Literal["unocclude-data-set"] = "unocclude-data-set"
    version: Literal[1] = 1


class FamilyRecord(Frozen):
    """The random family that the recordings were drawn from."""

    name: str
    digest: str
    """SHA-256 of `document` as canonical JSON: sorted keys, no spaces."""
    document: dict[str, Any]
    """As its TOML file says it, with all defaults."""


class ObjectCounts(Frozen):
    """How many objects there are."""

    moving: NonNegativeInt
    """People and all else that has an X-ray twin."""
    people: NonNegativeInt
    still: NonNegativeInt
    """Obstacles."""


class Entry(Frozen):
    """One recording of a data set."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]
    """That of its folder."""
    seed: NonNegativeInt
    split: Split
    """What its seed is for."""
    frames: PositiveInt
    fps: PositiveFloat
    width: PositiveInt
    height: PositiveInt
    sensor: str
    """The preset."""
    objects: ObjectCounts
    scene_digest: str
    """As in its `recording.json`."""
    digest: str
    """SHA-256 of what the sensor saw (`Recording.digest`)."""
    achieved: Achieved


class Manifest(Frozen):
    """The content of `manifest.json`."""

    format: ManifestFormat
    family: FamilyRecord
    sensor: str | None = None
    """The preset that was asked for in place of the family's own."""
    size: str | None = None
    """The picture size that was asked for in place of the family's own."""
    made_by: str
    recordings: tuple[Entry, ...]
    """By seed."""

    @model_validator(mode="after")
    def _named_once(self) -> "Manifest":
        (name, times), *_ = Counter(entry.name for entry in self.recordings).most_common(1) or [("", 0)]
        if times > 1:
            raise ValueError(f"expected every recording once, but {name!r} is listed {times} times")
        return self

    @property
    def text(self) -> str:
        """As it stands in the file."""
        return self.model_dump_json(indent=2) + "\n"

    def of_split(self, split: Split) -> tuple[Entry, ...]:
        """The recordings whose seeds are for that."""
        return tuple(entry for entry in self.recordings if entry.split == split)


def entry_of(metadata: Metadata, *, digest: str, split: Split) -> Entry:
    """The entry of a recording that a family was asked for."""
    if metadata.occlusion is None or metadata.scene_digest is None or metadata.objects is None:
        raise InputError(f"{metadata.name}: expected a recording that states its occlusion: make it again")
    objects = metadata.objects
    moving = sum(entry.moving for entry in objects)
    people = sum(entry.kind == "person" for entry in objects)
    return Entry(
        name=str(metadata.name),
        seed=metadata.seed or 0,
        split=split,
        frames=metadata.frames,
        fps=metadata.fps,
        width=metadata.width,
        height=metadata.height,
        sensor=str((metadata.sensor or {}).get("preset")),
        objects=ObjectCounts(moving=moving, people=people, still=len(objects) - moving),
        scene_digest=metadata.scene_digest,
        digest=digest,
        achieved=metadata.occlusion.achieved,
    )


def load_manifest(folder: str | os.PathLike[str]) -> Manifest:
    """The manifest in the folder of a data set."""
    path = Path(folder) / MANIFEST
    if not path.is_file():
        what = lack_of(MANIFEST, path.parent)
        raise InputError(f"{folder}: expected a data set, but {what}: make one by 'unocclude generate'")
    return validated(Manifest, json_document(path), source=str(path))


def save_manifest(manifest: Manifest, folder: Path) -> None:
    """Write the manifest of the data set in the folder, in place of the old one."""
    with whole_file(folder / MANIFEST, overwrite=True) as partial:
        partial.write_text(manifest.model_dump_json(indent=2) + "\n", encoding="utf-8")


def recordings_of(
    folder: str | os.PathLike[str], *, split: Split | None = None, check: bool = False
) -> Iterator[tuple[Entry, Recording]]:
    """Each recording of a data set, or of a split of it, with its entry in the manifest.

    With `check` every frame is read, and a recording whose digest is not that of the manifest is an error; so is one
    of another scene, always.
    """
    manifest = load_manifest(folder)
    entries = manifest.recordings if split is None else manifest.of_split(split)
    for entry in tracked(entries, "recordings", total=len(entries)):
        yield entry, listed_recording(Path(folder), entry, check=check)


def listed_recording(folder: Path, entry: Entry, *, check: bool = True) -> Recording:
    """The recording of the entry, held against it; an InputError where it is another one."""
    recording = load_recording(folder / entry.name)
    if recording.metadata.scene_digest != entry.scene_digest:
        raise InputError(f"{folder / entry.name}: expected the scene that {MANIFEST} lists, got another: make it again")
    if check and recording.digest() != entry.digest:
        raise InputError(
            f"{folder / entry.name}: expected depths with the digest in {MANIFEST}, got others: "
            "the frames were changed; make it again"
        )
    return recording
