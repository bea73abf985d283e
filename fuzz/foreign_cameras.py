"""The readers of what tells of an imported camera, and of when and where it saw."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from fuzz.foreign_files import image, imported
from fuzz.target import Target, saved
from importing.calibration import Calibration
from importing.camera_file import calibration_file
from importing.pose import extrinsics_file
from importing.undistort import undistortion

_OWN = b'{"fx": 4, "fy": 4, "cx": 1.5, "cy": 1, "width": 4, "height": 3, "distortion": [0.1, 0, 0, 0], "fps": 10}'
_OPEN3D = b'{"width": 4, "height": 3, "intrinsic_matrix": [4, 0, 0, 0, 4, 0, 1.5, 1, 1]}'
_ROS = b"""image_width: 4
image_height: 3
camera_matrix: {rows: 3, cols: 3, data: [4, 0, 1.5, 0, 4, 1, 0, 0, 1]}
distortion_model: equidistant
distortion_coefficients: {rows: 1, cols: 4, data: [-0.28, 0.07, 1.0e-05, 0.0]}
"""
_MATRIX = b"1 0 0 0.5\n0 1 0 2\n0 0 1 -3\n0 0 0 1\n"
_TIMES = b"# timestamp filename\n7.0 a.png\n7.1 a.png\n"
_PLACES = b"# timestamp tx ty tz qx qy qz qw\n6.9 1 2 1.5 -0.5 0.5 -0.5 0.5\n7.05 1.001 2 1.5 -0.5 0.5 -0.5 0.5\n"
_ON_DESK = Calibration(fx=4.0, fy=4.0, cx=1.5, cy=1.0)


def _storage(suffix: str) -> list[bytes]:
    """OpenCV's own."""

    def save(path: Path) -> None:
        storage = cv2.FileStorage(str(path), cv2.FileStorage_WRITE)
        storage.write("image_width", 4)
        storage.write("image_height", 3)
        storage.write("camera_matrix", np.array([[4.0, 0, 1.5], [0, 4, 1], [0, 0, 1]]))
        storage.write("distortion_coefficients", np.full((5, 1), 0.01))
        storage.write("calibration_time", "yesterday")
        storage.release()

    return saved(f"a{suffix}", save)


def _camera(name: str) -> Callable[[Path], None]:
    """What takes the camera, for a picture of four by three pixels."""

    def read(folder: Path) -> None:
        known = calibration_file(folder / name)
        undistortion(known, known.camera(4, 3, source=name))

    return read


def _sequence(folder: Path) -> None:
    """TUM RGB-D, with what of it is not there."""
    if not (folder / "a.png").is_file():
        (folder / "a.png").write_bytes(image(".png"))
    if not (folder / "depth.txt").is_file():
        (folder / "depth.txt").write_bytes(_TIMES)
    imported(folder, _ON_DESK)


CAMERAS = {
    "camera": Target(name="a.json", read=_camera("a.json"), seeds=lambda: [_OWN, _OPEN3D]),
    "camera_yaml": Target(name="a.yaml", read=_camera("a.yaml"), seeds=lambda: [_ROS]),
    "camera_storage": Target(name="a.yml", read=_camera("a.yml"), seeds=lambda: _storage(".yml")),
    "camera_xml": Target(name="a.xml", read=_camera("a.xml"), seeds=lambda: _storage(".xml")),
    "extrinsics": Target(
        name="a.json",
        read=lambda folder: extrinsics_file(folder / "a.json"),
        seeds=lambda: [b'{"camera_from_world": [[0, 1, 0, 2], [-1, 0, 0, 0.5], [0, 0, 1, 3], [0, 0, 0, 1]]}'],
    ),
    "extrinsics_text": Target(
        name="a.txt", read=lambda folder: extrinsics_file(folder / "a.txt"), seeds=lambda: [_MATRIX]
    ),
    "extrinsics_npy": Target(
        name="a.npy",
        read=lambda folder: extrinsics_file(folder / "a.npy"),
        seeds=lambda: saved("a.npy", lambda path: np.save(path, np.eye(4))),
    ),
    "tum_times": Target(name="depth.txt", read=_sequence, seeds=lambda: [_TIMES]),
    "tum_places": Target(name="groundtruth.txt", read=_sequence, seeds=lambda: [_PLACES]),
}
"""By what they read."""
