"""What has to hold of segmentation and completion: scene by scene, over several days, beside the target of each number.

Recordings are simulated once into a folder and kept; every method's outcome on each is kept too, as `unocclude compare`
does it, so the same call again goes on where it ended. At twice the scenes' own size a recording takes from 10 seconds
to a minute and a half to simulate, to solve and to score, on one core; the whole table some hours.
"""

import json as json_format
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

from cyclopts import App, Parameter

from benchmarks.calibrations import calibration_rows
from benchmarks.tables import Row, document, run, show
from benchmarks.targets import SCENES, TARGETS, judged, printed, scene_means, tracker_factors
from evaluation.compare import compared
from evaluation.outcome import Outcome
from recording.errors import InputError
from recording.store import load_recording
from simulator.simulate import prepared, write_simulation

app = App(help=__doc__)
Several = Parameter(consume_multiple=True, negative="")


@app.default
def motions(  # noqa: PLR0913 - a command has as many arguments as it has options
    *,
    recordings: Path = Path("reporting"),
    scenes: Annotated[tuple[str, ...], Several] = SCENES,
    seeds: Annotated[tuple[int, ...], Several] = tuple(range(1001, 1011)),
    sizes: Annotated[tuple[str, ...], Several] = ("2x", "1x"),
    methods: Annotated[tuple[str, ...], Several] = ("default", "paper", "tracker"),
    jobs: int = 1,
    simulate_only: bool = False,
    json: bool = False,
) -> None:
    """Print a table for each picture size and method, the calibration, and the error beside the tracker's.

    Args:
        recordings: Folder for the recordings (`2x/wall_1001`, ...) and the outcomes (`2x/outcomes`).
        scenes: Names of scenes.
        seeds: 1 to 20 are for development, 1001 to 1010 for reporting.
        sizes: Picture sizes, as multiples of the scenes' own: `2x`, or `1x` for the own one.
        methods: As in `unocclude compare`.
        jobs: Processes at work at the same time.
        simulate_only: Make the recordings that are missing, and nothing else.
        json: One JSON object in place of tables.
    """
    parts: list[tuple[str, list[Row]]] = []
    for size in sizes:
        places = [kept_recording(recordings / size, scene, seed, size) for scene in scenes for seed in seeds]
        if not simulate_only:
            outcomes = compared(places, recordings / size / "outcomes", methods=methods, workers=jobs)
            parts += _tables(outcomes, methods, size)
    if json:
        print(json_format.dumps({"tables": [document(title, rows) for title, rows in parts]}, allow_nan=False))
        return
    for title, rows in parts:
        show(title, [printed(row) if "missed" in row else row for row in rows], as_json=False)


def kept_recording(folder: Path, scene: str, seed: int, size: str) -> Path:
    """The recording's place in the folder, simulated unless it is there; InputError where another one is."""
    place = folder / f"{scene}_{seed}"
    simulation = prepared(scene, seed=seed, size=size)
    if not (place / "recording.json").is_file():
        write_simulation(simulation, place)
    elif load_recording(place).metadata.scene_digest != simulation.metadata.scene_digest:
        raise InputError(f"{place}: expected the scene as it is now, got one that has changed since: remove the folder")
    return place


def _tables(outcomes: Sequence[Outcome], methods: Sequence[str], size: str) -> list[tuple[str, list[Row]]]:
    """The tables of one picture size."""
    tables = []
    means: dict[str, Mapping[str, Row]] = {}
    for method in methods:
        own = [outcome for outcome in outcomes if outcome.method == method]
        means[method] = scene_means(own)
        rows = [judged(scene, row, TARGETS.get(scene)) for scene, row in means[method].items()]
        tables.append((f"{method}, {size}, {len(own)} recordings", rows))
        tables.append((f"{method}, {size}: confidences and what holds", calibration_rows(own)))
    failed = [_failure(outcome) for outcome in outcomes if outcome.failure is not None]
    if "default" in means and "tracker" in means:
        tables.append((f"hidden centres of the tracker and ours, {size}", tracker_factors(means)))
    return [*tables, *([(f"failed, {size}", failed)] if failed else [])]


def _failure(outcome: Outcome) -> dict[str, Any]:
    return {"recording": outcome.recording, "method": outcome.method, "failure": outcome.failure}


if __name__ == "__main__":
    run(app)
