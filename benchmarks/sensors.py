"""What each sensor makes of a walker under a camera on the ceiling, beside a real recording, and how fast it is.

The real one is gotpd_walk in the folder that --data or UNOCCLUDE_DATA names; without it the table has the simulated
rows alone. Frames a second, and their share of the ideal sensor's, are those of six people of the family `crowded` at
320x240, in memory, by processor time. Takes about 2 minutes.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.


import time
from itertools import pairwise
from typing import Annotated

import cv2
import matplotlib as mpl
import numpy as np
from cyclopts import App, Parameter
from matplotlib.figure import Figure

from benchmarks.generate import with_six_people
from benchmarks.tables import Row, run, show
from recording.camera import Camera
from recording.errors import InputError
from simulator.backend import find_backend
from simulator.family import load_family
from simulator.family_scene import drawn_scene
from simulator.pictures import pictures
from simulator.scene import Scene, load_scene
from simulator.sensor import PRESETS
from simulator.simulate import prepared

app = App(help=__doc__)
CEILING = Path(__file__).parent / "ceiling.toml"
KINECT_2 = 4.5 / 65535
"""Metres of one unit of gotpd_walk."""
BODY_M, FLOOR_M = 2.6, 3.1
"""What is nearer is of the walker, what is farther of the floor."""
SLOW_M = 0.2
"""A greater change from frame to frame is no noise but the walker."""
NEAR_PX = 60
"""So far around the walker is floor that feet may stand on, pixels."""
LONGEST_EDGE = 4
"""Pixels from the walker to the floor in a row, at most: what is longer is no edge."""


@app.default
def sensors(
    *,
    frames: int = 40,
    data: Annotated[Path | None, Parameter(env_var="UNOCCLUDE_DATA")] = None,
    picture: Path | None = None,
    json: bool = False,
) -> None:
    """Print the table.

    Args:
        frames: How many are simulated of the walker, and a quarter of them of the six people; of the real recording,
            twice as many.
        data: Folder with gotpd_walk.
        picture: A PNG to draw one frame of each into.
        json: One JSON object in place of the table.
    """
    shown = {}
    if data is not None:
        shown["real (Kinect 2)"] = real_depths(data / "gotpd_walk")[: 2 * frames]
    shown |= {name: depths for name, (depths, _) in simulated(load_scene(CEILING), frames).items()}
    six = drawn_scene(with_six_people(load_family("crowded")), seed=1)
    seconds = {name: spent for name, (_, spent) in simulated(six, max(frames // 4, 2)).items()}
    paces = {name: {"frames/s": 1 / spent, "of ideal's": seconds["ideal"] / spent} for name, spent in seconds.items()}
    rows = [row(name, depths) | paces.get(name, {}) for name, depths in shown.items()]
    show("a walker under the ceiling, 512x424; six people, 320x240: frames/s", rows, as_json=json)
    if picture is not None:
        draw(shown, picture)


def simulated(scene: Scene, frames: int) -> dict[str, tuple[np.ndarray, float]]:
    """Depths and seconds a frame of each sensor, all of them in turn."""
    backend = find_backend("auto")
    stages = {name: prepared(scene, frames=frames, sensor=name).stage for name in PRESETS}
    running = {name: pictures(stage, backend) for name, stage in stages.items()}
    depths: dict[str, list[np.ndarray]] = {name: [] for name in PRESETS}
    spent: dict[str, list[float]] = {name: [] for name in PRESETS}
    for _ in range(frames):
        for name, maker in running.items():
            begun = time.process_time()
            depths[name].append(next(maker)[0].depth)
            spent[name].append(time.process_time() - begun)
    return {name: (np.stack(depths[name]), float(np.median(spent[name]))) for name in PRESETS}


def real_depths(folder: Path) -> np.ndarray:
    """The real recording, metres; NaN without return."""
    if not folder.is_dir():
        raise InputError(f"{folder}: expected the folder of the real recording, got none: name the one above by --data")
    images = [cv2.imread(str(path), cv2.IMREAD_UNCHANGED) for path in sorted(folder.glob("image*.png"))]
    depths = np.stack(images).astype(np.float32) * KINECT_2
    return np.where(depths > 0, depths, np.float32(np.nan))


def row(name: str, depths: np.ndarray) -> Row:
    """The statistics of a recording; lengths in millimetres, edges in pixels."""
    there = np.isfinite(depths)
    static = there.mean(axis=0) > 0.5
    rest = np.where(static, np.nanmedian(np.where(static, depths, 0), axis=0), np.nan)
    static &= rest > FLOOR_M
    away = np.where((np.abs(depths - rest) < 0.3) & ~beside(depths < BODY_M), depths - rest, np.nan)
    wobble = np.nanmedian(away.reshape(len(away), -1), axis=1)
    still = np.diff(away - wobble[:, None, None], axis=0) / np.sqrt(2)  # What changes slowly is no noise.
    still = np.where(np.abs(still) < SLOW_M, still, np.nan)
    camera = Camera(width=512, height=424, fx=365, fy=365, cx=256, cy=212, world_from_camera=np.eye(4))
    angle = np.degrees(np.arctan(radius_px(camera) / camera.fx))
    lost, flying = edges(depths)
    return {
        "sensor": name,
        "no return %": float(100 * (1 - there.mean())),
        "wobble mm": float(1e3 * wobble.std()),
        **{
            f"sigma {low}-{low + 8} deg mm": spread(still, static & (angle > low) & (angle < low + 8))
            for low in (4, 20, 30)
        },
        "lost at an edge px": lost,
        "flying px": flying,
        "grain": grain_of(still, static & (angle < 20)),
    }


def beside(walker: np.ndarray) -> np.ndarray:
    """The pixels of each frame at the walker or up to `NEAR_PX` away, along rows and columns."""
    square = np.ones((2 * NEAR_PX + 1, 2 * NEAR_PX + 1), np.uint8)
    return np.stack([cv2.dilate(frame.astype(np.uint8), square) > 0 for frame in walker])


def radius_px(camera: Camera) -> np.ndarray:
    """Distance of each pixel from the principal point."""
    return np.hypot(np.arange(camera.width) - camera.cx, (np.arange(camera.height) - camera.cy)[:, None])


def spread(values: np.ndarray, where: np.ndarray) -> float:
    """The standard deviation over time of the pixels, millimetres."""
    return float(1e3 * np.nanstd(values[:, where]))


def grain_of(values: np.ndarray, where: np.ndarray) -> float | None:
    """Correlation of the errors of neighbours in a row; None without any error."""
    both = where[:, 1:] & where[:, :-1]
    one, other = values[:, :, 1:][:, both], values[:, :, :-1][:, both]
    known = np.isfinite(one) & np.isfinite(other)
    one, other = one[known], other[known]
    return float(np.corrcoef(one, other)[0, 1]) if one.std() > 1e-6 and other.std() > 1e-6 else None


def edges(depths: np.ndarray) -> tuple[float, float]:
    """Mean number of pixels between walker and floor in a row that are lost, and that are in between."""
    lost = flying = crossings = 0
    for depth in depths[::5, 60:-60, 60:-60]:
        kind = np.select([depth < BODY_M, depth > FLOOR_M, np.isnan(depth)], [1, 2, 3], 4)
        for line in kind:
            firm = np.flatnonzero(line <= 2)
            for begin, end in pairwise(firm):
                if line[begin] != line[end] and end - begin <= LONGEST_EDGE:
                    crossings += 1
                    lost += np.count_nonzero(line[begin + 1 : end] == 3)
                    flying += np.count_nonzero(line[begin + 1 : end] == 4)
    return lost / max(crossings, 1), flying / max(crossings, 1)


def draw(shown: dict[str, np.ndarray], path: Path) -> None:
    """One frame of each: the whole, and the walker enlarged."""
    with mpl.rc_context({"font.size": 8}):
        figure = Figure(figsize=(2.6 * len(shown), 4.6), layout="constrained")
        axes = figure.subplots(2, len(shown))
        for (name, depths), (whole, part) in zip(shown.items(), axes.T, strict=True):
            depth = depths[len(depths) // 2]
            body = np.argwhere(depth < BODY_M)
            middle = body[np.hypot(*(body - (212, 256)).T) < 200].mean(axis=0).astype(int)
            top, left = np.clip(middle - 70, 0, None)
            whole.imshow(depth, cmap="viridis_r", vmin=1.5, vmax=3.5, interpolation="nearest")
            part.imshow(depth[top : top + 140, left : left + 140], cmap="nipy_spectral", vmin=1.5, vmax=3.7)
            whole.set_title(name)
            for panel in (whole, part):
                panel.set(xticks=[], yticks=[])
        figure.savefig(path, dpi=110)


if __name__ == "__main__":
    run(app)
