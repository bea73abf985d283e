"""Depth that ROS packed into PNG gives back what was put in, inverse depths as exactly as they were written."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from bag_files import IMAGE, KINDS, Bag, images, new_bag
from imports import FRAMES, KNOWN, TIMES, assert_depths, depth_m, depth_mm, imported, refusal

from importing.calibration import Calibration

TOPIC = "/camera/depth/image_rect_raw/compressedDepth"
UNTIMED = KNOWN.model_copy(update={"fps": None})
A, B = np.float32(100 * 101), np.float32(1 - 100 * 101 / 70)
"""As the publisher takes them by default, for a quantisation of 100, with depths up to 70 m."""


def png(numbers: np.ndarray) -> bytes:
    return cv2.imencode(".png", numbers)[1].tobytes()


def whole_numbers(depth: np.ndarray) -> bytes:
    """Of 16UC1; the publisher leaves its two numbers as they are in memory."""
    return struct.pack("<iff", 0, 0.0, 0.0) + png(depth)


def inverse_depths(depth: np.ndarray) -> bytes:
    """Of 32FC1, as `compressed_depth_image_transport` makes them."""
    with np.errstate(divide="ignore"):
        inverse = np.where(np.isfinite(depth), A / depth + B, 0)
    return struct.pack("<iff", 0, A, B) + png(inverse.astype(np.uint16))


def huge(width: int, height: int) -> bytes:
    """The head of a PNG, as right as it can be."""
    head = b"IHDR" + struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + head + struct.pack(">I", zlib.crc32(head)) + bytes(40)


def packed(bag: Bag, format_: str, contents: list[bytes]) -> list[tuple[float, object]]:
    return [(time, bag.compressed(time, format_, data)) for time, data in zip(TIMES, contents, strict=True)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("format_", ["16UC1; compressedDepth png", "16UC1; compressedDepth"])
def test_whole_numbers_come_back(tmp_path: Path, kind: str, format_: str) -> None:
    path = tmp_path / KINDS[kind]
    with new_bag(path, kind) as bag:
        bag.add("/camera/depth/camera_info", [(TIMES[0], bag.camera(TIMES[0]))])
        bag.add("/camera/color/compressed", [(TIMES[0], bag.compressed(TIMES[0], "rgb8; jpeg compressed bgr8", b""))])
        bag.add(TOPIC, packed(bag, format_, [whole_numbers(depth) for depth in depth_mm()]))
    recording = imported(path, tmp_path / "rec", known=Calibration())
    assert_depths(recording, depth_m(depth_mm()))
    assert (recording.camera.fx, recording.fps) == (300.0, 10.0)


@pytest.mark.parametrize("kind", KINDS)
def test_inverse_depths_come_back_within_their_step(tmp_path: Path, kind: str) -> None:
    path, depth = tmp_path / KINDS[kind], depth_m(depth_mm())
    with new_bag(path, kind) as bag:
        bag.add(TOPIC, packed(bag, "32FC1; compressedDepth png", [inverse_depths(each) for each in depth]))
    for frame, expected in zip(imported(path, tmp_path / "rec", known=UNTIMED).frames, depth, strict=True):
        np.testing.assert_array_equal(frame.seen, np.isfinite(expected))
        step = expected**2 / A  # How far apart depths of neighbouring whole numbers are.
        assert np.nanmax((frame.depth - expected) / step) < 1 + 1e-2 + np.nanmax(expected) / A * 2
        assert np.nanmin((frame.depth - expected) / step) > -0.01  # Rounded down, hence never nearer.


def test_raw_images_beside_packed_ones_are_a_choice(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add(TOPIC.removesuffix("/compressedDepth"), images(bag))
        bag.add(TOPIC, packed(bag, "16UC1; compressedDepth png", [whole_numbers(depth) for depth in depth_mm()]))
    assert "say which by --key TOPIC" in refusal(tmp_path / "ride.bag", tmp_path / "rec", known=UNTIMED)
    recording = imported(tmp_path / "ride.bag", tmp_path / "rec", known=UNTIMED, key=TOPIC)
    assert recording.metadata.frames == FRAMES


WRONG = {
    "run lengths": ("16UC1; compressedDepth rvl", b"\0" * 40, "expected '16UC1; compressedDepth png' or '32FC1"),
    "colour": ("rgb8; compressedDepth png", whole_numbers(depth_mm()[0]), "expected depth of 16UC1 or 32FC1"),
    "no image": ("16UC1; compressedDepth png", b"hello", "frame 0, after 12 bytes: expected a PNG"),
    "half a head": ("32FC1; compressedDepth png", b"\0" * 12, "frame 0, after 12 bytes: expected a PNG"),
    "eight bits": (
        "16UC1; compressedDepth png",
        b"\0" * 12 + png(np.ones((6, 8), np.uint8)),
        "a PNG of 16 bits and one channel, got uint8",
    ),
    "too large": (
        "16UC1; compressedDepth png",
        b"\0" * 12 + huge(60000, 60000),
        "expected a",
    ),
    "a head that is none": (
        "32FC1; compressedDepth png",
        struct.pack("<iff", 0, 1.0, 1e6) + png(np.ones((6, 8), np.uint16)),
        "expected depth before the camera",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_packed_otherwise_is_refused(tmp_path: Path, what: str) -> None:
    format_, content, expected = WRONG[what]
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add(TOPIC, packed(bag, format_, [content] * FRAMES))
    assert expected in refusal(tmp_path / "ride.bag", tmp_path / "rec", known=UNTIMED)


def test_other_compressed_images_are_no_depth(tmp_path: Path) -> None:
    with new_bag(tmp_path / "ride.bag", "ros1") as bag:
        bag.add("/color/compressed", packed(bag, "rgb8; jpeg compressed bgr8", [b"jpeg"] * FRAMES))
    message = refusal(tmp_path / "ride.bag", tmp_path / "rec", known=UNTIMED)
    assert "expected a topic with images of 16UC1 or mono16 or 32FC1 or compressedDepth" in message
    assert "expected '16UC1; compressedDepth png'" in refusal(
        tmp_path / "ride.bag", tmp_path / "rec", known=UNTIMED, key="/color/compressed"
    )
    assert IMAGE not in message
