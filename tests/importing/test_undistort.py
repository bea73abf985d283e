"""A distorted picture of a known scene becomes the straight one."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from imports import imported

from importing.calibration import Calibration
from importing.undistort import Undistortion, undistortion
from recording.camera import Camera, pixel_grid
from recording.errors import InputError
from recording.frame import Frame, Labels

WIDTH, HEIGHT = 160, 120
STRAIGHT = Calibration(fx=150.0, fy=140.0, cx=79.0, cy=60.5, fps=10.0)
LENS = STRAIGHT.model_copy(update={"distortion": (-0.3, 0.1, 0.002, -0.003, 0.01)})
FISHEYE = STRAIGHT.model_copy(
    update={"distortion": (0.05, -0.01, 0.003, 0.0), "distortion_model": "equidistant", "fx": 110.0, "fy": 110.0}
)


def floor(rays: np.ndarray) -> np.ndarray:
    """A slanted plane, and before it a post."""
    with np.errstate(divide="ignore"):
        plane = 1 / (0.25 + 0.1 * rays[..., 0] + 0.2 * rays[..., 1])
    return np.where(np.abs(rays[..., 0]) < 0.1, 1.5, plane)


def pictures(calibration: Calibration) -> tuple[np.ndarray, np.ndarray, Camera]:
    """What the lens saw of the floor, what a straight one would have, and the camera."""
    camera = calibration.camera(WIDTH, HEIGHT, source="test")
    matrix = np.array([[camera.fx, 0, camera.cx - 0.5], [0, camera.fy, camera.cy - 0.5], [0, 0, 1]])
    centres = (pixel_grid(HEIGHT, WIDTH) - 0.5).reshape(-1, 1, 2)
    lens = np.array(calibration.distortion)
    undistort = cv2.fisheye.undistortPoints if calibration.distortion_model == "equidistant" else cv2.undistortPoints
    bent = undistort(centres, matrix, lens).reshape(HEIGHT, WIDTH, 2)
    straight = (camera.camera_from_pixel(pixel_grid(HEIGHT, WIDTH), np.ones((HEIGHT, WIDTH))))[..., :2]
    return floor(bent).astype(np.float32), floor(straight).astype(np.float32), camera


def made_straight(calibration: Calibration, camera: Camera) -> Undistortion:
    found = undistortion(calibration, camera)
    assert found is not None
    return found


@pytest.mark.parametrize("calibration", [LENS, FISHEYE])
def test_a_bent_picture_of_a_plane_and_a_post_becomes_straight(calibration: Calibration) -> None:
    seen, expected, camera = pictures(calibration)
    depth = made_straight(calibration, camera).depth(seen)
    inside = np.isfinite(depth)
    assert inside.mean() > 0.9
    error, bent = np.abs(depth - expected)[inside], np.abs(seen - expected)[inside]
    assert np.median(error) < 2e-4  # What curvature of the lens within a pixel leaves.
    assert np.quantile(error, 0.98) < 0.005  # At the edge of the post a pixel is one or the other.
    assert np.quantile(bent, 0.98) > 0.2


def test_depths_of_two_surfaces_are_never_mixed_nor_missing_ones_filled() -> None:
    seen, _, camera = pictures(LENS)
    seen[np.abs(seen - 1.5) > 0.01] = 4.0
    seen[40:50, 30:40] = np.nan
    depth = made_straight(LENS, camera).depth(seen)
    known = depth[np.isfinite(depth)]
    assert np.isin(np.round(known, 4), [1.5, 4.0]).all()
    hole = np.isnan(depth[20:80, 15:60]).sum()
    assert 60 < hole < 160


def test_labels_keep_their_numbers_and_end_at_the_border() -> None:
    _, _, camera = pictures(LENS)
    straight = made_straight(LENS, camera)
    numbers = np.where(np.arange(WIDTH) < 80, 7, 70000)[None].repeat(HEIGHT, 0).astype(np.uint32)
    frame = Frame(depth=np.ones((HEIGHT, WIDTH), np.float32), labels=Labels(objectid=numbers))
    made = straight.frame(frame)
    assert made.labels is not None
    assert set(np.unique(made.labels.objectid)) <= {0, 7, 70000}
    np.testing.assert_array_equal(made.labels.objectid == 0, np.isnan(made.depth))


def test_no_coefficients_or_zeros_are_no_distortion() -> None:
    camera = STRAIGHT.camera(WIDTH, HEIGHT, source="test")
    assert undistortion(STRAIGHT, camera) is None
    assert undistortion(STRAIGHT.model_copy(update={"distortion": (0.0,) * 5}), camera) is None


def test_absurd_coefficients_do_no_harm_and_a_fisheye_has_four(tmp_path: Path) -> None:
    seen, _, camera = pictures(LENS)
    wild = STRAIGHT.model_copy(update={"distortion": (1e30, 0.0, 0.0, 0.0)})
    assert made_straight(wild, camera).depth(seen).shape == (HEIGHT, WIDTH)
    five = FISHEYE.model_copy(update={"distortion": (0.1, 0.0, 0.0, 0.0, 0.0)})
    with pytest.raises(InputError, match="expected 4 coefficients of a fisheye lens, got 5"):
        undistortion(five, camera)


def test_a_folder_is_made_straight_on_import(tmp_path: Path) -> None:
    seen, expected, _ = pictures(LENS)
    (tmp_path / "images").mkdir()
    cv2.imwrite(str(tmp_path / "images" / "0.tiff"), seen)
    recording = imported(tmp_path / "images", tmp_path / "rec", known=LENS)
    assert np.nanmedian(np.abs(recording.frames[0].depth - expected)) < 2e-4
