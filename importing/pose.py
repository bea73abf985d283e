"""Where the camera stands: extrinsics by option or file, and whether it stands still at all."""

from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from importing.calibration import Calibration, rigid
from importing.camera_file import camera_document
from recording.checks import text_of, validated
from recording.errors import DAMAGED, InputError

STILL_M, STILL_DEG = 0.01, 0.5
"""A camera that never leaves its mean place by more than this stands still."""
Pose = tuple[float, float, float, float, float, float, float]
"""x, y, z in metres and a unit quaternion x, y, z, w, as TUM RGB-D and ROS write them: the camera in the world."""
_DIRECTIONS = ("world_from_camera", "camera_from_world")


def extrinsics_file(path: Path) -> Calibration:
    """`world_from_camera` in a file.

    JSON, TOML or YAML with the key `world_from_camera` or `camera_from_world`; or 4x4 numbers, as text or `.npy`,
    which are `world_from_camera`.
    """
    if path.suffix.lower() not in (".json", ".toml", ".yaml", ".yml", ".xml"):
        return placed(_bare_matrix(path), source=str(path))
    document = camera_document(path)
    directions = [name for name in _DIRECTIONS if name in document]
    if len(directions) != 1 or len(document) != 1:
        raise InputError(f"{path}: expected one key, 'world_from_camera' or 'camera_from_world', got {[*document]}")
    try:
        matrix = np.array(document[directions[0]], dtype=np.float64).reshape(4, 4)
    except (TypeError, ValueError):
        raise InputError(f"{path}: expected {directions[0]} as 4 rows of 4 numbers") from None
    return placed(matrix, source=str(path), inverse=directions[0] == "camera_from_world")


def placed(matrix: Float[np.ndarray, "4 4"], *, source: str, inverse: bool = False) -> Calibration:
    """The calibration that says no more than where the camera is."""
    checked = validated(Calibration, {"world_from_camera": matrix.tolist()}, source=source)
    if not inverse or checked.world_from_camera is None:
        return checked
    back = np.linalg.inv(np.array(checked.world_from_camera))
    return validated(Calibration, {"world_from_camera": back.tolist()}, source=source)


def pose_matrix(pose: Pose | np.ndarray, *, source: str) -> Float[np.ndarray, "4 4"]:
    """`world_from_camera` of a pose."""
    numbers = np.array(pose, dtype=np.float64)
    length = np.linalg.norm(numbers[3:])
    if not (np.isfinite(numbers).all() and abs(length - 1) < 0.01):
        raise InputError(f"{source}: expected x y z and a unit quaternion qx qy qz qw, got one of length {length:g}")
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat(numbers[3:]).as_matrix()
    matrix[:3, 3] = numbers[:3]
    return rigid(matrix)


def still_pose(poses: Float[np.ndarray, "moment 7"], *, source: str) -> Float[np.ndarray, "4 4"]:
    """`world_from_camera` of a camera at rest, the mean of its poses; InputError where it moves."""
    lengths = np.linalg.norm(poses[:, 3:], axis=1)
    if not (np.isfinite(poses).all() and np.all(np.abs(lengths - 1) < 0.01)):
        raise InputError(f"{source}: expected 'time x y z qx qy qz qw' with unit quaternions in every line")
    turns = Rotation.from_quat(poses[:, 3:])
    place, turn = poses[:, :3].mean(axis=0), turns.mean()
    metres = np.linalg.norm(poses[:, :3] - place, axis=1).max()
    degrees = np.degrees((turn.inv() * turns).magnitude().max())
    if metres > STILL_M or degrees > STILL_DEG:
        raise InputError(
            f"{source}: expected a camera at rest, got one that leaves its mean place by {metres:.3g} m and "
            f"{degrees:.3g} degrees: only what a fixed camera saw can be imported"
        )
    matrix = np.eye(4)
    matrix[:3, :3] = turn.as_matrix()
    matrix[:3, 3] = place
    return matrix


def _bare_matrix(path: Path) -> np.ndarray:
    try:
        if path.suffix.lower() == ".npy":
            matrix = np.load(path, allow_pickle=False)
        else:
            matrix = np.loadtxt(text_of(path, "text file of 4x4 numbers").replace(",", " ").splitlines(), ndmin=2)
    except InputError:
        raise
    except OSError as error:
        raise InputError(
            f"{path}: expected the camera's place, got: {error.strerror or 'an unreadable file'}"
        ) from None
    except DAMAGED as error:
        raise InputError(f"{path}: expected 4 rows of 4 numbers, but {' '.join(str(error).split())}") from None
    if matrix.shape != (4, 4) or matrix.dtype.kind not in "iuf":
        raise InputError(f"{path}: expected 4 rows of 4 numbers, got shape {matrix.shape}")
    return np.asarray(matrix, dtype=np.float64)
