"""Calibration files: our own keys in JSON, TOML or YAML; ROS camera_info; OpenCV's FileStorage; Open3D's JSON."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

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
_OPENCV_HEADER = "%YAML:1.0"
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
    if suffix == ".xml":
        document: Any = _xml(path)
    elif suffix == ".json":
        document = json_document(path)
    elif suffix == ".toml":
        document = toml_document(path)
    else:
        document = _yaml(path)
    if not isinstance(document, dict):
        raise InputError(f"{path}: expected keys such as 'fx', got a document without any")
    return {str(key): value for key, value in document.items()}


class _Loader(yaml.SafeLoader):  # type: ignore[misc]  # It has no types.
    """YAML, also as OpenCV's FileStorage writes it: a matrix is a mapping with a tag of its own."""


_Loader.add_constructor(
    "tag:yaml.org,2002:opencv-matrix", lambda loader, node: loader.construct_mapping(node, deep=True)
)


def _yaml(path: Path) -> Any:
    text = text_of(path, "YAML file").removeprefix(_OPENCV_HEADER)  # Which is no directive of YAML's.
    try:
        return yaml.load(text, _Loader)
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:  # ValueError: a date that is none.
        raise InputError(f"{path}: expected YAML, but {' '.join(str(error).split())}") from None


def _xml(path: Path) -> dict[str, Any]:
    """The numbers and matrices at the top of one of OpenCV's documents."""
    try:
        root = ElementTree.fromstring(path.read_bytes())
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # LookupError: an encoding that nobody knows.
        raise InputError(f"{path}: expected OpenCV's FileStorage, but {' '.join(str(error).split())}") from None
    return {entry.tag: _entry(entry) for entry in root}


def _entry(entry: ElementTree.Element) -> Any:
    """A matrix or a list as words, which may be numbers; else a number or a word."""
    data = entry.find("data")
    words = ((entry if data is None else data).text or "").split()
    return words[0] if data is None and len(words) == 1 else words


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
