"""The scene `wall` over several seeds: what the default preset and the paper's reach, beside the truth.

Takes about 5 seconds a seed and preset with LLVM.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.


from cyclopts import App

import unocclude
from benchmarks.tables import Row, mean_row, run, score_row, show

app = App(help=__doc__)


@app.default
def wall(*, seeds: tuple[int, ...] = (1001, 1002, 1003, 1004, 1005), size: str = "1x", json: bool = False) -> None:
    """Print the scores of every seed and their mean.

    Args:
        seeds: Seeds of the scene; 0 is the scene itself. 1 to 20 are for development, 1001 to 1010 for reporting.
        size: Picture size, such as `384x288` or `2x`.
        json: One JSON object in place of the table.
    """
    rows: list[Row] = []
    for preset in ("default", "paper"):
        settings = unocclude.preset_settings(preset)
        own: list[Row] = []
        for seed in seeds:
            recording = unocclude.simulate("wall", seed=seed, size=size)
            scores = unocclude.evaluate(recording, unocclude.solve(recording, settings))
            own.append({"preset": preset, "seed": str(seed), **score_row(scores)})
        rows += [*own, {**mean_row(own), "preset": preset, "seed": "mean"}]
    show(f"wall, size {size}", rows, as_json=json)


if __name__ == "__main__":
    run(app)
