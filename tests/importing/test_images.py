"""Depth images from elsewhere become a recording, or one line that says why not."""

import contextlib
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
import pytest
from hypothesis import given
from hypothesis import strategies as st
from imports import KNOWN, assert_depths, depth_m, depth_mm, imported, refusal
from PIL import Image

from importing.calibration import Calibration
from importing.images import depth_image, mask_image
from importing.source import Wanted
from importing.write import import_recording
from recording.checks import validated
from recording.errors import InputError
from recording.store import load_recording


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
    recording = imported(source, tmp_path / "rec", pattern="depth_*.png")
    depth = recording.frames[0].depth
    assert depth.dtype == np.float32
    assert np.isnan(depth[1, 2])
    assert np.isnan(depth).sum() == 1
    assert depth[0, 0] == pytest.approx(0.01)
    assert recording.metadata.frames == 11
    assert recording.fps == 15.0
    assert recording.frames[0].labels is None
    assert recording.metadata.name == "rec"


@pytest.mark.parametrize("suffix", [".png", ".tif", ".pgm", ".exr"])
def test_damage_anywhere_is_one_line_or_harmless(
    suffix: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Readers in C print what they find wrong; nothing of that may reach the terminal."""
    generator = np.random.default_rng(0)
    path = tmp_path / f"a{suffix}"
    numbers = generator.integers(500, 5000, (30, 40), np.uint16)
    if suffix == ".exr":
        OpenEXR.File({}, {"Z": numbers.astype(np.float32)}).write(str(path))
    else:
        write(path, numbers)
    whole = path.read_bytes()
    for _ in range(60):
        content = bytearray(whole[: generator.integers(1, len(whole) + 1)])
        for place in generator.integers(0, min(len(content), 400 if suffix == ".exr" else 60), 2):
            content[place] ^= int(generator.integers(256))
        path.write_bytes(content)
        with contextlib.suppress(InputError):
            depth_image(path)
    assert capfd.readouterr() == ("", "")


def test_a_palette_of_masks_gives_its_places(tmp_path: Path) -> None:
    image = Image.fromarray(np.array([[0, 3], [7, 0]], np.uint8), mode="P")
    image.putpalette(bytes(range(256)) * 3)
    image.save(tmp_path / "mask.png")
    np.testing.assert_array_equal(mask_image(tmp_path / "mask.png"), [[0, 3], [7, 0]])


def test_two_series_in_a_folder_are_a_choice(source: Path, tmp_path: Path) -> None:
    message = refusal(source, tmp_path / "rec")
    assert (
        "one series of depth images, found depth_*.png and mask_*.png: say which by --pattern 'depth_*.png'" in message
    )


def test_names_of_their_own_are_one_series(tmp_path: Path) -> None:
    for name in ("a1", "b7", "c", "d1"):
        write(tmp_path / f"{name}.png", millimetres(300))
    assert imported(tmp_path, tmp_path / "rec").metadata.frames == 4


def test_a_folder_of_folders_names_one(source: Path, tmp_path: Path) -> None:
    assert f"found none but folders: import one of them, such as {source}" in refusal(tmp_path, tmp_path / "rec")


def test_frames_follow_the_numbers_in_their_names(source: Path, tmp_path: Path) -> None:
    recording = imported(source, tmp_path / "rec", pattern="depth_*.png", masks="mask_*.png")
    order = [round(100 * float(frame.depth[0, 0])) for frame in recording.frames]
    assert order == list(range(1, 12))  # 2 before 10.
    assert [int(frame.labels.objectid[0, 0]) for frame in recording.frames if frame.labels] == order


def test_time_stamps_as_names_keep_their_order(tmp_path: Path) -> None:
    folder = tmp_path / "tum"
    folder.mkdir()
    for number, name in enumerate(["1305031102.160407", "1305031102.194330", "1305031103.000001"]):
        write(folder / f"{name}.png", millimetres(10 * (number + 1)))
    frames = imported(folder, tmp_path / "rec").frames
    assert [round(100 * float(frame.depth[0, 0])) for frame in frames] == [1, 2, 3]


@pytest.mark.parametrize(("pixel_centre", "shift"), [(0.0, 0.5), (0.5, 0.0)])
def test_the_principal_point_moves_into_our_convention(
    source: Path, tmp_path: Path, pixel_centre: float, shift: float
) -> None:
    calibration = Calibration(fx=300.0, fy=310.0, cx=3.5, cy=2.0, fps=15.0, pixel_centre=pixel_centre)
    camera = imported(source, tmp_path / "rec", known=calibration, pattern="depth_*.png").camera
    assert (camera.width, camera.height) == (6, 4)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (300.0, 310.0, 3.5 + shift, 2.0 + shift)
    np.testing.assert_array_equal(camera.world_from_camera, np.eye(4))


def test_a_pixel_at_an_integer_principal_point_lies_on_the_axis(source: Path, tmp_path: Path) -> None:
    calibration = Calibration(fx=300.0, fy=300.0, cx=3.0, cy=2.0, fps=15.0)
    recording = imported(source, tmp_path / "rec", known=calibration, pattern="depth_*.png")
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


PATTERN = "depth_*.png"


def test_an_image_of_another_size_is_named(source: Path, tmp_path: Path) -> None:
    write(source / "depth_7.png", np.ones((5, 6), np.uint16))
    assert "depth_7.png: expected 6x4 pixels, as the first image has, got 6x5" in refusal(
        source, tmp_path / "rec", pattern=PATTERN
    )


def test_a_mask_of_another_size_is_named(source: Path, tmp_path: Path) -> None:
    write(source / "mask_7.png", np.ones((4, 8), np.uint8))
    assert "mask_7.png: expected 6x4 pixels" in refusal(source, tmp_path / "rec", pattern=PATTERN, masks="mask_*.png")


def test_a_missing_mask_is_counted(source: Path, tmp_path: Path) -> None:
    (source / "mask_3.png").unlink()
    assert "a mask for each of the 11 depth images, got 10" in refusal(
        source, tmp_path / "rec", pattern=PATTERN, masks="mask_*.png"
    )


def test_no_image_says_which_pattern_found_none(source: Path, tmp_path: Path) -> None:
    message = refusal(source, tmp_path / "rec", pattern="*.tiff")
    assert "expected depth images named like '*.tiff', found none" in message


def test_a_folder_that_is_none_is_named(source: Path, tmp_path: Path) -> None:
    assert "nowhere: expected a folder or a file to import, but there is none" in refusal(
        tmp_path / "nowhere", tmp_path / "rec", pattern=PATTERN
    )
    assert "depth_1.png: expected a folder, or a file that ends in .npz" in refusal(
        source / "depth_1.png", tmp_path / "rec", pattern=PATTERN
    )


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89PNG\r\n\x1a\n"])
def test_a_damaged_image_is_named(source: Path, tmp_path: Path, content: bytes) -> None:
    (source / "depth_7.png").write_bytes(content)
    assert "depth_7.png: expected a PNG, but it cannot be read" in refusal(source, tmp_path / "rec", pattern=PATTERN)


def test_a_truncated_image_is_named(source: Path, tmp_path: Path) -> None:
    for number in range(1, 12):
        write(source / f"depth_{number}.png", np.random.default_rng(0).integers(1, 60000, (200, 300), np.uint16))
    content = (source / "depth_7.png").read_bytes()
    (source / "depth_7.png").write_bytes(content[: len(content) // 2])
    assert "depth_7.png: expected a PNG, but it cannot be read" in refusal(source, tmp_path / "rec", pattern=PATTERN)


def test_a_colour_image_is_no_depth(source: Path, tmp_path: Path) -> None:
    write(source / "depth_1.png", np.ones((4, 6, 3), np.uint8))
    assert "expected one channel of numbers, got 3 of uint8" in refusal(source, tmp_path / "rec", pattern=PATTERN)


@pytest.mark.parametrize("pattern", ["/etc/*", "../*.png", "a/../../*.png", ""])
def test_a_pattern_stays_within_the_folder(source: Path, tmp_path: Path, pattern: str) -> None:
    assert f"pattern {pattern!r}: expected file names within the folder" in refusal(
        source, tmp_path / "rec", pattern=pattern
    )


@pytest.mark.parametrize("name", ["fx", "fy", "fps", "scale"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_a_calibration_is_positive(name: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"test: {name}: input should be"):
        validated(Calibration, {name: value}, source="test")


def test_a_principal_point_is_finite_and_a_pixel_centre_is_one_of_two() -> None:
    with pytest.raises(InputError, match="cx: input should be a finite number"):
        validated(Calibration, {"cx": float("nan")}, source="test")
    with pytest.raises(InputError, match=r"expected 0 or 0\.5, got 1"):
        validated(Calibration, {"pixel_centre": 1.0}, source="test")


def test_an_existing_recording_is_kept(source: Path, tmp_path: Path) -> None:
    imported(source, tmp_path / "rec", pattern=PATTERN)
    before = (tmp_path / "rec" / "recording.json").read_bytes()
    with pytest.raises(InputError, match="exists already"):
        imported(source, tmp_path / "rec", pattern="depth_1.png")
    assert (tmp_path / "rec" / "recording.json").read_bytes() == before
    import_recording(source, tmp_path / "rec", wanted=Wanted(known=KNOWN, pattern="depth_1.png"), overwrite=True)
    assert load_recording(tmp_path / "rec").metadata.frames == 1


def test_eight_bit_pictures_of_depth_are_refused(source: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"mask_1\.png: expected 16-bit depth, got 8-bit"):
        imported(source, tmp_path / "rec", pattern="mask_*.png")
    assert not (tmp_path / "rec").exists()


def test_a_principal_point_far_outside_the_picture_is_refused(source: Path, tmp_path: Path) -> None:
    wide = Calibration(fx=300.0, fy=310.0, cx=2560.0, cy=2.0, fps=15.0)
    with pytest.raises(InputError, match="cx: expected about 3 for 6 pixels, got 2560"):
        imported(source, tmp_path / "rec", known=wide, pattern=PATTERN)


@pytest.mark.parametrize("suffix", [".png", ".tif", ".tiff", ".pgm", ".PNG"])
def test_sixteen_bits_come_back_from_every_kind_of_image(tmp_path: Path, suffix: str) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    for number, image in enumerate(depth_mm()):
        write(folder / f"{number}{suffix}", image)
    assert_depths(imported(folder, tmp_path / "rec"), depth_m(depth_mm()))


@pytest.mark.parametrize("nothing", [0.0, np.nan, np.inf])
def test_floating_point_tiff_is_metres(tmp_path: Path, nothing: float) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    for number, image in enumerate(depth_m(depth_mm())):
        write(folder / f"{number}.tiff", np.where(np.isnan(image), np.float32(nothing), image))
    assert_depths(imported(folder, tmp_path / "rec"), depth_m(depth_mm()))


@pytest.mark.parametrize("channel", ["Z", "depth", "Y"])
def test_exr_is_metres_whatever_the_channel_is_called(tmp_path: Path, channel: str) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    for number, image in enumerate(np.nan_to_num(depth_m(depth_mm()))):
        channels = {channel: image} if channel == "Y" else {channel: image, "other": image + 1}
        OpenEXR.File({"type": OpenEXR.scanlineimage}, channels).write(str(folder / f"{number}.exr"))
    assert_depths(imported(folder, tmp_path / "rec"), depth_m(depth_mm()))


def test_an_exr_without_depth_lists_what_it_has(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    colour = {"a": np.ones((4, 6), np.float32), "b": np.ones((4, 6), np.float32)}
    OpenEXR.File({"type": OpenEXR.scanlineimage}, colour).write(str(tmp_path / "images" / "0.exr"))
    message = refusal(tmp_path / "images", tmp_path / "rec")
    assert "0.exr: expected a channel 'Z' or 'depth', or one channel alone, got ['a', 'b']" in message


def test_a_damaged_exr_is_named(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "0.exr").write_bytes(b"hello")
    assert "0.exr: expected an OpenEXR image" in refusal(tmp_path / "images", tmp_path / "rec")


def test_two_kinds_of_file_ask_for_a_pattern(source: Path, tmp_path: Path) -> None:
    write(source / "depth_1.tiff", millimetres(10))
    assert "found .png and .tiff: say which by --pattern '*.png'" in refusal(source, tmp_path / "rec")


def test_an_empty_folder_says_what_could_be_in_it(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    message = refusal(tmp_path / "empty", tmp_path / "rec")
    assert "expected files named like *.png or *.tif" in message
    assert message.endswith("found none")


@pytest.mark.parametrize("missing", ["fx", "fy", "cx", "cy"])
def test_a_camera_that_is_not_known_is_asked_for(source: Path, tmp_path: Path, missing: str) -> None:
    known = KNOWN.model_copy(update={missing: None})
    message = refusal(source, tmp_path / "rec", known=known, pattern=PATTERN)
    assert f"but {missing} came from nowhere: pass --{missing}, or a calibration file by --camera" in message


def test_a_rate_that_is_not_known_is_asked_for(source: Path, tmp_path: Path) -> None:
    known = KNOWN.model_copy(update={"fps": None})
    assert "pass --fps" in refusal(source, tmp_path / "rec", known=known, pattern=PATTERN)


def test_the_calibration_of_other_images_is_refused(source: Path, tmp_path: Path) -> None:
    known = KNOWN.model_copy(update={"width": 640})
    message = refusal(source, tmp_path / "rec", known=known, pattern=PATTERN)
    assert "expected images 640 pixels in width, as the calibration says, got 6" in message


def test_a_unit_that_makes_depths_absurd_is_refused(source: Path, tmp_path: Path) -> None:
    known = KNOWN.model_copy(update={"scale": 1e6})
    assert "pass another --scale" in refusal(source, tmp_path / "rec", known=known, pattern=PATTERN)


def test_negative_depth_is_refused(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    write(tmp_path / "images" / "0.tiff", np.full((4, 6), -1, np.float32))
    assert "expected depth before the camera, got -1" in refusal(tmp_path / "images", tmp_path / "rec")


def test_frames_without_a_return_stay_empty(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    for number in range(2):
        write(tmp_path / "images" / f"{number}.png", np.zeros((4, 6), np.uint16))
    assert not any(frame.seen.any() for frame in imported(tmp_path / "images", tmp_path / "rec").frames)
