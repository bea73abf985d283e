"""Manifests: what is written is read back, and what is wrong with one is a line."""

import json
from pathlib import Path
from typing import Any

import pytest
from known import crossing

from recording.errors import InputError
from recording.manifest import (
    Entry,
    FamilyRecord,
    Manifest,
    ManifestFormat,
    entry_of,
    load_manifest,
    recordings_of,
    save_manifest,
)
from recording.occlusion import Achieved, Holes, Nearness, Occlusion
from recording.recording import Recording
from recording.store import save_recording

ACHIEVED = Achieved(
    object_frames=72, hidden_object_frames=0, hole_frames=Holes(count=0, lengths=()), clearance_m=Nearness()
)


def drawn(seed: int) -> Recording:
    """A recording as a family's is described."""
    plain = crossing()
    known = {
        "name": f"squares-{seed:06d}",
        "seed": seed,
        "scene_digest": f"scene {seed}",
        "sensor": {"preset": "ideal"},
        "occlusion": Occlusion(achieved=ACHIEVED),
    }
    metadata = plain.metadata.model_copy(update=known)
    return Recording(metadata=metadata, frames=plain.frames, truth=plain.truth, xray=plain.xray)


@pytest.fixture
def data_set(tmp_path: Path) -> Path:
    recordings = [drawn(seed) for seed in (2, 1000)]
    entries: list[Entry] = []
    for recording, split in zip(recordings, ("development", "reporting"), strict=True):
        save_recording(recording, tmp_path / str(recording.metadata.name))
        entries.append(entry_of(recording.metadata, digest=recording.digest(), split=split))
    family = FamilyRecord(name="squares", digest="0", document={"name": "squares"})
    manifest = Manifest(format=ManifestFormat(), family=family, made_by="a test", recordings=tuple(entries))
    save_manifest(manifest, tmp_path)
    assert load_manifest(tmp_path) == manifest
    return tmp_path


def changed(folder: Path, change: dict[str, Any]) -> None:
    """Change keys of the manifest's first recording."""
    path = folder / "manifest.json"
    document = json.loads(path.read_text(encoding="utf-8"))
    document["recordings"][0] |= change
    path.write_text(json.dumps(document), encoding="utf-8")


def test_recordings_come_with_their_entries_one_split_or_all(data_set: Path) -> None:
    assert [entry.seed for entry, _ in recordings_of(data_set, check=True)] == [2, 1000]
    ((entry, recording),) = recordings_of(data_set, split="reporting")
    assert entry.objects.model_dump() == {"moving": 2, "people": 0, "still": 2}
    assert recording.metadata.occlusion == Occlusion(achieved=entry.achieved)
    assert list(recordings_of(data_set, split="none")) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"splitt": "none"}, "unknown key 'recordings.0.splitt', did you mean 'split'"),
        ({"seed": -1}, "recordings.0.seed: .*greater than or equal to 0"),
        ({"name": "../elsewhere"}, "recordings.0.name: .*match pattern"),
        ({"name": "squares-001000"}, "expected every recording once, but 'squares-001000' is listed 2 times"),
        ({"name": "squares-000003"}, "squares-000003: expected a recording"),
        ({"scene_digest": "scene 3"}, "squares-000002: expected the scene that manifest.json lists, got another"),
        ({"digest": "0"}, "squares-000002: expected depths with the digest in manifest.json, got others"),
    ],
)
def test_a_manifest_that_is_wrong_is_one_line(data_set: Path, change: dict[str, Any], message: str) -> None:
    changed(data_set, change)
    with pytest.raises(InputError, match=message) as refused:
        list(recordings_of(data_set, check=True))
    assert "\n" not in str(refused.value)


def test_digests_are_compared_only_on_demand(data_set: Path) -> None:
    changed(data_set, {"digest": "0"})
    assert len(list(recordings_of(data_set))) == 2


def test_a_folder_without_a_manifest_is_no_data_set(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected a data set, but it holds no manifest\.json"):
        load_manifest(tmp_path)


def test_a_recording_that_states_no_occlusion_cannot_be_listed() -> None:
    with pytest.raises(InputError, match="expected a recording that states its occlusion"):
        entry_of(crossing().metadata, digest="0", split="none")
