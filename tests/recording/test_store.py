"""Recordings on disk: what comes back is what went in, and what is damaged is named."""

import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from jaxtyping import config
from worlds import small_camera

from recording.camera import looking_at
from recording.errors import InputError
from recording.exr import write_channels
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.recording import Recording, XRay, stripped
from recording.store import load_recording, save_recording, write_recording
from recording.truth import MeshSequence

FRAMES, HEIGHT, WIDTH = 3, 4, 5


def full_recording() -> Recording:
    """Random numbers in every place that a recording has."""
    generator = np.random.default_rng(1)
    camera = replace(small_camera(WIDTH, HEIGHT), world_from_camera=looking_at((1.0, 2.0, 3.0), (0.0, 5.0, 1.0)))
    objects = (
        ObjectRecord(id=2, name="walker", kind="person", moving=True),
        ObjectRecord(id=7, name="wall", kind="box", moving=False),
    )
    return Recording(
        metadata=metadata_of(
            camera, frames=FRAMES, fps=12.5, name="full", objects=objects, seed=3, timestamps=(0.0, 0.1, 0.3)
        ),
        frames=tuple(random_frame(generator) for _ in range(FRAMES)),
        truth={2: random_mesh(generator, FRAMES), 7: random_mesh(generator, 1)},
        xray=tuple({2: random_depth(generator)} for _ in range(FRAMES)),
    )


def random_depth(generator: np.random.Generator) -> np.ndarray:
    depth = generator.uniform(0.5, 9.0, (HEIGHT, WIDTH)).astype(np.float32)
    depth[generator.random(depth.shape) < 0.3] = np.nan
    return depth


def random_frame(generator: np.random.Generator) -> Frame:
    labels = Labels(
        objectid=generator.integers(0, 8, (HEIGHT, WIDTH), np.uint32),
        face=generator.integers(0, 2**32 - 1, (HEIGHT, WIDTH), np.uint32),  # More than a float32 could hold.
        u=generator.random((HEIGHT, WIDTH), np.float32),
        v=generator.random((HEIGHT, WIDTH), np.float32),
    )
    reason = generator.integers(0, 4, (HEIGHT, WIDTH), np.uint32)
    return Frame(depth=random_depth(generator), labels=labels, clean_depth=random_depth(generator), reason=reason)


def random_mesh(generator: np.random.Generator, frames: int) -> MeshSequence:
    return MeshSequence(
        faces=generator.integers(0, 6, (4, 3), np.int32),
        vertices=generator.normal(size=(frames, 6, 3)).astype(np.float32),
    )


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


# ---- Bad input: one line that names the file ----


def changed(key: str, value: object) -> Callable[[Path], None]:
    """Set a key of recording.json, or remove it with None."""

    def change(folder: Path) -> None:
        document: dict[str, Any] = json.loads((folder / "recording.json").read_text())
        part = document
        *outer, last = key.split(".")
        for name in outer:
            part = part[name]
        if value is None:
            del part[last]
        else:
            part[last] = value
        (folder / "recording.json").write_text(json.dumps(document))

    return change


def cut(name: str, share: float) -> Callable[[Path], None]:
    def damage(folder: Path) -> None:
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[: int(len(content) * share)])

    return damage


def with_depth(value: float, channel: str = "Z") -> Callable[[Path], None]:
    def damage(folder: Path) -> None:
        depth = np.ones((HEIGHT, WIDTH), np.float32)
        channels = {"Z": depth.copy(), "Z.clean": depth.copy()}
        channels[channel][2, 1] = value
        write_channels(folder / "frames" / "000001.exr", channels, attributes={})

    return damage


def with_channels(**channels: np.ndarray) -> Callable[[Path], None]:
    return lambda folder: write_channels(folder / "frames" / "000001.exr", channels, attributes={})


def pickled_truth(folder: Path) -> None:
    np.savez(folder / "truth.npz", faces_2=np.array([{"evil": 1}], object), vertices_2=np.zeros((1, 3, 3)))


def without_vertices(folder: Path) -> None:
    np.savez(folder / "truth.npz", faces_2=np.zeros((1, 3), np.int32))


def more_frames(folder: Path) -> None:
    changed("timestamps", None)(folder)
    changed("frames", FRAMES + 1)(folder)


def array_truth(folder: Path) -> None:
    with (folder / "truth.npz").open("wb") as file:
        np.save(file, np.ones(3))


ONES = np.ones((HEIGHT, WIDTH), np.float32)
BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing frame": (lambda f: (f / "frames" / "000001.exr").unlink(), r"000001\.exr is missing"),
    "truncated frame": (cut("frames/000001.exr", 0.6), r"000001\.exr: expected an OpenEXR file"),
    "empty frame": (cut("frames/000001.exr", 0.0), r"000001\.exr: expected an OpenEXR file"),
    "text for a frame": (lambda f: (f / "frames" / "000001.exr").write_text("hello"), r"000001\.exr: expected an Open"),
    "NaN on disk": (with_depth(np.nan), r"000001\.exr.*nan in 'Z' at row 2, column 1"),
    "infinite depth": (with_depth(np.inf), r"000001\.exr.*inf in 'Z' at row 2, column 1"),
    "negative depth": (with_depth(-0.5), r"000001\.exr.*-0\.5 in 'Z' at row 2, column 1"),
    "negative clean depth": (with_depth(-0.5, "Z.clean"), r"000001\.exr.*in 'Z\.clean' at row 2, column 1"),
    "wrong size": (with_channels(Z=np.ones((6, 9), np.float32)), r"000001\.exr: expected 5x4 pixels.*got 9x6"),
    "no depth": (with_channels(Y=ONES), r"000001\.exr: expected a channel 'Z', got \['Y'\]"),
    "labels as floats": (with_channels(Z=ONES, objectid=ONES), r"000001\.exr: expected channel 'objectid' as uint32"),
    "reason as floats": (with_channels(Z=ONES, reason=ONES), r"000001\.exr: expected channel 'reason' as uint32"),
    "missing X-ray": (lambda f: (f / "xray" / "000001.exr").unlink(), r"xray/000001\.exr is missing"),
    "no description": (lambda f: (f / "recording.json").unlink(), r"full: .*holds no recording\.json"),
    "no JSON": (lambda f: (f / "recording.json").write_text("{"), r"recording\.json: expected JSON"),
    "NaN in JSON": (changed("fps", float("nan")), r"recording\.json: expected JSON, but NaN"),
    "a list": (lambda f: (f / "recording.json").write_text("[]"), r"recording\.json: "),
    "unknown key": (changed("widht", 3), r"recording\.json: unknown key 'widht', did you mean 'width'\?"),
    "unknown camera key": (changed("camera.fz", 3.0), r"'camera\.fz', did you mean 'f[xy]'\?"),
    "missing key": (changed("fps", None), r"recording\.json: key 'fps' is missing"),
    "missing camera key": (changed("camera.cx", None), r"recording\.json: key 'camera\.cx' is missing"),
    "wrong type": (changed("frames", "many"), r"recording\.json: frames: .*got 'many'"),
    "no frames": (changed("frames", 0), r"recording\.json: frames: .*got 0"),
    "negative rate": (changed("fps", -1.0), r"recording\.json: fps: .*got -1\.0"),
    "another format": (changed("format.name", "mp4"), r"recording\.json: format\.name: .*got 'mp4'"),
    "a later format": (changed("format.version", 2), r"recording\.json: format\.version: .*got 2"),
    "another unit": (changed("depth.unit", "inch"), r"recording\.json: depth\.unit: .*got 'inch'"),
    "another pixel centre": (changed("pixel_centre", 0.0), r"recording\.json: pixel_centre: .*got 0\.0"),
    "more frames promised": (more_frames, r"000003\.exr is missing: recording\.json promises 4 frames"),
    "too few timestamps": (changed("timestamps", [0.0, 1.0]), r"recording\.json: .*3 timestamps.*got 2"),
    "timestamps back": (changed("timestamps", [0.0, 2.0, 1.0]), r"recording\.json: .*timestamps that grow"),
    "mirrored camera": (
        changed("camera.world_from_camera", [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        r"recording\.json: camera\.world_from_camera: expected a rotation",
    ),
    "truncated truth": (cut("truth.npz", 0.5), r"truth\.npz: "),
    "empty truth": (cut("truth.npz", 0.0), r"truth\.npz: "),
    "pickled truth": (pickled_truth, r"truth\.npz: "),
    "half a mesh": (without_vertices, r"truth\.npz: the mesh of object 2 is damaged"),
    "array for the truth": (array_truth, r"truth\.npz: "),
}


def read_all(folder: Path) -> None:
    recording = load_recording(folder)
    list(recording.frames)
    list(recording.xray or ())
    for mesh in (recording.truth or {}).values():
        mesh.vertices_at(0)


@pytest.fixture
def _without_type_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checker looks into sequences at random, hence reads frames before anyone asks for them."""
    monkeypatch.setattr(config, "jaxtyping_disable", True)


@pytest.mark.usefixtures("_without_type_checks")
@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_line_that_names_the_file(stored: Path, kind: str, capfd: pytest.CaptureFixture[str]) -> None:
    damage, message = BAD[kind]
    damage(stored)
    with pytest.raises(InputError, match=message) as refused:
        read_all(stored)
    assert "\n" not in str(refused.value)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("kind", ["no", "file", "empty"])
def test_no_recording_at_all_is_named(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "place"
    if kind == "file":
        place.write_text("hello")
    if kind == "empty":
        place.mkdir()
    with pytest.raises(InputError, match=r"place: expected a recording, but it holds no recording\.json"):
        load_recording(place)


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
    read_all(stored)
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
