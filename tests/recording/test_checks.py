"""Validation: one line that names the source, the key and the mend."""

import math
from pathlib import Path
from typing import Any

import pytest
from pydantic import field_validator

from recording.checks import Frozen, finite, json_document, nearest_name, toml_document, validated
from recording.errors import InputError


class Wheel(Frozen):
    """A part of a part."""

    radius: float
    spokes: int = 8

    @field_validator("radius")
    @classmethod
    def _round(cls, radius: float) -> float:
        if radius <= 0:
            raise ValueError("Expected a radius above 0")
        return radius


class Cart(Frozen):
    """A part."""

    wheels: tuple[Wheel, ...] = ()
    spare: Wheel | None = None
    name: str


GOOD: dict[str, Any] = {"name": "hay", "wheels": [{"radius": 0.5}, {"radius": 0.6, "spokes": 9}]}


def refusal(data: object) -> str:
    with pytest.raises(InputError) as refused:
        validated(Cart, data, source="cart.toml")
    message = str(refused.value)
    assert message.startswith("cart.toml: ")
    assert "\n" not in message
    return message


def test_good_data_become_a_value_that_stays() -> None:
    cart = validated(Cart, GOOD, source="cart.toml")
    assert cart.wheels[1].spokes == 9
    with pytest.raises(ValueError, match="frozen"):
        cart.name = "corn"


def test_an_unknown_key_names_the_nearest() -> None:
    assert "unknown key 'nmae', did you mean 'name'?" in refusal(GOOD | {"nmae": "hay"})


def test_an_unknown_key_within_a_list_names_the_nearest_of_that_level() -> None:
    message = refusal(GOOD | {"wheels": [{"radius": 1.0}, {"radius": 1.0, "spoke": 3}]})
    assert "unknown key 'wheels.1.spoke', did you mean 'spokes'?" in message


def test_an_unknown_key_within_an_optional_part_names_the_nearest_of_that_part() -> None:
    assert "'spare.raduis', did you mean 'radius'?" in refusal(GOOD | {"spare": {"radius": 1.0, "raduis": 1.0}})


def test_an_unknown_key_that_looks_like_nothing_lists_all() -> None:
    assert "known: name, spare, wheels" in refusal(GOOD | {"qqqqqq": 1})


def test_a_missing_key_is_named() -> None:
    assert "key 'name' is missing" in refusal({"wheels": []})
    assert "key 'wheels.0.radius' is missing" in refusal(GOOD | {"wheels": [{}]})


def test_a_wrong_type_says_what_came() -> None:
    message = refusal(GOOD | {"wheels": [{"radius": "big"}]})
    assert "wheels.0.radius: " in message
    assert message.endswith("got 'big'")


def test_a_wrong_value_says_what_was_expected() -> None:
    assert "wheels.0.radius: expected a radius above 0, got -1.0" in refusal(GOOD | {"wheels": [{"radius": -1.0}]})


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_refused(number: float) -> None:
    assert "finite" in refusal(GOOD | {"wheels": [{"radius": number}]})


@pytest.mark.parametrize("data", [None, 3, [], "text"])
def test_another_document_altogether_is_refused(data: object) -> None:
    assert "the document: " in refusal(data)


def test_a_long_value_is_shortened() -> None:
    assert len(refusal(GOOD | {"wheels": "x" * 10_000})) < 300


def test_the_nearest_name_is_the_one_that_looks_most_alike() -> None:
    assert nearest_name("esp3", ["eps1", "eps3", "flow"]) == "did you mean 'eps3'?"
    assert nearest_name("zzz", ["b", "a"]) == "known: a, b"


def test_a_json_document_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"a": [1, 2.5, "ä"]}', encoding="utf-8")
    assert json_document(path) == {"a": [1, 2.5, "ä"]}


@pytest.mark.parametrize(
    "content", [b"", b"{", b'{"a": NaN}', b'{"a": -Infinity}', b"\xff\xfe\x00", b"[" * 100_000, b'{"a": 1} {']
)
def test_a_damaged_json_document_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.json: expected (JSON, but|a readable JSON file, got:) [^\n]+$"):
        json_document(path)


@pytest.mark.parametrize(
    "content", [b"a = ", b"a = 1\na = 2", b"\xff\xfe\x00", b"a = " + b"[" * 100_000, b"a = " + b"9" * 5000]
)
def test_a_damaged_toml_document_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.toml: expected (TOML, but|a readable TOML file, got:) [^\n]+$"):
        toml_document(path)


def test_a_toml_document_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("[part]\na = 1\n")
    assert toml_document(path) == {"part": {"a": 1}}


@pytest.mark.parametrize("document", [json_document, toml_document])
def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path, document) -> None:
    with pytest.raises(InputError, match="none: expected a readable"):
        document(tmp_path / "none")
    with pytest.raises(InputError, match="expected a readable"):
        document(tmp_path)


def test_only_finite_numbers_go_into_json() -> None:
    assert finite(1.5) == 1.5
    assert [finite(number) for number in (None, math.nan, math.inf, -math.inf)] == [None] * 4
