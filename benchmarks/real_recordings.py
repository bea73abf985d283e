"""Real recordings from a ceiling camera: motions against masks, hidden places against the full depth.

Reads gotpd_two, gotpd_beam and gotpd_walk from the folder that --data or UNOCCLUDE_DATA names. Takes about 3 minutes on
2 cores.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.


import tempfile
from typing import Annotated

import numpy as np
from cyclopts import App, Parameter

import unocclude
from benchmarks.tables import Row, run, score_row, show
from evaluation.picture import draw_overview
from importing.calibration import Calibration
from importing.images import depth_image
from importing.source import Wanted
from importing.write import import_recording
from recording.errors import InputError

app = App(help=__doc__)
MILLIMETRES = 0.001
KINECT_2 = 4.5 / 65535
"""Metres of one unit of gotpd_walk."""
SETS = {
    "gotpd_two": ("depth_*.png", MILLIMETRES, "id_*.png"),
    "gotpd_beam": ("depth_*.png", MILLIMETRES, "id_*.png"),
    "gotpd_walk": ("image*.png", KINECT_2, None),
}


@app.default
def real(
    *,
    data: Annotated[Path, Parameter(env_var="UNOCCLUDE_DATA")],
    pictures: Path | None = None,
    preset: str = "default",
    json: bool = False,
) -> None:
    """Print the scores of the three recordings.

    Args:
        data: Folder with the three recordings' own.
        pictures: Folder to draw each solved recording into.
        preset: Settings to solve with.
        json: One JSON object in place of the table.
    """
    rows: list[Row] = []
    for name in SETS:
        recording = recorded(data / name)
        motions = unocclude.solve(recording, unocclude.preset_settings(preset))
        rows.append({"recording": name, **score_row(unocclude.evaluate(recording, motions))})
        if pictures is not None:
            draw_overview(recording, motions, pictures / f"{name}.png", overwrite=True)
    show("real recordings", rows, as_json=json)


def recorded(source: Path) -> unocclude.Recording:
    """One of the recordings; the walkers' full depth, where there is any, is its X-ray."""
    if not source.is_dir():
        raise InputError(f"{source}: expected the folder of a real recording, got none: name the one above by --data")
    pattern, scale, masks = SETS[source.name]
    calibration = Calibration(fx=365, fy=365, cx=256, cy=212, fps=30, scale=scale)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / source.name
        import_recording(source, place, wanted=Wanted(known=calibration, pattern=pattern, masks=masks))
        stored = unocclude.load_recording(place)
        frames = tuple(stored.frames)
    walkers = [sorted(source.glob(f"full{number}_*.png")) for number in (1, 2)]
    xray = tuple(
        {number + 1: depth_image(path, scale=MILLIMETRES).astype(np.float32) for number, path in enumerate(paths)}
        for paths in zip(*walkers, strict=True)
    )
    return unocclude.Recording(metadata=stored.metadata, frames=frames, xray=xray or None)


if __name__ == "__main__":
    run(app)
