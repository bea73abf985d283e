"""MOTChallenge text: the places of all motions in 3D, and of the true objects where they are known.

Ten values a line as the benchmark's instructions have them (motchallenge.net/instructions, 3D MOT 2015): frame, id,
bb_left, bb_top, bb_width, bb_height, conf, x, y, z; frames, ids and pixels are counted from 1, x, y, z are world
metres.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from exporting.source import Moment, Source
from recording.camera import PIXEL_CENTRE, Camera
from recording.motions import mean_places

_NO_BOX = (-1.0, -1.0, -1.0, -1.0)
_ONE = 1
"""Frames, ids and pixels begin with it."""


def write_motchallenge(source: Source, folder: Path) -> None:
    """Write `<name>.txt` with the motions, and the sequence's folder `<name>/` with `seqinfo.ini` and `gt/gt.txt`.

    The names are those that the benchmark's kits look for. Without motions or without X-ray twins that half is missing.
    """
    if source.recording.xray is None:
        source.needed_motions("mot")
    if source.motions is not None:
        _write_lines(folder / f"{source.name}.txt", _found_lines(source))
    sequence = folder / source.name
    sequence.mkdir()
    (sequence / "seqinfo.ini").write_text(_about(source), encoding="ascii")
    if source.recording.xray is not None:
        (sequence / "gt").mkdir()
        _write_lines(sequence / "gt" / "gt.txt", _true_lines(source))


def _write_lines(path: Path, lines: Iterator[str]) -> None:
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(lines)


def _found_lines(source: Source) -> Iterator[str]:
    """A line for each motion in each frame: its place, the box round its points, and how sure these are on average.

    A place without points has no box; its confidence is 1 where it was observed, 0 where it was completed.
    """
    motions = source.needed_motions("mot")
    places: dict[int, dict[int, tuple[np.ndarray, bool]]] = {}
    for curve in motions.representatives or mean_places(motions):
        for frame, position, observed in zip(curve.frame.tolist(), curve.position, curve.observed, strict=True):
            places.setdefault(frame, {})[curve.motion] = (position, bool(observed))
    for frame in source.numbers("motions"):
        moment = source.moment(frame)
        for motion, (position, observed) in sorted(places.get(frame, {}).items()):
            own = moment.motion == motion
            box, sureness = (_NO_BOX, float(observed)) if not own.any() else _measured(source, moment, own)
            yield _line(frame, motion + _ONE, box, sureness, position)


def _measured(
    source: Source, moment: Moment, own: Bool[np.ndarray, "point"]
) -> tuple[tuple[float, float, float, float], float]:
    place, _ = source.recording.camera.pixel_from_world(moment.position[own].astype(np.float64))
    return _box(place, source.recording.camera), float(moment.confidence[own].mean())


def _true_lines(source: Source) -> Iterator[str]:
    """A line for each moving object in each frame in which it is in view, hidden or not.

    The place is the centroid of its X-ray twin's points, the one that `unocclude evaluate` measures against.
    """
    recording = source.recording
    for frame in source.numbers("truth"):
        for objectid, depth in sorted((recording.xray or ())[frame].items()):
            row, column = np.nonzero(np.isfinite(depth))
            if objectid in recording.moving_ids and len(row):
                place = np.stack([column, row], axis=-1) + PIXEL_CENTRE
                centre = recording.camera.world_from_pixel(place, depth[row, column].astype(np.float64)).mean(axis=0)
                yield _line(frame, objectid, _box(place, recording.camera), 1.0, centre)


def _box(column_row: Float[np.ndarray, "point 2"], camera: Camera) -> tuple[float, float, float, float]:
    """Left, top, width and height of the pixels that the points lie in, as far as they are in the picture."""
    inside = np.floor(column_row[camera.contains(column_row)])
    if not len(inside):
        return _NO_BOX
    left, top = inside.min(axis=0)
    width, height = inside.max(axis=0) + 1 - (left, top)
    return float(left + _ONE), float(top + _ONE), float(width), float(height)


def _line(
    frame: int,
    number: int,
    box: tuple[float, float, float, float],
    sureness: float,
    position: Float[np.ndarray, "3"],
) -> str:
    sides = ",".join(f"{side:.0f}" for side in box)
    x, y, z = position.tolist()
    return f"{frame + _ONE},{number},{sides},{sureness:.4f},{x:.6f},{y:.6f},{z:.6f}\n"


def _about(source: Source) -> str:
    about = source.recording.metadata
    lines = {
        "name": source.name,
        "imDir": "img1",
        "frameRate": f"{about.fps:g}",
        "seqLength": about.frames,
        "imWidth": about.width,
        "imHeight": about.height,
        "imExt": ".jpg",
    }
    return "[Sequence]\n" + "".join(f"{key}={value}\n" for key, value in lines.items())
