"""Depth images from elsewhere become a recording, or one line that says why not."""

import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recording.errors import InputError
from recording.importing import Calibration, depth_image, import_images, mask_image
from recording.store import load_recording

CALIBRATION = Calibration(fx=300.0, fy=310.0, cx=3.5, cy=2.0, fps=15.0)


def write(path: Path, image: np.ndarray) -> None:
    assert cv2.imwrite(str(path), image)


def millimetres(value: int) -> np.ndarray:
    image = np.full((4, 6), value, np.uint16)
    image[1, 2] = 0
    return image


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """Eleven images whose depth in centimetres is their number, and their masks."""
    folder = tmp_path / "source"
    folder.mkdir()
    for number in range(1, 12):
        write(folder / f"depth_{number}.png", millimetres(10 * number))
        write(folder / f"mask_{number}.png", np.full((4, 6), number, np.uint8))
    return folder


def test_depth_becomes_metres_and_zero_becomes_nothing(source: Path, tmp_path: Path) -> None:
    import_images(source, tmp_path / "rec", calibration=CALIBRATION, pattern="depth_*.png")
    recording = load_recording(tmp_path / "rec")
    depth = recording.frames[0].depth
    assert depth.dtype == np.float32
    assert np.isnan(depth[1, 2])
    assert np.isnan(depth).sum() == 1
    assert depth[0, 0] == pytest.approx(0.01)
    assert recording.metadata.frames == 11
    assert recording.fps == 15.0
    assert recording.frames[0].labels is None
    assert recording.metadata.name == "rec"


def test_frames_follow_the_numbers_in_their_names(source: Path, tmp_path: Path) -> None:
    import_images(source, tmp_path / "rec", calibration=CALIBRATION, pattern="depth_*.png", masks="mask_*.png")
    recording = load_recording(tmp_path / "rec")
    order = [round(100 * float(frame.depth[0, 0])) for frame in recording.frames]
    assert order == list(range(1, 12))  # 2 before 10.
    assert [int(frame.labels.objectid[0, 0]) for frame in recording.frames if frame.labels] == order


def test_time_stamps_as_names_keep_their_order(tmp_path: Path) -> None:
    folder = tmp_path / "tum"
    folder.mkdir()
    for number, name in enumerate(["1305031102.160407", "1305031102.194330", "1305031103.000001"]):
        write(folder / f"{name}.png", millimetres(10 * (number + 1)))
    import_images(folder, tmp_path / "rec", calibration=CALIBRATION)
    assert [round(100 * float(frame.depth[0, 0])) for frame in load_recording(tmp_path / "rec").frames] == [1, 2, 3]


@pytest.mark.parametrize(("pixel_centre", "shift"), [(0.0, 0.5), (0.5, 0.0)])
def test_the_principal_point_moves_into_our_convention(
    source: Path, tmp_path: Path, pixel_centre: float, shift: float
) -> None:
    calibration = Calibration(fx=300.0, fy=310.0, cx=3.5, cy=2.0, fps=15.0, pixel_centre=pixel_centre)
    import_images(source, tmp_path / "rec", calibration=calibration, pattern="depth_*.png")
    camera = load_recording(tmp_path / "rec").camera
    assert (camera.width, camera.height) == (6, 4)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (300.0, 310.0, 3.5 + shift, 2.0 + shift)
    np.testing.assert_array_equal(camera.world_from_camera, np.eye(4))


def test_a_pixel_at_an_integer_principal_point_lies_on_the_axis(source: Path, tmp_path: Path) -> None:
    calibration = Calibration(fx=300.0, fy=300.0, cx=3.0, cy=2.0, fps=15.0)
    import_images(source, tmp_path / "rec", calibration=calibration, pattern="depth_*.png")
    recording = load_recording(tmp_path / "rec")
    np.testing.assert_allclose(recording.camera.world_points(recording.frames[0].depth)[2, 3], [0, 0, 0.01], atol=1e-9)


@given(st.integers(1, 65535), st.sampled_from([0.001, 0.0002, 1 / 5000, 0.01]))
def test_every_number_is_scaled(tmp_path_factory: pytest.TempPathFactory, number: int, scale: float) -> None:
    path = tmp_path_factory.mktemp("image") / "a.png"
    write(path, np.array([[number, 0]], np.uint16))
    depth = depth_image(path, scale=scale)
    assert depth[0, 0] == pytest.approx(number * scale, rel=1e-6)
    assert np.isnan(depth[0, 1])


def test_mask_numbers_stay_whole(tmp_path: Path) -> None:
    write(tmp_path / "mask.png", np.array([[0, 65535, 7]], np.uint16))
    mask = mask_image(tmp_path / "mask.png")
    assert mask.dtype == np.uint32
    np.testing.assert_array_equal(mask, [[0, 65535, 7]])


def refusal(source: Path, target: Path, **options: Any) -> str:
    options = {"calibration": CALIBRATION, "pattern": "depth_*.png"} | options
    with pytest.raises(InputError) as refused:
        import_images(source, target, **options)
    assert not target.exists()
    assert not [path for path in target.parent.iterdir() if path.name.startswith(".")]
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_an_image_of_another_size_is_named(source: Path, tmp_path: Path) -> None:
    write(source / "depth_7.png", np.ones((5, 6), np.uint16))
    assert "depth_7.png: expected 6x4 pixels, as the first image has, got 6x5" in refusal(source, tmp_path / "rec")


def test_a_mask_of_another_size_is_named(source: Path, tmp_path: Path) -> None:
    write(source / "mask_7.png", np.ones((4, 8), np.uint8))
    assert "mask_7.png: expected 6x4 pixels" in refusal(source, tmp_path / "rec", masks="mask_*.png")


def test_a_missing_mask_is_counted(source: Path, tmp_path: Path) -> None:
    (source / "mask_3.png").unlink()
    assert "a mask for each of the 11 depth images, got 10" in refusal(source, tmp_path / "rec", masks="mask_*.png")


def test_no_image_says_which_pattern_found_none(source: Path, tmp_path: Path) -> None:
    message = refusal(source, tmp_path / "rec", pattern="*.tiff")
    assert "expected depth images named like '*.tiff', found none" in message


def test_a_folder_that_is_none_is_named(source: Path, tmp_path: Path) -> None:
    assert "nowhere: expected a folder" in refusal(tmp_path / "nowhere", tmp_path / "rec")
    assert "depth_1.png: expected a folder" in refusal(source / "depth_1.png", tmp_path / "rec")


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89PNG\r\n\x1a\n"])
def test_a_damaged_image_is_named(source: Path, tmp_path: Path, content: bytes) -> None:
    (source / "depth_7.png").write_bytes(content)
    assert "depth_7.png: expected an image, but it cannot be read" in refusal(source, tmp_path / "rec")


def test_a_truncated_image_is_named(source: Path, tmp_path: Path) -> None:
    for number in range(1, 12):
        write(source / f"depth_{number}.png", np.random.default_rng(0).integers(1, 60000, (200, 300), np.uint16))
    content = (source / "depth_7.png").read_bytes()
    (source / "depth_7.png").write_bytes(content[: len(content) // 2])
    assert "depth_7.png: expected an image, but it cannot be read" in refusal(source, tmp_path / "rec")


def test_a_colour_image_is_no_depth(source: Path, tmp_path: Path) -> None:
    write(source / "depth_1.png", np.ones((4, 6, 3), np.uint8))
    assert "expected one channel of whole numbers, got 3 of uint8" in refusal(source, tmp_path / "rec")


@pytest.mark.parametrize("pattern", ["/etc/*", "../*.png", "a/../../*.png", ""])
def test_a_pattern_stays_within_the_folder(source: Path, tmp_path: Path, pattern: str) -> None:
    assert f"pattern {pattern!r}: expected file names within the folder" in refusal(
        source, tmp_path / "rec", pattern=pattern
    )


@pytest.mark.parametrize("name", ["fx", "fy", "fps", "scale"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_calibration_is_positive(name: str, value: float) -> None:
    numbers = {"fx": 1.0, "fy": 1.0, "cx": 1.0, "cy": 1.0, "fps": 1.0} | {name: value}
    with pytest.raises(InputError, match=f"{name}: expected a positive number"):
        Calibration(**numbers)


def test_a_principal_point_is_finite_and_a_pixel_centre_is_one_of_two() -> None:
    with pytest.raises(InputError, match="cx: expected a finite number"):
        Calibration(fx=1.0, fy=1.0, cx=math.nan, cy=1.0, fps=1.0)
    with pytest.raises(InputError, match=r"expected 0 or 0\.5, got 1"):
        Calibration(fx=1.0, fy=1.0, cx=1.0, cy=1.0, fps=1.0, pixel_centre=1.0)


def test_an_existing_recording_is_kept(source: Path, tmp_path: Path) -> None:
    import_images(source, tmp_path / "rec", calibration=CALIBRATION, pattern="depth_*.png")
    before = (tmp_path / "rec" / "recording.json").read_bytes()
    with pytest.raises(InputError, match="exists already"):
        import_images(source, tmp_path / "rec", calibration=CALIBRATION, pattern="depth_1.png")
    assert (tmp_path / "rec" / "recording.json").read_bytes() == before
    import_images(source, tmp_path / "rec", calibration=CALIBRATION, pattern="depth_1.png", overwrite=True)
    assert load_recording(tmp_path / "rec").metadata.frames == 1


def test_eight_bit_pictures_of_depth_are_refused(source: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"mask_1\.png: expected 16-bit depth, got 8-bit"):
        import_images(source, tmp_path / "rec", calibration=CALIBRATION, pattern="mask_*.png")
    assert not (tmp_path / "rec").exists()


def test_a_principal_point_far_outside_the_picture_is_refused(source: Path, tmp_path: Path) -> None:
    wide = Calibration(fx=300.0, fy=310.0, cx=2560.0, cy=2.0, fps=15.0)
    with pytest.raises(InputError, match="cx: expected about 3 for 6 pixels, got 2560"):
        import_images(source, tmp_path / "rec", calibration=wide, pattern="depth_*.png")
