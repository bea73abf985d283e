"""Wrong motions, settings and corrections."""

import json
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from case import Case, Damage, cut, linked, removed, replaced, written

EVALUATE = "evaluate {place}/small"
MOTIONS = "small/motions.parquet"
SET = "solve {place}/small -o {place}/out.parquet --set "
FILE = "solve {place}/small -o {place}/out.parquet --settings {place}/settings.toml"
CORRECT = "solve {place}/small -o {place}/out.parquet --corrections {place}/corrections.toml"


def tabled(change: Callable[[pa.Table], pa.Table]) -> Damage:
    """Put another table in place of the motions."""

    def damage(place: Path) -> None:
        pq.write_table(change(pq.read_table(place / MOTIONS)), place / MOTIONS)

    return damage


def column(name: str, values: Callable[[int], object]) -> Damage:
    """Put other values into a column; they are made from the number of rows."""

    def change(table: pa.Table) -> pa.Table:
        made = values(table.num_rows)
        where = table.column_names.index(name)
        return table.set_column(where, name, made if isinstance(made, pa.Array) else pa.array(made))

    return tabled(change)


def belonging(key: str, text: str) -> Damage:
    """Put other text into the schema's metadata."""
    return tabled(lambda table: table.replace_schema_metadata({**table.schema.metadata, key.encode(): text.encode()}))


def first(value: float, name: str) -> Damage:
    """Put a number into a column's first row."""
    return tabled(
        lambda table: table.set_column(
            table.column_names.index(name),
            name,
            pa.array(np.r_[value, table.column(name).to_numpy()[1:]]).cast(table.schema.field(name).type),
        )
    )


def row_bomb(place: Path) -> None:
    """A file of some kilobytes with 5 million rows."""
    names = ("frame", "trajectory", "x", "y", "z", "motion")
    rows = pa.table({name: np.zeros(10**6, np.int32) for name in names} | {"source": ["observed"] * 10**6})
    with pq.ParquetWriter(place / MOTIONS, rows.schema, compression="zstd") as writer:
        for _ in range(5):
            writer.write_table(rows)


def marked(where: str) -> Damage:
    """Add a correction by hand."""

    def damage(place: Path) -> None:
        with (place / "corrections.toml").open("a", encoding="utf-8") as file:
            file.write(f'[[correction]]\nkind = "same"\none = {{{where}, row = 1}}\n')
            file.write("other = {frame = 0, column = 1, row = 1}\n")

    return damage


def another(place: Path) -> None:
    """Motions of another recording."""
    belonging("recording_digest", json.dumps("0" * 64))(place)


def undigested(place: Path) -> None:
    belonging("recording_digest", "null")(place)


REPRESENTATIVE = {"motion": 0, "frame": [10**30], "x": [0.0], "y": [0.0], "z": [0.0], "observed": [True]}
MOTION = (
    Case(input="no file", command=EVALUATE, damage=removed(MOTIONS), says="there is no such file"),
    Case(input="zero bytes", command=EVALUATE, damage=written(MOTIONS, ""), says="expected a Parquet file"),
    Case(input="truncated", command=EVALUATE, damage=cut(MOTIONS, 0.6), says="expected a Parquet file"),
    Case(input="foreign: CSV", command=EVALUATE, damage=written(MOTIONS, "a,b\n1,2\n"), says="expected a Parquet file"),
    Case(input="5 million rows in 130 kB", command=EVALUATE, damage=row_bomb, says="rows that take hardly any room"),
    Case(
        input="a missing column",
        command=EVALUATE,
        damage=tabled(lambda table: table.drop_columns(["motion"])),
        says="missing: motion",
    ),
    Case(
        input="words for numbers",
        command=EVALUATE,
        damage=column("x", lambda rows: ["left"] * rows),
        says="expected column 'x' as float",
    ),
    Case(
        input="pickles for numbers",
        command=EVALUATE,
        damage=column("x", lambda rows: [pickle.dumps({"evil": 1})] * rows),
        says="expected column 'x' as float",
    ),
    Case(
        input="no value in a row",
        command=EVALUATE,
        damage=column("frame", lambda rows: [None] + [0] * (rows - 1)),
        says="expected a value in every row of 'frame'",
    ),
    Case(input="NaN for a place", command=EVALUATE, damage=first(np.nan, "x"), says="expected finite places"),
    Case(input="an infinite place", command=EVALUATE, damage=first(np.inf, "z"), says="expected finite places"),
    Case(input="a motion below -1", command=EVALUATE, damage=first(-2, "motion"), says="got -2"),
    Case(input="a frame below 0", command=EVALUATE, damage=first(-1, "frame"), says="frame"),
    Case(input="a frame that there is not", command=EVALUATE, damage=first(99, "frame"), says="frame"),
    Case(input="a point beside the picture", command=EVALUATE, damage=first(1e6, "column"), says="picture"),
    Case(
        input="an unknown source",
        command=EVALUATE,
        damage=column("source", lambda rows: ["guessed"] * rows),
        says="in column 'source', got 'guessed'",
    ),
    Case(
        input="metadata nested 100,000 deep",
        command=EVALUATE,
        damage=belonging("links", "[" * 100_000),
        says="the schema's metadata is damaged",
    ),
    Case(
        input="a frame of 31 digits in the metadata",
        command=EVALUATE,
        damage=belonging("representatives", json.dumps([REPRESENTATIVE])),
        says="the schema's metadata is damaged",
    ),
    Case(input="of another recording", command=EVALUATE, damage=another, says="expected motions of this recording"),
    Case(
        input="of no recording that they name",
        command=EVALUATE,
        damage=undigested,
        status=0,
        says="warning: the motions do not say which recording",
        becomes="scored, with a warning",
    ),
    Case(
        input="columns that nobody knows",
        command=EVALUATE,
        damage=tabled(lambda table: table.append_column("colour", table.column("x"))),
        status=0,
        says="motions",
        becomes="left out",
    ),
)
SETTINGS = (
    Case(input="an unknown setting", command=SET + "eps9=1", says="unknown key 'eps9'"),
    Case(input="a negative one", command=SET + "eps1=-1", says="eps1: input should be greater than 0"),
    Case(input="NaN", command=SET + "eps1=nan", says="eps1: input should be a finite number"),
    Case(input="an infinite one", command=SET + "eps1=inf", says="eps1: input should be a finite number"),
    Case(input="10^400", command=SET + "eps1=1" + "0" * 400, says="eps1: "),
    Case(input="10^5000", command=SET + "eps4=1" + "0" * 5000, says="eps4: "),
    Case(input="a word for a number", command=SET + "eps4=many", says="eps4: "),
    Case(input="a fraction for a count", command=SET + "shortest_frames=2.5", says="shortest_frames: "),
    Case(input="no value", command=SET + "eps1", says="expected KEY=VALUE"),
    Case(input="a list nested 10,000 deep", command=SET + "eps1=" + "[" * 10_000, says="eps1: "),
    Case(input="no file", command=FILE, damage=removed("settings.toml"), says="expected a readable TOML file"),
    Case(
        input="a file without an end", command=FILE, damage=linked("settings.toml", "/dev/zero"), says="more than 256"
    ),
    Case(input="a key twice", command=FILE, damage=written("settings.toml", "eps3=1\neps3=2"), says="expected TOML"),
    Case(
        input="TOML nested 100,000 deep",
        command=FILE,
        damage=written("settings.toml", "eps3=" + "[" * 100_000),
        says="expected TOML, but maximum recursion depth exceeded",
    ),
    Case(
        input="TOML tables nested 10,000 deep",
        command=FILE,
        damage=written("settings.toml", "a." * 10_000 + "b = 1"),
        says="settings.toml: ",
    ),
    Case(
        input="Latin-1", command=FILE, damage=written("settings.toml", "# gr\u00fcn".encode("latin-1")), says="no UTF-8"
    ),
    Case(input="a date for a number", command=FILE, damage=written("settings.toml", "eps3=1999-01-01"), says="eps3: "),
)
CORRECTIONS = (
    Case(
        input="of another recording",
        command=CORRECT,
        damage=written("corrections.toml", 'recording_digest = "0"'),
        says="expected those of this recording",
    ),
    Case(
        input="a later version",
        command=CORRECT,
        damage=replaced("corrections.toml", "version = 1", "version = 2"),
        says="format.version",
    ),
    Case(
        input="a frame below 0", command=CORRECT, damage=marked("frame = -1, column = 1"), says="correction.0.one.frame"
    ),
    Case(
        input="a place beside the picture",
        command=CORRECT,
        damage=marked("frame = 0, column = 1e300"),
        says="correction.0.one.column",
    ),
)
