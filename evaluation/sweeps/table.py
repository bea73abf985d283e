"""The results of a sweep as one Parquet file: a row a point and recording."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from algorithm.settings import Settings
from evaluation.compare_tables import flattened
from evaluation.scores import Scores
from evaluation.sweeps.graph import Trial
from evaluation.sweeps.journal import Done
from evaluation.sweeps.plan import Point, Sweep
from evaluation.sweeps.worth import ERROR, WORTH, worth
from recording.atomic import whole_file
from recording.version import VERSION

RESULTS = "results.parquet"
Row = dict[str, Any]
_KINDS = {bool: pa.bool_(), int: pa.int64(), float: pa.float64()}
_OWN = {
    "point": pa.int64(),
    "axis": pa.string(),
    "recording": pa.string(),
    "scene": pa.string(),
    "seed": pa.int64(),
    "key": pa.string(),
    "failure": pa.string(),
}


def row_of(point: Point, trial: Trial, done: Done) -> Row:
    """A row: what was asked, every setting, every score, or why there is none."""
    settings = trial.settings.model_dump(mode="json")
    scores = done.scores or {}
    value = worth(scores)
    return {
        "point": point.number,
        "axis": point.axis,
        "recording": trial.subject.label,
        "scene": trial.subject.scene,
        "seed": trial.subject.seed,
        "key": done.key,
        "failure": done.failure,
        **{f"settings.{name}": setting for name, setting in settings.items()},
        WORTH: value,
        ERROR: None if value is None else 1 - value,
        **scores,
    }


def numbers_of(scores: Scores) -> dict[str, float | None]:
    """The scores that are numbers, or would be, by dotted key."""
    flat = flattened(scores).items()
    return {name: None if value is None else float(value) for name, value in flat if not isinstance(value, str | list)}


def write_results(sweep: Sweep, rows: Sequence[Row], folder: Path) -> None:
    """Write `results.parquet`; scores that a row lacks are null."""
    names = dict.fromkeys(name for row in rows for name in row)
    belongings = {"unocclude": json.dumps({"version": VERSION, "sweep": sweep.model_dump(mode="json", by_alias=True)})}
    schema = pa.schema([(name, _kind(name)) for name in names], metadata=belongings)
    table = pa.Table.from_pylist([dict.fromkeys(names) | row for row in rows], schema=schema)
    with whole_file(folder / RESULTS, overwrite=True) as partial:
        pq.write_table(table, partial, compression="zstd")


def read_results(folder: Path) -> list[Row]:
    """The rows of `results.parquet`."""
    return list(pq.read_table(folder / RESULTS).to_pylist())


def known_results(folder: Path) -> Mapping[str, Done]:
    """What an earlier sweep into the folder has found out, by key; failures are tried again."""
    if not (folder / RESULTS).is_file():
        return {}
    return {row["key"]: Done(key=row["key"], scores=_scores(row)) for row in read_results(folder) if not row["failure"]}


def _scores(row: Row) -> dict[str, float | None]:
    own = {*_OWN, WORTH, ERROR}
    return {name: value for name, value in row.items() if name not in own and not name.startswith("settings.")}


def _kind(name: str) -> pa.DataType:
    if name.startswith("settings."):
        default = Settings.model_fields[name.removeprefix("settings.")].default
        return _KINDS.get(type(default), pa.string())
    return _OWN.get(name, pa.float64())
