"""`unocclude import` from the outside: options reach the recording, and every refusal is one line."""

import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from bag_files import TOPIC, new_bag
from bag_files import images as bag_images
from imports import FRAMES, TIMES, assert_depths, depth_m, depth_mm

import unocclude
from recording.store import load_recording

FOCAL = ("--fx", 300, "--fy", 310, "--cx", 3.5, "--cy", 2)


def run(*arguments: object) -> int:
    """The exit status of the command line."""
    try:
        unocclude.main([str(argument) for argument in arguments])
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0


@pytest.fixture
def images(tmp_path: Path) -> Path:
    """A folder of 16-bit images."""
    folder = tmp_path / "images"
    folder.mkdir()
    for number, image in enumerate(depth_mm()):
        cv2.imwrite(str(folder / f"{number}.png"), image)
    return folder


def test_options_reach_the_recording(images: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "rec"
    options = ("--fps", 12, "--scale", 0.002, "--pixel-centre", 0.5, "--pose", 1, -2, 3, -0.5, 0.5, -0.5, 0.5)
    assert run("import", images, "-o", place, *FOCAL, *options) == 0
    recording = load_recording(place)
    assert_depths(recording, depth_m(depth_mm()) * 2)
    assert (recording.camera.cx, recording.fps) == (3.5, 12.0)
    np.testing.assert_allclose(recording.camera.position, [1, -2, 3])
    assert f"imported {FRAMES} frames of 8x6" in capsys.readouterr().err


def test_files_are_overridden_by_options(images: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    camera = {"fx": 1, "fy": 310, "cx": 3.5, "cy": 2, "fps": 5, "distortion": [0.1, 0, 0, 0]}
    (tmp_path / "camera.json").write_text(json.dumps(camera), encoding="utf-8")
    np.savetxt(tmp_path / "place.txt", np.diag([-1, -1, 1, 1]))
    files = ("--camera", tmp_path / "camera.json", "--extrinsics", tmp_path / "place.txt")
    place = tmp_path / "rec"
    assert run("import", images, "-o", place, *files, "--fx", 300, "--distortion", -0.01, 0, 0, 0) == 0
    recording = load_recording(place)
    assert (recording.camera.fx, recording.fps) == (300.0, 5.0)
    np.testing.assert_array_equal(recording.camera.world_from_camera, np.diag([-1, -1, 1, 1]))
    assert "distortion is taken out" in capsys.readouterr().err


def test_dropped_frames_and_the_ground_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    depth = np.full((4, 30, 40), 3.0, np.float32)
    depth[:, 10:20, 10:20] = 2.0
    known = {"fx": 40, "fy": 40, "cx": 19.5, "cy": 14.5, "timestamps": [0, 0.1, 0.3, 0.4]}
    np.savez(tmp_path / "depth.npz", depth=depth, **known)
    assert run("import", tmp_path / "depth.npz", "-o", tmp_path / "rec", "--remove-ground") == 0
    said = capsys.readouterr().err
    assert "1 frames were dropped in the source and are empty" in said
    assert "left out a plane 3.00 m away, 92% of the returns" in said
    assert [int(frame.seen.sum()) for frame in load_recording(tmp_path / "rec").frames] == [100, 100, 0, 100, 100]


def test_the_background_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    depth = np.full((12, 30, 40), 3.0, np.float32)
    for number in range(12):
        depth[number, 10:20, 3 * number : 3 * number + 6] = 2.0
    np.savez(tmp_path / "depth.npz", depth=depth, fx=40, fy=40, cx=19.5, cy=14.5, fps=10)
    assert run("import", tmp_path / "depth.npz", "-o", tmp_path / "rec", "--remove-background") == 0
    assert "left out the background, 95% of the returns" in capsys.readouterr().err
    assert [int(frame.seen.sum()) for frame in load_recording(tmp_path / "rec").frames] == [60] * 12


def test_a_disk_that_is_too_small_is_one_line_before_anything_is_made(
    images: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=1000))
    assert run("import", images, "-o", tmp_path / "rec", *FOCAL, "--fps", 5) == 2
    said = capsys.readouterr().err
    assert "but 1.0 kB are free: choose another disk, or take fewer frames" in said
    assert said.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["images"]


def test_a_large_recording_is_announced(
    images: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("recording.space.GIGABYTE", 10)
    assert run("import", images, "-o", tmp_path / "rec", *FOCAL, "--fps", 5) == 0
    assert "will be written to" in capsys.readouterr().err
    assert run("import", images, "-o", tmp_path / "quiet", *FOCAL, "--fps", 5, "--quiet") == 0
    assert capsys.readouterr().err == ""


def test_a_place_that_is_not_taken_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add("/tf_static", [(TIMES[0], bag.transforms(TIMES[0], ("base", "depth", (0.0, 0, 1, 0, 0, 0, 1))))])
        bag.add(TOPIC, bag_images(bag))
    assert run("import", tmp_path / "ride.bag", "-o", tmp_path / "rec", *FOCAL) == 0
    assert "if it does, pass --world-frame base" in capsys.readouterr().err
    assert run("import", tmp_path / "ride.bag", "-o", tmp_path / "rec2", *FOCAL, "--world-frame", "base") == 0
    assert load_recording(tmp_path / "rec2").camera.position[2] == 1.0


WRONG = {
    "nothing there": ("{images}/none", "expected a folder or a file to import, but there is none"),
    "another kind of file": ("{images}/0.png", "expected a folder, or a file that ends in .npz"),
    "no camera": ("{images}", "pass --fx --fy --cx --cy, or a calibration file by --camera"),
    "no rate": ("{images}", *FOCAL, "pass --fps"),
    "no camera file": ("{images}", "--camera", "{images}/none.json", "none.json: expected a file with the camera"),
    "two places": ("{images}", "--extrinsics", "a", "--pose", 0, 0, 0, 0, 0, 0, 1, "expected --extrinsics or --pose"),
    "no rotation": ("{images}", "--pose", 0, 0, 0, 0, 0, 0, 0, "a unit quaternion qx qy qz qw"),
    "no size": ("{images}", "--size", "big", "size: expected WIDTHxHEIGHT in pixels"),
    "negative focal length": ("{images}", "--fx", -3, "fx: input should be greater than 0, got -3"),
    "no lens": ("{images}", *FOCAL, "--fps", 5, "--distortion", 1, "expected 0, 4, 5, 8, 12 or 14 coefficients"),
    "a strange centre": ("{images}", "--pixel-centre", 1, "pixel_centre: expected 0 or 0.5, got 1.0"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_import_is_one_line_and_status_2(
    what: str, images: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    *arguments, expected = (str(part).format(images=images) for part in WRONG[what])
    assert run("import", *arguments, "-o", tmp_path / "rec") == 2
    output = capsys.readouterr()
    assert expected in output.err
    assert output.err.count("\n") == 1
    assert not (tmp_path / "rec").exists()


def test_the_same_source_gives_the_same_bytes(images: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert run("import", images, "-o", tmp_path / name / "rec", *FOCAL, "--fps", 5, "--quiet") == 0
    first, second = (sorted((tmp_path / name / "rec").rglob("*.*")) for name in ("a", "b"))
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
