"""Corrections by hand and their file."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recording.corrections import Anchor, Correction, Corrections, load_corrections, save_corrections
from recording.errors import InputError

places = st.floats(-1e4, 1e4)
anchors = st.builds(
    Anchor, frame=st.integers(0, 10**6), column=places, row=places, segment=st.none() | st.integers(0, 999)
)
corrections = st.builds(
    Corrections,
    recording_digest=st.text("0123456789abcdef", max_size=64),
    correction=st.lists(
        st.builds(
            Correction, kind=st.sampled_from(["same", "different", "forbid", "force"]), one=anchors, other=anchors
        ),
        max_size=4,
    ).map(tuple),
)
ONE = Correction(kind="same", one=Anchor(frame=1, column=2.5, row=3), other=Anchor(frame=4, column=5, row=6, segment=7))


@given(said=corrections)
def test_what_is_written_is_read_back(said: Corrections, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("corrections") / "corrections.toml"
    save_corrections(said, path)
    assert load_corrections(path) == said


def test_one_more_and_one_less() -> None:
    none = Corrections(recording_digest="a")
    other = ONE.model_copy(update={"kind": "force"})
    assert none.plus(ONE, other).correction == (ONE, other)
    assert none.plus(ONE, other).without(0) == none.plus(other)
    assert none.correction == ()


def test_an_existing_file_is_kept_unless_it_is_to_be_replaced(tmp_path: Path) -> None:
    path = tmp_path / "corrections.toml"
    save_corrections(Corrections(recording_digest="a"), path)
    with pytest.raises(InputError, match="--overwrite"):
        save_corrections(Corrections(recording_digest="b"), path)
    save_corrections(Corrections(recording_digest="b"), path, overwrite=True)
    assert load_corrections(path).recording_digest == "b"
    assert [each.name for each in tmp_path.iterdir()] == ["corrections.toml"]


GOOD = 'recording_digest = "a"\n[[correction]]\nkind = "same"\n'
MARK = "{ frame = 1, column = 2, row = 3 }"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "'recording_digest' is missing"),
        ('recording_digest = "a"\ncorections = []', "did you mean 'correction'?"),
        ('recording_digest = "A text"', "recording_digest: "),
        (f"{GOOD}one = {MARK}", "'correction.0.other' is missing"),
        (f"{GOOD}one = {MARK}\nother = {MARK}\nkid = 1", "did you mean 'kind'?"),
        (f"{GOOD}one = {MARK}\nother = {{ frame = -1, column = 2, row = 3 }}", "correction.0.other.frame"),
        (f"{GOOD.replace('same', 'equal')}one = {MARK}\nother = {MARK}", "'same', 'different', 'forbid' or 'force'"),
        ('recording_digest = "a"\nformat = { version = 2 }', "format.version"),
        (f"{GOOD}one = {{ frame = 1, column = nan, row = 3 }}\nother = {MARK}", "correction.0.one.column"),
        ("[[correction", "expected TOML"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "corrections.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_corrections(path)
    assert sentence in str(error.value)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="readable TOML file"):
        load_corrections(tmp_path / "none.toml")
