"""Recordings on disk: what comes back is what went in, and what is damaged is named."""

import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from random_recording import FRAMES, HEIGHT, WIDTH, full_recording
from worlds import small_camera

from recording.errors import InputError
from recording.frame import Frame, Labels
from recording.metadata import metadata_of
from recording.recording import Recording, XRay, stripped
from recording.store import load_recording, save_recording, write_recording


def assert_same_frame(one: Frame, other: Frame) -> None:
    np.testing.assert_array_equal(one.depth, other.depth)
    for name in ("clean_depth", "reason", "labels"):
        assert (getattr(one, name) is None) == (getattr(other, name) is None)
    if one.clean_depth is not None:
        np.testing.assert_array_equal(one.clean_depth, other.clean_depth)
        np.testing.assert_array_equal(one.reason, other.reason)
    if one.labels is not None:
        for name in ("objectid", "face", "u", "v"):
            np.testing.assert_array_equal(getattr(one.labels, name), getattr(other.labels, name))


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    folder = tmp_path / "full"
    save_recording(full_recording(), folder)
    return folder


def test_everything_comes_back_as_it_was(stored: Path) -> None:
    made, loaded = full_recording(), load_recording(stored)
    assert loaded.metadata == made.metadata
    np.testing.assert_array_equal(loaded.camera.world_from_camera, made.camera.world_from_camera)
    assert len(loaded.frames) == FRAMES
    for one, other in zip(made.frames, loaded.frames, strict=True):
        assert_same_frame(one, other)
    assert made.truth is not None
    assert loaded.truth is not None
    assert list(loaded.truth) == [2, 7]
    for objectid, mesh in made.truth.items():
        np.testing.assert_array_equal(loaded.truth[objectid].faces, mesh.faces)
        np.testing.assert_array_equal(loaded.truth[objectid].vertices, mesh.vertices)
    assert made.xray is not None
    assert loaded.xray is not None
    for mine, theirs in zip(made.xray, loaded.xray, strict=True):
        assert list(theirs) == [2]
        np.testing.assert_array_equal(theirs[2], mine[2])


def test_a_missing_return_is_zero_on_disk_and_nan_in_memory(stored: Path) -> None:
    with OpenEXR.File(str(stored / "frames" / "000000.exr"), separate_channels=True) as file:
        pixels = np.array(file.channels()["Z"].pixels)
        attributes = dict(file.header())
    missing = np.isnan(full_recording().frames[0].depth)
    assert missing.any()
    np.testing.assert_array_equal(pixels == 0, missing)
    assert pixels.dtype == np.float32
    assert attributes["unocclude.pixelCentre"] == "0.5"
    assert attributes["unocclude.fps"] == "12.5"
    np.testing.assert_array_equal(np.isnan(load_recording(stored).frames[0].depth), missing)


def test_only_what_is_there_comes_back(tmp_path: Path) -> None:
    bare = stripped(full_recording())
    save_recording(bare, tmp_path / "bare")
    loaded = load_recording(tmp_path / "bare")
    assert loaded.truth is None
    assert loaded.xray is None
    assert loaded.metadata.objects is None
    assert loaded.moving_ids == ()
    for one, other in zip(bare.frames, loaded.frames, strict=True):
        assert_same_frame(one, other)


def test_masks_without_faces_come_back(tmp_path: Path) -> None:
    masks = full_recording().frames[0].labels
    assert masks is not None
    frame = Frame(depth=full_recording().frames[0].depth, labels=Labels(objectid=masks.objectid))
    metadata = metadata_of(small_camera(WIDTH, HEIGHT), frames=1, fps=30.0)
    write_recording(tmp_path / "masks", metadata=metadata, frames=[(frame, None)])
    labels = load_recording(tmp_path / "masks").frames[0].labels
    assert labels is not None
    assert not labels.exact
    np.testing.assert_array_equal(labels.objectid, masks.objectid)


def test_a_folder_with_only_the_required_keys_loads(stored: Path) -> None:
    document = json.loads((stored / "recording.json").read_text())
    required = ("format", "frames", "fps", "width", "height", "camera", "depth")
    (stored / "recording.json").write_text(json.dumps({key: document[key] for key in required}))
    shutil.rmtree(stored / "xray")
    (stored / "truth.npz").unlink()
    assert_same_frame(load_recording(stored).frames[2], full_recording().frames[2])


def test_frames_are_counted_from_the_end_too(stored: Path) -> None:
    frames = load_recording(stored).frames
    assert_same_frame(frames[-1], frames[2])
    assert [np.nansum(frame.depth) for frame in frames[1:]] == [np.nansum(frames[n].depth) for n in (1, 2)]
    for outside in (FRAMES, -FRAMES - 1):
        with pytest.raises(IndexError):
            frames[outside]


def test_an_object_without_a_mesh_is_no_member_of_the_truth(stored: Path) -> None:
    truth = load_recording(stored).truth
    assert truth is not None
    assert truth.get(3) is None
    with pytest.raises(KeyError):
        truth[3]


def test_the_same_recording_gives_the_same_bytes(stored: Path, tmp_path: Path) -> None:
    save_recording(full_recording(), tmp_path / "again")
    files = sorted(path.relative_to(stored) for path in stored.rglob("*") if path.is_file())
    assert len(files) == 2 + 2 * FRAMES
    for name in files:
        assert (stored / name).read_bytes() == (tmp_path / "again" / name).read_bytes(), name


def test_a_loaded_recording_can_replace_itself(stored: Path) -> None:
    save_recording(load_recording(stored), stored, overwrite=True)
    for one, other in zip(full_recording().frames, load_recording(stored).frames, strict=True):
        assert_same_frame(one, other)


def test_xrays_of_a_scene_in_which_nothing_moves_come_back(tmp_path: Path) -> None:
    nothing = Recording(metadata=full_recording().metadata, frames=full_recording().frames, xray=({}, {}, {}))
    save_recording(nothing, tmp_path / "still")
    loaded = load_recording(tmp_path / "still")
    assert loaded.xray is None or [dict(xray) for xray in loaded.xray] == [{}, {}, {}]


# ---- Writing: whole or not at all ----


def failing_frames() -> Iterator[tuple[Frame, XRay | None]]:
    yield full_recording().frames[0], None
    raise ZeroDivisionError


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_an_existing_recording_is_not_overwritten(stored: Path) -> None:
    before = (stored / "recording.json").read_bytes()
    with pytest.raises(InputError, match=r"full exists already.*--overwrite"):
        save_recording(stripped(full_recording()), stored)
    assert (stored / "recording.json").read_bytes() == before
    save_recording(stripped(full_recording()), stored, overwrite=True)
    assert load_recording(stored).truth is None
    assert not (stored / "truth.npz").exists()
    assert names(stored.parent) == ["full"]


def test_a_failure_while_frames_are_made_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        write_recording(tmp_path / "new", metadata=full_recording().metadata, frames=failing_frames())
    assert names(tmp_path) == []


def test_a_failure_while_overwriting_leaves_the_old_one(stored: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        write_recording(stored, metadata=full_recording().metadata, frames=failing_frames(), overwrite=True)
    assert_same_frame(load_recording(stored).frames[2], full_recording().frames[2])
    assert names(stored.parent) == ["full"]


def test_fewer_frames_than_promised_leave_nothing(tmp_path: Path) -> None:
    frames = [(full_recording().frames[0], None)]
    with pytest.raises(InputError, match="expected 3 frames, got 1"):
        write_recording(tmp_path / "new", metadata=full_recording().metadata, frames=frames)
    assert names(tmp_path) == []


def test_overwriting_spares_a_folder_that_is_no_recording(tmp_path: Path) -> None:
    precious = tmp_path / "home"
    precious.mkdir()
    (precious / "thesis.tex").write_text("years of work")
    with pytest.raises(InputError, match=r"home: expected a recording to replace"):
        save_recording(full_recording(), precious, overwrite=True)
    assert (precious / "thesis.tex").read_text() == "years of work"


# ---- The digest ----


def test_a_stripped_copy_has_the_same_digest(stored: Path) -> None:
    recording = full_recording()
    assert stripped(recording).digest() == recording.digest() == load_recording(stored).digest()


def test_one_changed_depth_changes_the_digest() -> None:
    recording = full_recording()
    depth = recording.frames[1].depth.copy()
    row, column = np.argwhere(np.isfinite(depth))[0]
    depth[row, column] = np.nextafter(depth[row, column], np.float32(100))
    frames = (recording.frames[0], replace(recording.frames[1], depth=depth), recording.frames[2])
    assert replace_frames(recording, frames).digest() != recording.digest()
    depth[row, column] = np.nan
    assert replace_frames(recording, frames).digest() != recording.digest()


def test_order_rate_and_camera_change_the_digest() -> None:
    recording = full_recording()
    assert replace_frames(recording, recording.frames[::-1]).digest() != recording.digest()
    faster = Recording(metadata=recording.metadata.model_copy(update={"fps": 13.0}), frames=recording.frames)
    assert faster.digest() != recording.digest()
    camera = recording.metadata.camera.model_copy(update={"cx": 1.0})
    moved = Recording(metadata=recording.metadata.model_copy(update={"camera": camera}), frames=recording.frames)
    assert moved.digest() != recording.digest()


def replace_frames(recording: Recording, frames: tuple[Frame, ...]) -> Recording:
    return Recording(metadata=recording.metadata, frames=frames)
