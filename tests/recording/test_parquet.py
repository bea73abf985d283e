"""`motions.parquet`: a round trip, other people's readers, other people's files."""

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recording.errors import InputError
from recording.motions import (
    COLUMNS,
    INTER,
    INTRA,
    OBSERVED,
    Event,
    Link,
    Making,
    Motions,
    Representative,
    mean_places,
)
from recording.parquet import load_motions, save_motions

KINDS = {
    **dict.fromkeys(("frame", "trajectory", "segment", "motion"), pa.int32()),
    **dict.fromkeys(("x", "y", "z", "row", "column", "confidence"), pa.float32()),
}


def random_motions(count: int = 40, seed: int = 0) -> Motions:
    """Rows with every value, sorted; and everything that can belong to them."""
    generator = np.random.default_rng(seed)
    key = np.sort(generator.choice(1000, count, replace=False))
    source = generator.integers(0, 3, count).astype(np.uint8)
    column_row = generator.uniform(0, 80, (count, 2)).astype(np.float32)
    column_row[source != OBSERVED] = np.nan
    curve = Representative(
        motion=0,
        frame=np.arange(3, 7, dtype=np.int32),
        position=generator.normal(size=(4, 3)),
        observed=np.array([True, False, False, True]),
    )
    return Motions(
        frame=(key % 100).astype(np.int32),
        trajectory=(key // 100).astype(np.int32),
        position=generator.normal(size=(count, 3)).astype(np.float32),
        column_row=column_row,
        segment=generator.integers(-1, 5, count).astype(np.int32),
        motion=generator.integers(-1, 3, count).astype(np.int32),
        source=source,
        confidence=generator.random(count).astype(np.float32),
        representatives=(curve,),
        links=(Link(before=0, after=3, confidence=0.25),),
        alternatives=(Link(before=0, after=4, confidence=0.125, chosen=False),),
        events=(Event(kind="merge", frame=3, motions=(0, 2)),),
        making=Making(
            settings={"eps1": 0.5, "flow": "dis", "seed": None},
            recording_digest="abc",
            version="0.1",
            seconds={"flow": 1.5},
        ),
    )


def assert_same(one: Motions, other: Motions) -> None:
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
        assert getattr(one, name).dtype == getattr(other, name).dtype
    assert one.links == other.links
    assert one.alternatives == other.alternatives
    assert one.events == other.events
    assert vars(one.making) == vars(other.making)
    assert len(one.representatives) == len(other.representatives)
    for mine, theirs in zip(one.representatives, other.representatives, strict=True):
        for entry in fields(Representative):
            np.testing.assert_array_equal(getattr(mine, entry.name), getattr(theirs, entry.name))


@settings(max_examples=20)
@given(st.integers(0, 60), st.integers(0, 1000))
def test_motions_come_back_as_they_were(tmp_path_factory: pytest.TempPathFactory, count: int, seed: int) -> None:
    path = tmp_path_factory.mktemp("motions") / "motions.parquet"
    save_motions(random_motions(count, seed), path)
    assert_same(load_motions(path), random_motions(count, seed))


def test_the_columns_have_the_kinds_of_the_contract(tmp_path: Path) -> None:
    save_motions(random_motions(), tmp_path / "motions.parquet")
    schema = pq.read_schema(tmp_path / "motions.parquet")
    assert {name: schema.field(name).type for name in KINDS} == KINDS
    assert pa.types.is_dictionary(schema.field("source").type)
    assert set(schema.names) == {*KINDS, "source"}
    names = "settings recording_digest version seconds representatives links alternatives events"
    assert {name.encode() for name in names.split()} <= set(schema.metadata)


def test_pandas_reads_it_as_it_is(tmp_path: Path) -> None:
    motions = random_motions()
    save_motions(motions, tmp_path / "motions.parquet")
    table = pd.read_parquet(tmp_path / "motions.parquet")
    for name, kind in KINDS.items():
        assert table[name].dtype == kind.to_pandas_dtype()
    np.testing.assert_array_equal(table[["x", "y", "z"]].to_numpy(), motions.position)
    np.testing.assert_array_equal(table[["column", "row"]].to_numpy(), motions.column_row)
    names = np.array(["observed", "intra", "inter"])[motions.source]
    np.testing.assert_array_equal(table["source"].astype(str).to_numpy(), names)
    assert table["source"].dtype == "category"


# ---- Files from elsewhere ----

FOREIGN: dict[str, Any] = {
    "frame": [1, 0, 5, 0],
    "trajectory": [2, 2, 1, 7],
    "x": [1.0, 2.0, 3.0, 4.0],
    "y": [0.0, 0.0, 0.0, 0.0],
    "z": [1.0, 1.0, 1.0, 1.0],
    "motion": [0, 0, 1, -1],
    "source": ["observed", "inter", "intra", "observed"],
}


def foreign(tmp_path: Path, **changes: Any) -> Path:
    """The file that pandas makes of the columns; None leaves one out."""
    path = tmp_path / "foreign.parquet"
    columns = {name: values for name, values in (FOREIGN | changes).items() if values is not None}
    pd.DataFrame(columns).to_parquet(path)
    return path


def test_a_minimal_file_is_enough_and_its_rows_are_sorted(tmp_path: Path) -> None:
    motions = load_motions(foreign(tmp_path))
    np.testing.assert_array_equal(motions.trajectory, [1, 2, 2, 7])
    np.testing.assert_array_equal(motions.frame, [5, 0, 1, 0])
    np.testing.assert_array_equal(motions.position[:, 0], [3, 2, 1, 4])
    np.testing.assert_array_equal(motions.source, [INTRA, INTER, OBSERVED, OBSERVED])
    np.testing.assert_array_equal(motions.segment, motions.motion)
    np.testing.assert_array_equal(motions.confidence, 1.0)
    assert np.isnan(motions.column_row).all()
    assert vars(motions.making) == vars(Making())
    assert motions.representatives == ()
    assert motions.motion_ids == [0, 1]


def test_a_missing_picture_position_may_be_written_as_nothing(tmp_path: Path) -> None:
    path = foreign(tmp_path, row=[1.5, np.nan, np.nan, 2.5], column=[0.5, np.nan, np.nan, 9.5])
    assert pq.read_table(path).column("row").null_count == 2  # So does pandas write NaN.
    np.testing.assert_array_equal(
        load_motions(path).column_row, [[np.nan, np.nan], [np.nan, np.nan], [0.5, 1.5], [9.5, 2.5]]
    )


def test_an_empty_file_has_no_motions(tmp_path: Path) -> None:
    path = tmp_path / "empty.parquet"
    pd.DataFrame(FOREIGN).iloc[:0].to_parquet(path)
    assert len(load_motions(path)) == 0
    assert load_motions(path).motion_ids == []


BAD_COLUMNS: dict[str, tuple[dict[str, Any], str]] = {
    "missing": ({"x": None, "motion": None}, "missing: x, motion"),
    "text": ({"frame": ["a", "b", "c", "d"]}, "expected column 'frame' as int32"),
    "half a frame": ({"frame": [0.5, 1.0, 2.0, 3.0]}, "expected column 'frame' as int32"),
    "too large": ({"trajectory": [2**40, 1, 2, 3]}, "expected column 'trajectory' as int32"),
    "null": ({"motion": [0, None, 1, 1]}, "expected a value in every row of 'motion', got 1 without"),
    "no place": ({"y": [0.0, np.nan, 0.0, 0.0]}, "'y'"),
    "infinite": ({"z": [0.0, np.inf, 0.0, 0.0]}, "expected finite places.*'z'"),
    "motion": ({"motion": [0, 0, 0, -2]}, "expected motions from -1 .*got -2"),
    "source": ({"source": ["observed", "inter", "guess", "intra"]}, "in column 'source', got 'guess'"),
    "numbered source": ({"source": [0, 1, 2, 0]}, "in column 'source', got"),
    "no source": ({"source": ["observed", None, "inter", "intra"]}, "in column 'source', got"),
}


@pytest.mark.parametrize("kind", BAD_COLUMNS)
def test_a_bad_column_is_one_line_that_names_it(tmp_path: Path, kind: str) -> None:
    changes, message = BAD_COLUMNS[kind]
    path = foreign(tmp_path, **changes)
    with pytest.raises(InputError, match=rf"foreign\.parquet: .*{message}") as refused:
        load_motions(path)
    assert "\n" not in str(refused.value)


def truncated(path: Path) -> None:
    save_motions(random_motions(), path)
    path.write_bytes(path.read_bytes()[:-20])


def with_metadata(**metadata: str) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        pq.write_table(pa.table(FOREIGN).replace_schema_metadata(metadata), path)

    return make


def test_a_file_from_before_alternatives_has_none(tmp_path: Path) -> None:
    with_metadata(links='[{"before": 0, "after": 3, "confidence": 0.25}]')(tmp_path / "old.parquet")
    old = load_motions(tmp_path / "old.parquet")
    assert old.links == (Link(before=0, after=3, confidence=0.25),)
    assert old.links[0].chosen
    assert (old.alternatives, old.events) == ((), ())


BAD_FILES: dict[str, tuple[Callable[[Path], object], str]] = {
    "empty": (lambda path: path.write_bytes(b""), "expected a Parquet file"),
    "text": (lambda path: path.write_text("frame,x\n1,2\n"), "expected a Parquet file"),
    "truncated": (truncated, "expected a Parquet file"),
    "folder": (lambda path: path.mkdir(), "expected a motions.parquet"),
    "none": (lambda path: None, "expected a motions.parquet, but there is no such file: run 'unocclude solve'"),
    "no JSON": (with_metadata(settings="{"), "metadata is damaged"),
    "half a representative": (with_metadata(representatives='[{"motion": 0}]'), "metadata is damaged"),
    "links of something": (with_metadata(links='[{"from": 0}]'), "metadata is damaged"),
    "no list": (with_metadata(representatives="3"), "metadata is damaged"),
    "a representative of two lengths": (
        with_metadata(
            representatives='[{"motion": 0, "frame": [0, 1], "x": [0], "y": [0], "z": [0], "observed": [true]}]'
        ),
        "metadata is damaged: representatives.0: expected every frame once",
    ),
    "a representative twice in a frame": (
        with_metadata(
            representatives='[{"motion": 0, "frame": [1, 1], "x": [0, 0], "y": [0, 0], "z": [0, 0], '
            '"observed": [true, true]}]'
        ),
        "metadata is damaged: representatives.0: expected every frame once",
    ),
    "seconds in a list": (with_metadata(seconds="[1, 2]"), "metadata is damaged: seconds"),
    "settings of nothing": (with_metadata(settings='"default"'), "metadata is damaged: settings"),
    "a number as digest": (with_metadata(recording_digest="12"), "metadata is damaged: recording_digest"),
    "events of words": (with_metadata(events='["met"]'), "metadata is damaged: events"),
    "an unknown event": (
        with_metadata(events='[{"kind": "enters", "frame": 3, "motions": [0, 1]}]'),
        "metadata is damaged: events.0.kind",
    ),
    "an event before the first frame": (
        with_metadata(events='[{"kind": "split", "frame": -1, "motions": [0, 1]}]'),
        "metadata is damaged: events.0.frame",
    ),
    "an event of one motion": (
        with_metadata(events='[{"kind": "merge", "frame": 3, "motions": [1, 1]}]'),
        "metadata is damaged: events.0: expected two different motions, got 1 twice",
    ),
    "an event of three motions": (
        with_metadata(events='[{"kind": "merge", "frame": 3, "motions": [0, 1, 2]}]'),
        "metadata is damaged: events.0.motions",
    ),
}


@pytest.mark.parametrize("kind", BAD_FILES)
def test_a_bad_file_is_one_line_that_names_it(tmp_path: Path, kind: str) -> None:
    make, message = BAD_FILES[kind]
    path = tmp_path / "bad.parquet"
    make(path)
    with pytest.raises(InputError, match=rf"bad\.parquet: .*{message}") as refused:
        load_motions(path)
    assert "\n" not in str(refused.value)


def test_an_existing_file_is_kept_without_overwrite(tmp_path: Path) -> None:
    path = tmp_path / "motions.parquet"
    save_motions(random_motions(seed=1), path)
    with pytest.raises(InputError, match=r"exists already.*--overwrite"):
        save_motions(random_motions(seed=2), path)
    assert_same(load_motions(path), random_motions(seed=1))
    save_motions(random_motions(seed=2), path, overwrite=True)
    assert_same(load_motions(path), random_motions(seed=2))
    assert [entry.name for entry in tmp_path.iterdir()] == ["motions.parquet"]


# ---- Motions as values ----


def test_chosen_rows_keep_what_belongs_to_them() -> None:
    motions = random_motions()
    some = motions.rows(motions.frame < 50)
    assert 0 < len(some) < len(motions)
    assert (some.frame < 50).all()
    assert some.links == motions.links
    assert (some.alternatives, some.events) == (motions.alternatives, motions.events)
    assert some.making == motions.making
    np.testing.assert_array_equal(motions.observed, motions.source == OBSERVED)


def test_the_mean_place_is_the_mean_of_the_points_in_each_frame(tmp_path: Path) -> None:
    motions = replace(random_motions(60), motion=np.repeat(np.array([0, 4, -1], np.int32), 20))
    places = mean_places(motions)
    assert [place.motion for place in places] == [0, 4]
    for place in places:
        assert (np.diff(place.frame) > 0).all()
        for frame, position, observed in zip(place.frame, place.position, place.observed, strict=True):
            rows = (motions.motion == place.motion) & (motions.frame == frame)
            np.testing.assert_allclose(position, motions.position[rows].mean(axis=0), atol=1e-6)
            assert observed == (motions.source[rows] == OBSERVED).any()
        assert set(place.frame) == set(motions.frame[motions.motion == place.motion])
