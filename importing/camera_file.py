"""Calibration files: our own keys in JSON, TOML or YAML; ROS camera_info; OpenCV's FileStorage; Open3D's JSON."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import yaml

from importing.calibration import Calibration
from recording.checks import json_document, text_of, toml_document, validated
from recording.errors import InputError

_LARGEST_BYTES = 1_000_000
_MATRIX = ("camera_matrix", "cameraMatrix", "CameraMatrix", "K", "k")
_DISTORTION = ("distortion_coefficients", "distortionCoefficients", "distCoeffs", "dist_coeffs", "D", "d")
_WIDTH = ("image_width", "imageWidth", "width")
_HEIGHT = ("image_height", "imageHeight", "height")
_FILE_STORAGE = (b"opencv-matrix", b"%YAML:1.0")
"""What only OpenCV writes; other readers of YAML and JSON do not understand it."""
_COLUMN_MAJOR = "intrinsic_matrix"
"""Open3D's key: nine numbers, column by column."""


def calibration_file(path: Path) -> Calibration:
    """The calibration in a file."""
    document = camera_document(path)
    if not any(name in document for name in (*_MATRIX, _COLUMN_MAJOR)):
        return validated(Calibration, document, source=str(path))
    return foreign_calibration(document, source=str(path))


def foreign_calibration(document: Mapping[str, Any], *, source: str) -> Calibration:
    """The calibration in a document that calls things as ROS, OpenCV or Open3D do; what else is in it is left out."""
    matrix = _matrix(document, source)
    known: dict[str, Any] = {"fx": matrix[0, 0], "fy": matrix[1, 1], "cx": matrix[0, 2], "cy": matrix[1, 2]}
    if not known["fx"] > 0:  # How ROS says that a camera is not calibrated.
        raise InputError(f"{source}: expected a calibrated camera, got a focal length of {known['fx']:g}")
    for key, names in (("width", _WIDTH), ("height", _HEIGHT)):
        value = _first(document, names)
        if value:  # 0 is ROS's "not known".
            known[key] = value
    coefficients = _first(document, _DISTORTION)
    if coefficients is not None:
        known["distortion"] = tuple(_numbers(coefficients, f"{source}: distortion").tolist())
    model = document.get("distortion_model")
    if model and any(known.get("distortion", ())):
        known["distortion_model"] = {"fisheye": "equidistant"}.get(model, model)
    return validated(Calibration, known, source=source)


def camera_document(path: Path) -> dict[str, Any]:
    """The keys of a JSON, TOML, YAML or FileStorage document."""
    if not path.is_file():
        raise InputError(f"{path}: expected a file with the camera, but there is none")
    if path.stat().st_size > _LARGEST_BYTES:
        raise InputError(f"{path}: expected a camera in some kilobytes, got {path.stat().st_size / 1e6:.0f} MB")
    suffix = path.suffix.lower()
    if suffix not in (".json", ".toml", ".yaml", ".yml", ".xml"):
        raise InputError(f"{path}: expected a camera as .json, .toml, .yaml, .yml or .xml, got {suffix or 'no suffix'}")
    content = path.read_bytes()
    if suffix == ".xml" or any(mark in content for mark in _FILE_STORAGE):
        document: Any = _file_storage(path)
    elif suffix == ".json":
        document = json_document(path)
    elif suffix == ".toml":
        document = toml_document(path)
    else:
        document = _yaml(path)
    if not isinstance(document, dict):
        raise InputError(f"{path}: expected keys such as 'fx', got a document without any")
    return {str(key): value for key, value in document.items()}


def _yaml(path: Path) -> Any:
    text = text_of(path, "YAML file")
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:  # ValueError: a date that is none.
        raise InputError(f"{path}: expected YAML, but {' '.join(str(error).split())}") from None


def _file_storage(path: Path) -> dict[str, Any]:
    """The numbers and matrices at the top of one of OpenCV's documents."""
    try:
        storage = cv2.FileStorage(str(path), cv2.FileStorage_READ)
        root = storage.root()
        nodes = {name: root.getNode(name) for name in (root.keys() if root.isMap() else ())}
        return {name: _content(node) for name, node in nodes.items()}
    except (cv2.error, SystemError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: expected OpenCV's FileStorage, but {' '.join(str(error).split())}") from None


def _content(node: cv2.FileNode) -> Any:
    if node.isMap():
        return node.mat()
    if node.isSeq():
        return [_content(node.at(index)) for index in range(node.size())]
    return node.string() if node.isString() else node.real()


def _matrix(document: Mapping[str, Any], source: str) -> np.ndarray:
    found = _first(document, _MATRIX)
    values = _numbers(document.get(_COLUMN_MAJOR) if found is None else found, f"{source}: camera matrix")
    if values.size != 9:
        raise InputError(f"{source}: expected a 3x3 camera matrix, got {values.size} numbers")
    matrix = values.reshape(3, 3)
    return matrix if found is not None else matrix.T


def _numbers(value: Any, what: str) -> np.ndarray:
    """The numbers in a list, in rows, or under the key `data`, one after the other."""
    listed = value.get("data") if isinstance(value, dict) else value
    try:  # YAML takes 1e-05 for text.
        numbers = np.asarray(listed, dtype=np.float64).ravel()
    except (TypeError, ValueError):
        raise InputError(f"{what}: expected numbers, got {str(listed)[:60]!r}") from None
    if not np.isfinite(numbers).all():
        raise InputError(f"{what}: expected finite numbers, got {str(listed)[:60]!r}")
    return numbers


def _first(document: Mapping[str, Any], names: tuple[str, ...]) -> Any:
    return next((document[name] for name in names if document.get(name) is not None), None)
