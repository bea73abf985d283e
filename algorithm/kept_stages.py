"""The results of the stages as files: Arrow tables, exact to the last bit."""

import json
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa
from jaxtyping import Bool, Int
from pyarrow import feather

from algorithm.completion import Completion
from algorithm.followed import Followed
from algorithm.moving_flows import MovingFlows
from algorithm.patches import Patches
from algorithm.representative import Curve
from algorithm.result import Motion
from algorithm.stages import Flowing, Grouped, Observed
from algorithm.trajectories import Trajectories
from recording.cache import Form
from recording.recording import Recording

_BELONGINGS = b"unocclude"
_ROWS_AT_ONCE = 1_000_000


def _write_flowing(flowing: Flowing, path: Path) -> None:
    flows = flowing.flows
    known = {"shape": flows.shape, "begin": flows.begin.tolist(), "seconds": dict(flowing.seconds)}
    _write({"pixel": flows.pixel, "flow": flows.flow}, known, path)


def _read_flowing(path: Path) -> Flowing:
    columns, known = _read(path)
    flows = MovingFlows(
        shape=tuple(known["shape"]),
        begin=np.array(known["begin"]),
        pixel=columns["pixel"],
        flow=columns["flow"],
    )
    return Flowing(flows=flows, seconds=known["seconds"])


def _write_observed(observed: Observed, path: Path) -> None:
    followed = observed.followed
    known = {"spacing_m": followed.spacing_m, "seconds": dict(observed.seconds)}
    _write(_columns(followed.trajectories) | _columns(followed.patches), known, path)


def _read_observed(recording: Recording, path: Path) -> Observed:
    columns, known = _read(path)
    followed = Followed(
        trajectories=_from_columns(Trajectories, columns),
        patches=_from_columns(Patches, columns),
        spacing_m=known["spacing_m"],
        camera=recording.camera,
        fps=recording.fps,
        frames=len(recording.frames),
    )
    return Observed(followed=followed, seconds=known["seconds"])


def _write_grouped(grouped: Grouped, path: Path) -> None:
    _write({"segment": grouped.segments}, {"seconds": dict(grouped.seconds)}, path)


def _read_grouped(observed: Observed, path: Path) -> Grouped:
    columns, known = _read(path)
    return Grouped(followed=observed.followed, segments=columns["segment"], seconds=known["seconds"])


FLOWING = Form(read=_read_flowing, write=_write_flowing)


def observed_form(recording: Recording) -> Form[Observed]:
    """How the second stage's result is kept, without what its recording tells."""
    return Form(read=partial(_read_observed, recording), write=_write_observed)


def grouped_form(observed: Observed) -> Form[Grouped]:
    """How the third stage's result is kept, without that of the second."""
    return Form(read=partial(_read_grouped, observed), write=_write_grouped)


def motion_form(members: Bool[np.ndarray, "trajectory"], segments: Int[np.ndarray, "member"]) -> Form[Motion]:
    """How a motion of some members, whose segments are told, is kept: without these."""
    return Form(read=partial(_read_motion, members, segments), write=_write_motion)


def _write_motion(motion: Motion, path: Path) -> None:
    """A table of one row, whose entries are lists."""
    curve, completion = motion.curve, motion.completion
    columns = {f"curve_{axis}": curve.position[:, number] for number, axis in enumerate("xyz")}
    columns |= {axis: completion.position[:, number] for number, axis in enumerate("xyz")}
    columns |= {name: getattr(completion, name) for name in ("trajectory", "frame", "source", "confidence")}
    columns |= {"points": curve.points, "before": completion.joins[0], "after": completion.joins[1]}
    table = pa.table({name: [values] for name, values in columns.items()})
    feather.write_feather(
        table.replace_schema_metadata(_told({"first": int(curve.first)})), str(path), compression="zstd"
    )


def _read_motion(members: Bool[np.ndarray, "trajectory"], segments: Int[np.ndarray, "member"], path: Path) -> Motion:
    table = feather.read_table(str(path), memory_map=False)
    columns = {
        name: np.array(table.column(name)[0].values.to_numpy(zero_copy_only=False)) for name in table.column_names
    }
    curve = np.stack([columns[f"curve_{axis}"] for axis in "xyz"], axis=1)
    completion = Completion(
        position=np.stack([columns[axis] for axis in "xyz"], axis=1),
        joins=(columns["before"], columns["after"]),
        **{name: columns[name] for name in ("trajectory", "frame", "source", "confidence")},
    )
    return Motion(
        segments=tuple(np.unique(segments).tolist()),
        curve=Curve(first=_known(table.schema)["first"], position=curve, points=columns["points"]),
        members=members,
        completion=completion,
    )


Columns = TypeVar("Columns", Trajectories, Patches)


def _columns(value: Trajectories | Patches) -> dict[str, np.ndarray]:
    return {field.name: getattr(value, field.name) for field in fields(value)}


def _from_columns(kind: type[Columns], columns: dict[str, np.ndarray]) -> Columns:
    return kind(**{field.name: columns[field.name] for field in fields(kind)})


def _write(columns: dict[str, np.ndarray], known: dict[str, Any], path: Path) -> None:
    """Columns of numbers or of vectors, some rows at a time: they are large, and Arrow copies."""
    parts = max(1, -(-len(next(iter(columns.values()))) // _ROWS_AT_ONCE))
    split = {name: np.array_split(values, parts) for name, values in columns.items()}
    schema = _batch(split, 0).schema.with_metadata(_told(known))
    with pa.ipc.new_file(str(path), schema, options=pa.ipc.IpcWriteOptions(compression="zstd")) as file:
        for number in range(parts):
            file.write_batch(_batch(split, number))


def _batch(split: dict[str, list[np.ndarray]], number: int) -> pa.RecordBatch:
    return pa.record_batch({name: _arrow(values[number]) for name, values in split.items()})


def _arrow(values: np.ndarray) -> pa.Array:
    plain = pa.array(values.ravel())
    return plain if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(plain, values.shape[1])


def _read(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Columns that can be written to, as those of a result that was just made."""
    with pa.ipc.open_file(str(path)) as file:
        total = file.count_rows()
        columns = {field.name: _room(field.type, total) for field in file.schema}
        filled = 0
        for number in range(file.num_record_batches):
            batch = file.get_batch(number)
            for name, values in columns.items():
                part = values[filled : filled + len(batch)]
                part[:] = _plain(batch.column(name)).reshape(part.shape)
            filled += len(batch)
        return columns, _known(file.schema)


def _room(kind: pa.DataType, rows: int) -> np.ndarray:
    if pa.types.is_fixed_size_list(kind):
        return np.empty((rows, kind.list_size), kind.value_type.to_pandas_dtype())
    return np.empty(rows, kind.to_pandas_dtype())


def _plain(column: pa.Array) -> np.ndarray:
    return (column.flatten() if pa.types.is_fixed_size_list(column.type) else column).to_numpy(zero_copy_only=False)


def _told(known: dict[str, Any]) -> dict[bytes, str]:
    return {_BELONGINGS: json.dumps(known)}


def _known(schema: pa.Schema) -> dict[str, Any]:
    known: dict[str, Any] = json.loads(schema.metadata[_BELONGINGS])
    return known
