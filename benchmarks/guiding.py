"""How much corrections by hand gain: a user who knows the truth mends the worst mistake first, until none is left.

A row a correction: what was said, the scores after it, and the seconds that the solve took, the stages up to the
segments from the cache. Perfect is a solution in which every object is found and no link is wrong. A recording of 9men
at twice its size takes half a minute for its first solve on one core, and five seconds a correction.
"""

import json as json_format
import sys
import tempfile
from pathlib import Path
from typing import Annotated, Any

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

from cyclopts import App, Parameter

from benchmarks.tables import Row, document, run, show
from evaluation.guiding import Guided, guided
from recording.cache import Cache
from recording.store import load_recording

app = App(help=__doc__)


@app.default
def guiding(
    *recordings: Annotated[Path, Parameter(negative="")],
    most: int = 20,
    cache: Path | None = None,
    json: bool = False,
) -> None:
    """Print a table of the corrections, and one of how many it took.

    Args:
        recordings: Folders of simulated recordings.
        most: Corrections to make at the most.
        cache: Folder for the results of stages; one of its own, which is removed again, by default.
        json: One JSON object in place of tables.
    """
    steps: list[Row] = []
    totals: list[Row] = []
    with tempfile.TemporaryDirectory() as own:
        for place in recordings:
            course = list(guided(load_recording(place), cache=Cache(folder=cache or Path(own)), most=most))
            steps += [_row(place.name, before, after) for before, after in zip([None, *course], course, strict=False)]
            totals.append(_total(place.name, course))
    parts = [("corrections", steps), ("until nothing is left", totals)]
    if json:
        print(json_format.dumps({"tables": [document(title, rows) for title, rows in parts]}, allow_nan=False))
        return
    for title, rows in parts:
        show(title, rows, as_json=False)


def _row(name: str, before: Guided | None, after: Guided) -> Row:
    """A correction, and the scores after it."""
    said = after.corrections.correction[-1] if before else None
    return {
        "recording": name,
        "said": f"{said.kind} {said.one.segment} {said.other.segment}" if said else "nothing",
        "found": f"{after.scores['motions']['found']} of {after.scores['objects']}",
        "IDF1": after.scores["identity"]["idf1"],
        "gained": _idf1(after) - _idf1(before) if before else None,
        "links right": after.scores["links"]["precision"],
        "holes bridged": after.scores["links"]["recall"],
        "centre cm": _centimetres(after),
        "mistakes left": len(after.mistakes),
        "seconds": after.seconds,
    }


def _total(name: str, course: list[Guided]) -> dict[str, Any]:
    """How many corrections a recording took."""
    perfect = [number for number, state in enumerate(course) if state.perfect]
    return {
        "recording": name,
        "IDF1 before": _idf1(course[0]),
        "IDF1 after": _idf1(course[-1]),
        "centre cm before": _centimetres(course[0]),
        "centre cm after": _centimetres(course[-1]),
        "until perfect": perfect[0] if perfect else None,
        "until nothing is left": len(course) - 1,
        "mistakes left": len(course[-1].mistakes),
    }


def _idf1(state: Guided) -> float:
    return float(state.scores["identity"]["idf1"])


def _centimetres(state: Guided) -> float | None:
    metres = state.scores["completion"]["centre_mean_m"]
    return None if metres is None else 100.0 * float(metres)


if __name__ == "__main__":
    run(app)
