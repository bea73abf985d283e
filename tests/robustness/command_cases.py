"""Wrong arguments."""

from case import Case

COMMANDS = (
    Case(input="no such command", command="frob", says="frob"),
    Case(input="no such option", command="solve {place}/small --presett paper", says="--presett"),
    Case(input="no such preset", command="solve {place}/small --preset best", says="best"),
    Case(input="a word for a number", command="simulate wall -o {place}/out --seed one", says="one"),
    Case(input="no workers", command="simulate wall -o {place}/out --workers 0", says="--workers"),
    Case(input="no size", command="simulate wall -o {place}/out --size big", says="got 'big'"),
    Case(input="no frames", command="simulate wall -o {place}/out --frames 0", says="frames"),
    Case(input="a recording for motions", command="evaluate {place}/small {place}/small", says="no such file"),
    Case(input="motions that exist", command="solve {place}/small", says="pass --overwrite to replace it"),
    Case(input="a folder for the motions", command="solve {place}/small -o {place}/set --overwrite", says="cannot be"),
    Case(input="a file for a folder", command="solve {place}/small -o {place}/tiny.toml/x", says="cannot be written"),
    Case(input="a forbidden place", command="solve {place}/small -o /proc/x.parquet", says="cannot be written"),
    Case(
        input="a recording into itself", command="resense {place}/small --sensor tof -o {place}/small/x", says="another"
    ),
    Case(input="no such sensor", command="resense {place}/small --sensor lidar -o {place}/out", says="lidar"),
)
