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

_MOST_BYTES = 256 * 10**6
"""Of a text file: whatever is larger was not written for us."""


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


def lack_of(name: str, folder: Path) -> str:
    """What there is in place of a folder that holds a file of that name, as a refusal says it."""
    if not folder.exists():
        return "there is no such folder"
    return f"it holds no {name}" if folder.is_dir() else "it is a file"


def text_of(path: Path, kind: str) -> str:
    """The text of a file in UTF-8, without a byte order mark; `kind` says in a refusal what it should be."""
    try:
        with path.open("rb") as file:
            content = file.read(_MOST_BYTES + 1)  # A device has no size, and no end.
        if len(content) <= _MOST_BYTES:
            return content.decode("utf-8-sig")
        reason = f"more than {_MOST_BYTES // 10**6} MB"
    except UnicodeDecodeError:
        reason = "no UTF-8"
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name.
        reason = getattr(error, "strerror", None) or _one_line(error)
    raise InputError(f"{path}: expected a readable {kind}, got: {reason}")


def toml_document(path: Path) -> dict[str, Any]:
    """The content of a TOML file."""
    text = text_of(path, "TOML file")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected TOML, but {_one_line(error)}") from None


def json_document(path: Path) -> Any:
    """The content of a JSON file; NaN and Infinity are refused, as JSON does."""
    return json_value(text_of(path, "JSON file"), source=str(path))


def json_value(text: str | bytes, *, source: str) -> Any:
    """What JSON text says; NaN and Infinity are refused, as JSON does. `source` says in a refusal where it stands."""
    try:
        return json.loads(text, parse_constant=_refused_constant)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{source}: expected JSON, but {_one_line(error)}") from None


def finite(value: float | None) -> float | None:
    """The number, or None where there is none: NaN and infinities have no place in JSON."""
    return None if value is None or not math.isfinite(value) else float(value)


def _refused_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON number")


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())


def _sentence(model: type[BaseModel], error: ErrorDetails) -> str:
    """What was wrong, in one sentence that begins with the key."""
    location = error["loc"]
    nested, written = _found(model, location[:-1] if error["type"] == "extra_forbidden" else location)
    key = written or "the document"
    if error["type"] == "extra_forbidden":
        unknown = f"{written}.{location[-1]}".removeprefix(".")
        return f"unknown key {unknown!r}, {nearest_name(str(location[-1]), nested.model_fields)}"
    if error["type"] == "missing":
        return f"key {key!r} is missing"
    if error["type"] == "union_tag_not_found":
        return f"key '{key}.{error['ctx']['discriminator'].strip(chr(39))}' is missing"
    if error["type"] == "union_tag_invalid":
        tag = error["ctx"]
        name = tag["discriminator"].strip("'")
        return f"{key}.{name}: input should be {tag['expected_tags'].replace(', ', ' or ')}, got {tag['tag']!r}"
    message = error["msg"].removeprefix("Value error, ")
    sentence = f"{key}: {message[0].lower()}{message[1:]}"
    if not location and isinstance(error["input"], dict):
        return sentence  # The whole document says nothing that the user did not know.
    return f"{sentence}, got {_shortened(error['input'])}"


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _found(model: type[BaseModel], location: tuple[int | str, ...]) -> tuple[type[BaseModel], str]:
    """The model that is nested in this one at the location, and the key as the user wrote it.

    Pydantic's location names the kind of a value that can be of several; the user's key does not.
    """
    models, key = [model], []
    for part in location:
        chosen = [choice for choice in models if len(models) > 1 and _is_of_kind(choice, part)]
        field = models[0].model_fields.get(str(part))
        if not chosen:
            key.append(str(part))
        models = chosen or (_nested_models(field.annotation) if field is not None else []) or models
    return models[0], ".".join(key)


def _is_of_kind(model: type[BaseModel], tag: int | str) -> bool:
    """Whether one of the model's keys can have no other value than the tag."""
    return any(get_args(field.annotation) == (tag,) for field in model.model_fields.values())


def _nested_models(annotation: object) -> list[type[BaseModel]]:
    """The models inside an annotation such as `tuple[Person, ...]` or `Camera | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _nested_models(part)]
