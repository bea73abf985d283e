"""Damaged recordings: one line that names the file."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jaxtyping import config
from random_recording import FRAMES, HEIGHT, WIDTH, full_recording

from recording.errors import InputError
from recording.exr import write_channels
from recording.store import load_recording, save_recording


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    folder = tmp_path / "full"
    save_recording(full_recording(), folder)
    return folder


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


@pytest.mark.parametrize(
    ("kind", "what"),
    [("no", "there is no such folder"), ("file", "it is a file"), ("empty", r"it holds no recording\.json")],
)
def test_no_recording_at_all_is_named(tmp_path: Path, kind: str, what: str) -> None:
    place = tmp_path / "place"
    if kind == "file":
        place.write_text("hello")
    if kind == "empty":
        place.mkdir()
    with pytest.raises(InputError, match=f"place: expected a recording, but {what}"):
        load_recording(place)
