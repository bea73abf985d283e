"""Validation of what a user writes: unknown keys name the nearest known one, wrong values say what is allowed."""

import difflib
import json
import math
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from recording.errors import InputError


class Frozen(BaseModel):
    """A value read from a file: fixed once made, no unknown keys, no NaN or infinite numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True)


Model = TypeVar("Model", bound=BaseModel)


def validated(model: type[Model], data: object, *, source: str) -> Model:
    """The data as a value of the model; else an InputError that names the source, the key and the mend."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(f"{source}: {_sentence(model, first)}") from None


def nearest_name(name: str, known: Iterable[str]) -> str:
    """A hint at the known name that looks most like the given one: "did you mean 'b'?" or the list of all."""
    names = sorted(known)
    close = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return f"did you mean {close[0]!r}?" if close else "known: " + ", ".join(names)


def toml_document(path: Path) -> dict[str, Any]:
    """The content of a TOML file."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: expected a readable TOML file, {_reason(error)}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: expected TOML, but {_one_line(error)}") from None


def json_document(path: Path) -> Any:
    """The content of a JSON file; NaN and Infinity are refused, as JSON does."""
    try:
        return json.loads(path.read_text(encoding="utf-8"), parse_constant=_refused_constant)
    except OSError as error:
        raise InputError(f"{path}: expected a readable JSON file, {_reason(error)}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected JSON, but {_one_line(error)}") from None


def finite(value: float | None) -> float | None:
    """The number, or None where there is none: NaN and infinities have no place in JSON."""
    return None if value is None or not math.isfinite(value) else float(value)


def _refused_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON number")


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())


def _reason(error: OSError) -> str:
    return f"got: {error.strerror or type(error).__name__}"


def _sentence(model: type[BaseModel], error: ErrorDetails) -> str:
    """What was wrong, in one sentence that begins with the key."""
    location = error["loc"]
    key = ".".join(str(part) for part in location) or "the document"
    if error["type"] == "extra_forbidden":
        return f"unknown key {key!r}, {nearest_name(str(location[-1]), _known_keys(model, location[:-1]))}"
    if error["type"] == "missing":
        return f"key {key!r} is missing"
    message = error["msg"].removeprefix("Value error, ")
    sentence = f"{key}: {message[0].lower()}{message[1:]}"
    if not location and isinstance(error["input"], dict):
        return sentence  # The whole document says nothing that the user did not know.
    return f"{sentence}, got {_shortened(error['input'])}"


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _known_keys(model: type[BaseModel], location: tuple[int | str, ...]) -> list[str]:
    """The keys that the model, or the model nested in it at the location, knows."""
    for part in location:
        field = model.model_fields.get(str(part))
        nested = _nested_model(field.annotation) if field is not None else None
        model = nested or model
    return list(model.model_fields)


def _nested_model(annotation: object) -> type[BaseModel] | None:
    """The model inside an annotation such as `tuple[Person, ...]` or `Camera | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _nested_model(part))), None)
