"""`motions.parquet`: reading and writing motions."""

import json
import os
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from pydantic import Field, model_validator

from recording.atomic import whole_file
from recording.checks import Frozen, json_value, validated
from recording.corrections import Corrections
from recording.errors import InputError
from recording.motions import NOISE, SOURCES, Event, EventKind, Link, Making, Motions, Representative

NotNegative = Annotated[int, Field(ge=0, lt=2**31)]
Int32 = Annotated[int, Field(ge=-(2**31), lt=2**31)]
_FEW_ROWS, _ROWS_IN_A_BYTE = 10**6, 4
_REQUIRED = ("frame", "trajectory", "x", "y", "z", "motion", "source")
_KINDS = {
    "frame": pa.int32(),
    "trajectory": pa.int32(),
    **dict.fromkeys(("x", "y", "z", "row", "column"), pa.float32()),
    "segment": pa.int32(),
    "motion": pa.int32(),
    "confidence": pa.float32(),
}


class _StoredRepresentative(Frozen):
    motion: NotNegative
    frame: tuple[NotNegative, ...]
    x: tuple[float, ...]
    y: tuple[float, ...]
    z: tuple[float, ...]
    observed: tuple[bool, ...]

    @model_validator(mode="after")
    def _of_one_length(self) -> "_StoredRepresentative":
        lengths = {len(self.frame), len(self.x), len(self.y), len(self.z), len(self.observed)}
        if len(lengths) > 1 or len(set(self.frame)) < len(self.frame):
            raise ValueError("expected every frame once, with x, y, z and observed of each")
        return self

    @property
    def representative(self) -> Representative:
        return Representative(
            motion=self.motion,
            frame=np.array(self.frame, np.int32),
            position=np.array([self.x, self.y, self.z], np.float64).T.reshape(-1, 3),
            observed=np.array(self.observed, bool),
        )


class _StoredLink(Frozen):
    before: Int32
    after: Int32
    confidence: float


class _StoredEvent(Frozen):
    kind: EventKind
    frame: NotNegative
    motions: tuple[NotNegative, NotNegative]

    @model_validator(mode="after")
    def _of_two(self) -> "_StoredEvent":
        if self.motions[0] == self.motions[1]:
            raise ValueError(f"expected two different motions, got {self.motions[0]} twice")
        return self


class _Belongings(Frozen):
    """The schema's metadata."""

    settings: dict[str, Any] = Field(default_factory=dict)
    recording_digest: str | None = None
    version: str | None = None
    seconds: dict[str, float] = Field(default_factory=dict)
    corrections: Corrections | None = None
    representatives: tuple[_StoredRepresentative, ...] = ()
    links: tuple[_StoredLink, ...] = ()
    alternatives: tuple[_StoredLink, ...] = ()
    events: tuple[_StoredEvent, ...] = ()


def save_motions(motions: Motions, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
    """Write the motions as Parquet; what belongs to them goes into the schema's metadata as JSON."""
    x, y, z = motions.position.T
    column, row = motions.column_row.T
    table = pa.table(
        {
            "frame": motions.frame,
            "trajectory": motions.trajectory,
            **{"x": x, "y": y, "z": z, "row": row, "column": column},
            "segment": motions.segment,
            "motion": motions.motion,
            "source": pa.DictionaryArray.from_arrays(motions.source.astype(np.int8), list(SOURCES)),
            "confidence": motions.confidence,
        }
    ).replace_schema_metadata({key: json.dumps(value) for key, value in _belongings(motions).items()})
    with whole_file(Path(path), overwrite=overwrite) as partial:
        pq.write_table(table, partial, compression="zstd")


def load_motions(path: str | os.PathLike[str]) -> Motions:
    """The motions in a Parquet file, from this project or from elsewhere.

    Required are frame, trajectory, x, y, z, motion and source; row and column are NaN, segment is the
    motion and confidence is 1 where a file lacks them. Rows come back sorted by trajectory, then frame.
    """
    place = Path(path)
    if not place.is_file():
        raise InputError(f"{place}: expected a motions.parquet, but there is no such file: run 'unocclude solve'")
    table = _table(place)
    missing = [name for name in _REQUIRED if name not in table.column_names]
    if missing:
        raise InputError(f"{place}: expected the columns {', '.join(_REQUIRED)}; missing: {', '.join(missing)}")
    columns = {name: _column(place, table, name) for name in _KINDS if name in table.column_names}
    order = np.lexsort((columns["frame"], columns["trajectory"]))
    belongings = _read_belongings(place, table.schema.metadata or {})
    return _motions(columns, _source(place, table), belongings).rows(order)


def _table(place: Path) -> pa.Table:
    """The file's table, unless it promises more rows than there can be: no two rows are alike, and each needs room."""
    try:
        rows = pq.read_metadata(place).num_rows
        if rows <= _FEW_ROWS + _ROWS_IN_A_BYTE * place.stat().st_size:
            return pq.read_table(place)
    except (pa.ArrowException, OSError, MemoryError, ValueError) as error:  # Arrow raises what it likes.
        raise InputError(f"{place}: expected a Parquet file, but it cannot be read: {_line(error)}") from None
    raise InputError(f"{place}: expected different places in its rows, got {rows} rows that take hardly any room")


def _motions(columns: dict[str, np.ndarray], source: np.ndarray, belongings: dict[str, Any]) -> Motions:
    count = len(columns["frame"])
    unknown = np.full(count, np.nan, np.float32)
    return Motions(
        frame=columns["frame"],
        trajectory=columns["trajectory"],
        position=np.stack([columns["x"], columns["y"], columns["z"]], axis=1),
        column_row=np.stack([columns.get("column", unknown), columns.get("row", unknown)], axis=1),
        segment=columns.get("segment", columns["motion"]),
        motion=columns["motion"],
        source=source,
        confidence=columns.get("confidence", np.ones(count, np.float32)),
        **belongings,
    )


def _column(place: Path, table: pa.Table, name: str) -> np.ndarray:
    kind = _KINDS[name]
    try:
        values = table.column(name).cast(kind)
    except pa.ArrowException as error:
        raise InputError(f"{place}: expected column {name!r} as {kind}, but {_line(error)}") from None
    if values.null_count and name not in ("row", "column"):  # Where completed, pandas and others write null for NaN.
        raise InputError(f"{place}: expected a value in every row of {name!r}, got {values.null_count} without")
    array = values.to_numpy().astype(kind.to_pandas_dtype())
    if name in ("x", "y", "z") and not np.isfinite(array).all():
        raise InputError(f"{place}: expected finite places, got NaN or infinity in column {name!r}")
    if name == "motion" and (array < NOISE).any():
        raise InputError(f"{place}: expected motions from {NOISE} (noise) upwards, got {array.min()}")
    return np.asarray(array)


def _source(place: Path, table: pa.Table) -> np.ndarray:
    try:
        names = table.column("source").cast(pa.string())
        names.validate(full=True)  # Its words may be no UTF-8.
    except pa.ArrowException as error:
        raise InputError(f"{place}: expected column 'source' as words, but {_line(error)}") from None
    found = pc.index_in(names, value_set=pa.array(SOURCES))
    if found.null_count:
        unknown = names.filter(pc.is_null(found))[0].as_py()
        raise InputError(f"{place}: expected {', '.join(SOURCES)} in column 'source', got {unknown!r}")
    return np.asarray(found.to_numpy().astype(np.uint8))


def _line(error: Exception) -> str:
    return " ".join(str(error).split())


def _belongings(motions: Motions) -> dict[str, Any]:
    corrections = motions.making.corrections
    return {
        "settings": motions.making.settings,
        "recording_digest": motions.making.recording_digest,
        "version": motions.making.version,
        "seconds": motions.making.seconds,
        "corrections": corrections and corrections.model_dump(mode="json"),
        "representatives": [
            {
                "motion": entry.motion,
                "frame": entry.frame.tolist(),
                **{axis: entry.position[:, number].tolist() for number, axis in enumerate("xyz")},
                "observed": entry.observed.tolist(),
            }
            for entry in motions.representatives
        ],
        "links": [_stored_link(link) for link in motions.links],
        "alternatives": [_stored_link(link) for link in motions.alternatives],
        "events": [vars(event) for event in motions.events],
    }


def _stored_link(link: Link) -> dict[str, Any]:
    """The link without `chosen`, which the list that it stands in tells."""
    return {"before": link.before, "after": link.after, "confidence": link.confidence}


def _read_belongings(place: Path, metadata: dict[bytes, bytes]) -> dict[str, Any]:
    """What the schema's metadata says beside the rows; keys that are not ours are somebody else's."""
    known = _Belongings.model_fields
    source = f"{place}: the schema's metadata is damaged"
    found = {key: json_value(metadata[key.encode()], source=source) for key in known if key.encode() in metadata}
    read = validated(_Belongings, found, source=source)
    return {
        "making": Making(
            settings=read.settings,
            recording_digest=read.recording_digest,
            version=read.version,
            seconds=read.seconds,
            corrections=read.corrections,
        ),
        "representatives": tuple(entry.representative for entry in read.representatives),
        "links": tuple(Link(**link.model_dump()) for link in read.links),
        "alternatives": tuple(Link(**link.model_dump(), chosen=False) for link in read.alternatives),
        "events": tuple(Event(**event.model_dump()) for event in read.events),
    }
