"""Bags of ROS 1 and 2 and of RealSense, written by rosbags itself, give back depth, camera and times."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bag_files import KINDS, NUMBER, TOPIC, images, new_bag
from imports import HEIGHT, KNOWN, TIMES, WIDTH, assert_depths, depth_m, depth_mm, imported, refusal

from importing.calibration import Calibration


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("floating", [False, True])
def test_a_bag_says_all_that_is_needed(tmp_path: Path, kind: str, floating: bool) -> None:
    path = tmp_path / KINDS[kind]
    with new_bag(path, kind) as bag:
        bag.add("/camera/depth/camera_info", [(TIMES[0], bag.camera(TIMES[0]))])
        bag.add(TOPIC, images(bag, floating=floating))
    recording = imported(path, tmp_path / "rec", known=Calibration())
    assert_depths(recording, depth_m(depth_mm()))
    camera = recording.camera
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (300.0, 310.0, 4.0, 2.5)
    assert recording.fps == 10.0
    assert recording.metadata.timestamps == pytest.approx(TIMES)


def test_the_file_in_a_ros_2_folder_stands_for_it(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride", "sqlite3") as bag:
        bag.add(TOPIC, images(bag))
    (file,) = (tmp_path / "ride").glob("*.db3")
    assert_depths(imported(file, tmp_path / "rec", known=KNOWN.model_copy(update={"fps": None})), depth_m(depth_mm()))


def test_a_realsense_bag_says_its_unit(tmp_path: Path) -> None:
    sensor = "/device_0/sensor_0"
    with new_bag(tmp_path / "d435.bag", "ros1") as bag:
        number = bag.store.types[NUMBER]
        bag.add(f"{sensor}/option/Depth_Units/value", [(0.1, number(data=np.float32(0.0001)))])
        bag.add(f"{sensor}/Depth_0/info/camera_info", [(0.1, bag.camera(0.1, model="Brown Conrady"))])
        stamped = [
            (1 + n, bag.image(stamp, each, "mono16"))
            for n, (stamp, each) in enumerate(zip(TIMES, depth_mm(), strict=True))
        ]
        bag.add(f"{sensor}/Depth_0/image/data", stamped)
    recording = imported(tmp_path / "d435.bag", tmp_path / "rec", known=Calibration())
    assert_depths(recording, depth_m(depth_mm()) / 10)
    assert recording.camera.cx == 4.0
    assert recording.metadata.timestamps == pytest.approx(TIMES)  # Of the images, not of their arrival.


def test_a_dropped_message_is_an_empty_frame(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add(TOPIC, [each for number, each in enumerate(images(bag)) if number != 2])
    known = KNOWN.model_copy(update={"fps": 10.0})
    expected = depth_m(depth_mm())
    expected[2] = np.nan
    assert_depths(imported(tmp_path / "ride.bag", tmp_path / "rec", known=known), expected)


def test_messages_without_a_stamp_have_that_of_their_arrival(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add(TOPIC, [(stamp, bag.image(0.0, each, "16UC1")) for stamp, each in zip(TIMES, depth_mm(), strict=True)])
    known = KNOWN.model_copy(update={"fps": None})
    assert imported(tmp_path / "ride.bag", tmp_path / "rec", known=known).fps == 10.0


@pytest.mark.parametrize("options", [{"padding": 6}, {"big": True}])
def test_padded_rows_and_swapped_bytes_are_understood(tmp_path: Path, options: dict[str, Any]) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add(TOPIC, images(bag, **options))
    known = KNOWN.model_copy(update={"fps": None})
    assert_depths(imported(tmp_path / "ride.bag", tmp_path / "rec", known=known), depth_m(depth_mm()))


def test_of_several_topics_one_is_named(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add("/left/image", images(bag))
        bag.add("/right/image", images(bag, floating=True))
        bag.add("/colour/image", [(0.0, bag.image(1.0, np.zeros((HEIGHT, WIDTH), np.uint8), "mono8"))])
    path, known = tmp_path / "ride.bag", KNOWN.model_copy(update={"fps": None})
    assert "got /left/image, /right/image: say which by --key TOPIC" in refusal(path, tmp_path / "rec", known=known)
    assert_depths(imported(path, tmp_path / "one", known=known, key="/right/image"), depth_m(depth_mm()))
    assert "expected images in topic '/up', got /colour/image, /left/image" in refusal(
        path, tmp_path / "rec", key="/up"
    )
    assert "expected an image of 16UC1 or mono16 or 32FC1, got 'mono8'" in refusal(
        path, tmp_path / "rec", key="/colour/image"
    )


def test_a_bag_without_depth_says_what_it_has(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add("/colour", [(0.0, bag.image(1.0, np.zeros((HEIGHT, WIDTH), np.uint8), "mono8"))])
    assert "got images of another kind, in topics /colour" in refusal(tmp_path / "ride.bag", tmp_path / "rec")


def test_an_unknown_lens_and_a_changing_size_are_refused(tmp_path: Path) -> None:
    with new_bag(tmp_path / "a.bag", "ros1") as bag:
        bag.add("/camera/depth/camera_info", [(0.0, bag.camera(1.0, model="Inverse", lens=(0.1, 0.0, 0.0, 0.0, 0.0)))])
        bag.add(TOPIC, images(bag))
    assert "distortion_model: input should be 'plumb_bob'" in refusal(tmp_path / "a.bag", tmp_path / "rec")
    with new_bag(tmp_path / "b.bag", "ros1") as bag:
        small = bag.image(100.4, depth_mm()[0, :3], "16UC1")
        bag.add(TOPIC, [*images(bag), (100.4, small)])
    known = KNOWN.model_copy(update={"fps": None})
    assert f"frame 4: expected {WIDTH}x{HEIGHT} pixels" in refusal(tmp_path / "b.bag", tmp_path / "rec", known=known)


@pytest.mark.parametrize("content", [b"", b"hello", b"#ROSBAG V2.0\n"])
def test_no_bag_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "ride.bag").write_bytes(content)
    assert "expected a bag of ROS 1 or 2, but it cannot be read" in refusal(tmp_path / "ride.bag", tmp_path / "rec")


@pytest.mark.parametrize("kind", KINDS)
def test_a_truncated_bag_is_refused(tmp_path: Path, kind: str) -> None:
    path = tmp_path / KINDS[kind]
    with new_bag(path, kind) as bag:
        bag.add(TOPIC, images(bag))
    file = path if path.is_file() else next(each for each in path.iterdir() if each.suffix in (".db3", ".mcap"))
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    assert "expected" in refusal(path, tmp_path / "rec", known=KNOWN.model_copy(update={"fps": None}))


def test_a_ros_2_folder_without_its_bag_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ride").mkdir()
    (tmp_path / "ride" / "metadata.yaml").write_text("hello: [", encoding="utf-8")
    assert "expected a bag of ROS 1 or 2" in refusal(tmp_path / "ride", tmp_path / "rec")


def test_a_missing_reader_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "ride.bag").write_bytes(b"")
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    message = refusal(tmp_path / "ride.bag", tmp_path / "rec")
    assert "expected the package rosbags, which is not installed: run pip install 'unocclude[bags]'" in message
