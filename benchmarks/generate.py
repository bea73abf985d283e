"""How many frames a second `generate` makes, beside the bare simulator.

The bare simulator casts the same scenes, which were drawn and posed beforehand and take no time, and writes the same
files; it measures and lists nothing. Both have as many processes, make a few recordings in turn, and pay for starting
their processes each time. Takes about ten minutes; `--count 20` a fifth of that.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # For the packages beside this folder.


import tempfile
import time

from cyclopts import App

from benchmarks.bare import Bare
from benchmarks.tables import Row, run, show
from recording.workers import reported
from simulator.backend import Backend, BackendWish, find_backend
from simulator.family import Family, load_family
from simulator.generate import generate
from simulator.order import Order

app = App(help=__doc__)
SIZE = "320x240"
IN_TURN = 10
"""Recordings that one makes before it is the other's turn."""
TARGET = 0.5
"""Share of the bare simulator's frames a second that is enough."""


@app.default
def main(
    *,
    count: int = 100,
    family: str = "crowded",
    workers: int = 2,
    backend: BackendWish = "auto",
    json: bool = False,
) -> None:
    """Print frames a second of both, and their ratio, of recordings of 60 frames at 320x240 with six people.

    Args:
        count: Recordings.
        family: Name of a family, or path of its TOML file; all but people's number and the length is the family's.
        workers: Processes.
        backend: Ray caster: compiled (`llvm`), interpreted (`scalar`), or what works here.
        json: One JSON object in place of the table.
    """
    drawn, chosen = with_six_people(load_family(family)), find_backend(backend)
    seconds, frames, refused = {"generate": 0.0, "bare simulator": 0.0}, 0, 0
    for first in range(1, count + 1, IN_TURN):
        seeds = range(first, min(first + IN_TURN, count + 1))
        with tempfile.TemporaryDirectory() as folder:
            order = Order(family=drawn, folder=Path(folder) / "generated", size=SIZE)
            done = generate(order, seeds=seeds, workers=workers, backend=backend)
            seconds["generate"] += done.seconds
            seconds["bare simulator"] += bare_seconds(order, [one.seed for one in done.recordings], workers, chosen)
        frames, refused = frames + done.frames, refused + len(done.refused)
    rows: list[Row] = [
        {"what": name, "frames": frames, "frames/s": frames / spent, "share": seconds["bare simulator"] / spent}
        for name, spent in seconds.items()
    ]
    title = f"{count - refused} recordings of 60 frames of six people at {SIZE}, {workers} processes"
    show(f"{title}, {refused} seeds refused; wanted: a share of {TARGET} at least", rows, as_json=json)


def with_six_people(family: Family) -> Family:
    """The family with recordings of six people and 60 frames."""
    people = family.people.model_copy(update={"count": (6, 6)})
    return family.model_copy(update={"people": people, "frames": (60, 60)})


def bare_seconds(order: Order, seeds: list[int], workers: int, backend: Backend) -> float:
    """How long it takes to cast and write the scenes of the seeds, which are made ready before."""
    ready = [order.simulation(seed) for seed in seeds]
    folder, count = order.folder.with_name("bare"), min(workers, len(ready))
    parts = [Bare(simulations=ready[first::count], folder=folder, backend=backend) for first in range(count)]
    begun = time.perf_counter()
    for _ in reported(parts, at_once=workers):
        pass
    return time.perf_counter() - begun


if __name__ == "__main__":
    run(app)
