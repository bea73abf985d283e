"""The dial: asked for holes of some lengths and a share that is hidden, what do the pictures of random scenes show?

For every wish a row: what was asked, and what was measured in the rendered recordings. Lengths are of all holes of all
recordings together, in frames; the hidden share is of all object-frames in view. Takes about 3 s a recording.
"""

import sys
import time
from collections.abc import Iterator
from itertools import product
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.


import numpy as np
from cyclopts import App

import unocclude
from benchmarks.tables import Row, run, show
from recording.errors import InputError
from recording.occlusion import Achieved
from simulator.family import Family, load_family
from simulator.family_scene import drawn_scene
from simulator.occlusion import By, OcclusionWish

app = App(help=__doc__)


@app.default
def dial(  # noqa: PLR0913 - A benchmark has an option for everything it varies.
    *families: str,
    frames: tuple[int, ...] = (5, 15, 40),
    shares: tuple[float, ...] = (0.15,),
    by: tuple[By, ...] = ("anything",),
    count: int = 34,
    first_seed: int = 1000,
    length: int = 100,
    size: str = "320x240",
    json: bool = False,
) -> None:
    """Print for every wish what was asked and what was achieved.

    Args:
        families: Families with wishes of their own, in place of `crowded` with the wishes of the next three.
        frames: Median lengths of a hole.
        shares: Hidden shares.
        by: Who is to hide: people, obstacles, both, anything.
        count: Recordings for each wish.
        first_seed: The first one's seed; 1 to 999 are for development, 1000 to 1999 for reporting.
        length: Frames a recording, in place of `crowded`'s.
        size: Picture size.
        json: One JSON object in place of the table.
    """
    asked = [load_family(name) for name in families] or list(_wishes(frames, shares, by, length))
    rows = [_row(family, range(first_seed, first_seed + count), size) for family in asked]
    show(f"{count} recordings a row, {size}, seeds from {first_seed}", rows, as_json=json)


def _wishes(frames: tuple[int, ...], shares: tuple[float, ...], by: tuple[By, ...], length: int) -> Iterator[Family]:
    """The family `crowded`, as long as asked, under all combinations of wishes."""
    family = load_family("crowded")
    for median, share, hider in product(frames, shares, by):
        wish = OcclusionWish(hole_frames=median, hidden_share=share, by=hider)
        yield family.model_copy(update={"occlusion": wish, "frames": (length, length)})


def _row(family: Family, seeds: range, size: str) -> Row:
    """What was asked of the family, and what its scenes of these seeds show."""
    achieved, refused, seconds = [], 0, [0.0, 0.0]
    for seed in seeds:
        begun = time.process_time()
        try:
            scene = drawn_scene(family, seed)
        except InputError:
            refused += 1
            continue
        drawn = time.process_time()
        found = unocclude.simulate(scene, size=size).metadata.occlusion
        seconds = [seconds[0] + drawn - begun, seconds[1] + time.process_time() - drawn]
        if found is not None:
            achieved.append(found.achieved)
    return _asked(family) | _found(achieved) | _times(seconds, len(achieved), refused)


def _asked(family: Family) -> Row:
    wish = family.occlusion
    return {
        "family": family.name,
        "asked": wish.hole_frames if wish else None,
        "asked share": wish.hidden_share if wish else None,
        "asked by": wish.by if wish else "-",
    }


def _found(achieved: list[Achieved]) -> Row:
    lengths = [length for each in achieved for length in each.hole_frames.lengths]
    low, median, high = np.quantile(lengths, [0.25, 0.5, 0.75]).tolist() if lengths else (None, None, None)
    hidden = sum(each.hidden_object_frames for each in achieved)
    people = sum(each.by.people * each.hidden_object_frames for each in achieved if each.by is not None)
    return {
        "holes": len(lengths),
        "quartile 1": low,
        "median": median,
        "quartile 3": high,
        "share": hidden / max(sum(each.object_frames for each in achieved), 1),
        "by people": people / hidden if hidden else None,
    }


def _times(seconds: list[float], count: int, refused: int) -> Row:
    draw, render = (each / count if count else None for each in seconds)
    return {"refused": refused, "draw s": draw, "render s": render}


if __name__ == "__main__":
    run(app)
