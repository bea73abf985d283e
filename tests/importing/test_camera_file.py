"""A calibration is read from whatever people write it in."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from importing.calibration import Calibration
from importing.camera_file import calibration_file
from importing.pose import extrinsics_file, placed, pose_matrix, still_pose
from recording.errors import InputError

MATRIX = np.array([[365.5, 0, 256.25], [0, 366.5, 212.75], [0, 0, 1]])
LENS = (-0.28, 0.07, 0.001, -1e-05, 0.0)
EXPECTED = Calibration(fx=365.5, fy=366.5, cx=256.25, cy=212.75, width=512, height=424)
BENT = EXPECTED.model_copy(update={"distortion": LENS})
ROS_YAML = """
image_width: 512
image_height: 424
camera_name: kinect
camera_matrix: {rows: 3, cols: 3, data: [365.5, 0, 256.25, 0, 366.5, 212.75, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.28, 0.07, 0.001, -1e-05, 0.0]}
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
"""


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_our_own_keys_in_three_languages(tmp_path: Path) -> None:
    keys = {"fx": 365.5, "fy": 366.5, "cx": 256.25, "cy": 212.75, "width": 512, "height": 424, "distortion": LENS}
    toml = "\n".join(f"{key} = {list(value) if isinstance(value, tuple) else value}" for key, value in keys.items())
    assert calibration_file(written(tmp_path / "a.json", json.dumps(keys))) == BENT
    assert calibration_file(written(tmp_path / "a.toml", toml)) == BENT
    assert calibration_file(written(tmp_path / "a.yaml", json.dumps(keys).replace("-1e-05", "-1.0e-05"))) == BENT


def test_ros_camera_info_as_yaml(tmp_path: Path) -> None:
    expected = BENT.model_copy(update={"distortion_model": "plumb_bob"})
    assert calibration_file(written(tmp_path / "camera_info.yaml", ROS_YAML)) == expected


@pytest.mark.parametrize(("d", "k"), [("D", "K"), ("d", "k")])
def test_a_printed_camera_info_message(tmp_path: Path, d: str, k: str) -> None:
    message = {"width": 512, "height": 424, "distortion_model": "", d: [], k: MATRIX.ravel().tolist(), "binning_x": 0}
    known = calibration_file(written(tmp_path / "a.yaml", json.dumps(message)))
    assert known.under(Calibration(distortion=None)) == EXPECTED.model_copy(update={"distortion": ()})


@pytest.mark.parametrize("suffix", ["yml", "yaml", "xml", "json"])
def test_opencv_file_storage(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"camera.{suffix}"
    storage = cv2.FileStorage(str(path), cv2.FileStorage_WRITE)
    storage.write("image_width", 512)
    storage.write("image_height", 424)
    storage.write("camera_matrix", MATRIX)
    storage.write("distortion_coefficients", np.array([LENS]).T)
    storage.write("calibration_time", "yesterday")
    storage.release()
    assert calibration_file(path) == BENT


def test_open3d_intrinsics_are_column_by_column(tmp_path: Path) -> None:
    document = {"width": 512, "height": 424, "intrinsic_matrix": MATRIX.T.ravel().tolist()}
    assert calibration_file(written(tmp_path / "a.json", json.dumps(document))) == EXPECTED


def test_what_overrides_what() -> None:
    both = EXPECTED.under(Calibration(fx=1.0, scale=0.5))
    assert (both.fx, both.fy, both.scale) == (1.0, 366.5, 0.5)


WRONG: dict[str, tuple[str, str, str]] = {
    "an unknown key": ("a.json", '{"fx": 1, "focal": 2}', "unknown key 'focal'"),
    "a misspelt key": ("a.toml", "pixel_center = 0.5", "did you mean 'pixel_centre'?"),
    "a negative focal length": ("a.json", '{"fx": -1}', "fx: input should be greater than 0, got -1"),
    "no JSON": ("a.json", "{", "expected JSON"),
    "no YAML": ("a.yaml", "a: [", "expected YAML"),
    "a YAML object": ("a.yaml", "!!python/object:os.system {}", "expected YAML"),
    "no keys": ("a.yaml", "- 1", "expected keys such as 'fx'"),
    "no FileStorage": ("a.yml", "%YAML:1.0\n---\na: [", "expected YAML"),
    "no XML": ("a.xml", "<opencv_storage><K>", "expected OpenCV's FileStorage"),
    "another suffix": ("a.doc", "", "expected a camera as .json, .toml, .yaml, .yml or .xml, got .doc"),
    "a short matrix": ("a.json", '{"K": [1, 2]}', "expected a 3x3 camera matrix, got 2 numbers"),
    "a matrix of words": ("a.json", '{"K": ["a"]}', "expected numbers, got"),
    "a camera that is not calibrated": ("a.json", '{"K": [0,0,0,0,0,0,0,0,0]}', "expected a calibrated camera"),
    "another lens": ("a.json", '{"K": [1,0,1,0,1,1,0,0,1], "D": [1,0,0,0], "distortion_model": "x"}', "got 'x'"),
    "too few coefficients": ("a.json", '{"distortion": [1, 2]}', "expected 0, 4, 5, 8, 12 or 14 coefficients"),
    "a mirrored place": (
        "a.json",
        '{"world_from_camera": [[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}',
        "expected a rotation and a translation",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_camera_file_is_one_line(tmp_path: Path, what: str) -> None:
    name, text, expected = WRONG[what]
    with pytest.raises(InputError) as refused:
        calibration_file(written(tmp_path / name, text))
    assert name in str(refused.value)
    assert expected in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_camera_file_that_is_missing_or_huge_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.json: expected a file with the camera, but there is none"):
        calibration_file(tmp_path / "a.json")
    with pytest.raises(InputError, match="expected a camera in some kilobytes, got 2 MB"):
        calibration_file(written(tmp_path / "b.json", " " * 2_000_000))


TURNED = np.array([[0.0, 0, 1, 1], [-1, 0, 0, 2], [0, -1, 0, 3], [0, 0, 0, 1]])


def place_in(path: Path) -> np.ndarray:
    return np.array(extrinsics_file(path).world_from_camera)


def test_extrinsics_from_numbers_and_from_named_ones(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "a.txt", TURNED)
    np.savetxt(tmp_path / "a.csv", TURNED, delimiter=",")
    np.save(tmp_path / "a.npy", TURNED)
    written(tmp_path / "a.json", json.dumps({"world_from_camera": TURNED.tolist()}))
    written(tmp_path / "a.yaml", json.dumps({"camera_from_world": np.linalg.inv(TURNED).tolist()}))
    for name in ("a.txt", "a.csv", "a.npy", "a.json", "a.yaml"):
        np.testing.assert_allclose(place_in(tmp_path / name), TURNED, atol=1e-12)


def test_a_rounded_rotation_is_taken_as_the_nearest_one(tmp_path: Path) -> None:
    half = 0.7071
    np.savetxt(tmp_path / "a.txt", [[half, -half, 0, 1], [half, half, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    rotation = place_in(tmp_path / "a.txt")[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(rotation[0, 0], np.sqrt(0.5), atol=1e-12)


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.txt", "1 2\n3 4\n", "expected 4 rows of 4 numbers, got shape (2, 2)"),
        ("a.txt", "hello", "expected 4 rows of 4 numbers"),
        ("a.npy", "hello", "expected 4 rows of 4 numbers"),
        ("a.json", '{"pose": 1}', "expected one key, 'world_from_camera' or 'camera_from_world', got ['pose']"),
        ("a.json", '{"world_from_camera": [1, 2]}', "as 4 rows of 4 numbers"),
    ],
)
def test_wrong_extrinsics_are_one_line(tmp_path: Path, name: str, content: str, expected: str) -> None:
    with pytest.raises(InputError) as refused:
        extrinsics_file(written(tmp_path / name, content))
    assert expected in str(refused.value)


def test_a_pose_is_a_place_and_a_unit_quaternion() -> None:
    matrix = pose_matrix((1.0, 2.0, 3.0, -0.5, 0.5, -0.5, 0.5), source="--pose")
    np.testing.assert_allclose(matrix, TURNED, atol=1e-12)  # ROS's axes of a camera: forward is x.
    with pytest.raises(InputError, match="expected x y z and a unit quaternion qx qy qz qw, got one of length 0"):
        pose_matrix((1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0), source="--pose")


def poses(count: int, **moves: Any) -> np.ndarray:
    still = np.tile([1.0, 2, 3, -0.5, 0.5, -0.5, 0.5], (count, 1))
    still[:, 0] += moves.get("metres", 0) * np.linspace(-1, 1, count)
    still[::2, 3:] *= -1  # The same rotation.
    return still


def test_a_camera_that_trembles_stands_still() -> None:
    np.testing.assert_allclose(still_pose(poses(5, metres=0.005), source="test"), TURNED, atol=1e-9)


def test_a_camera_that_moves_or_turns_is_refused() -> None:
    with pytest.raises(InputError, match=r"expected a camera at rest, got one that leaves its mean place by 0\.02 m"):
        still_pose(poses(5, metres=0.02), source="test")
    turning = poses(2)
    turning[1, 3:] = [-0.5, 0.5, -0.5 - 0.02, 0.5]
    turning[1, 3:] /= np.linalg.norm(turning[1, 3:])
    with pytest.raises(InputError, match="expected a camera at rest"):
        still_pose(turning, source="test")


def test_a_place_inverted_twice_is_the_place() -> None:
    there = placed(TURNED, source="test")
    back = placed(np.linalg.inv(TURNED), source="test", inverse=True)
    np.testing.assert_allclose(np.array(there.world_from_camera), np.array(back.world_from_camera), atol=1e-12)
