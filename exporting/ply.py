"""PLY, a file a frame: the points of all motions, coloured by motion.

Binary, little-endian, as the format's description by Turk (1994) has it. Points that were completed carry
`completed` = 1, and are half transparent where a viewer heeds `alpha`.
"""

from pathlib import Path

import numpy as np

from exporting.source import Moment, Source
from recording.palette import rgb_of

SUFFIX = ".ply"
_PROPERTIES = (
    ("x", "float", "<f4"),
    ("y", "float", "<f4"),
    ("z", "float", "<f4"),
    ("red", "uchar", "u1"),
    ("green", "uchar", "u1"),
    ("blue", "uchar", "u1"),
    ("alpha", "uchar", "u1"),
    ("motion", "int", "<i4"),
    ("trajectory", "int", "<i4"),
    ("completed", "uchar", "u1"),
    ("confidence", "float", "<f4"),
)
"""Name, type in PLY's words, type in NumPy's."""
_PALE = 128


def write_ply(source: Source, folder: Path) -> None:
    """Write `000000.ply` and so on into the folder: the points in each frame, world axes, metres."""
    source.needed_motions("ply")
    for frame in source.numbers("PLY"):
        moment = source.moment(frame)
        (folder / f"{frame:06d}{SUFFIX}").write_bytes(_header(source, moment) + _vertices(moment).tobytes())


def _header(source: Source, moment: Moment) -> bytes:
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment {source.name} frame {moment.frame} time {moment.frame / source.recording.fps:.6f} s",
        "comment metres, world axes; motion -1 is noise; completed 1 was not seen",
        f"element vertex {len(moment.position)}",
        *(f"property {kind} {name}" for name, kind, _ in _PROPERTIES),
        "end_header",
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _vertices(moment: Moment) -> np.ndarray:
    vertices = np.empty(len(moment.position), [(name, kind) for name, _, kind in _PROPERTIES])
    for axis, name in enumerate("xyz"):
        vertices[name] = moment.position[:, axis]
    for channel, shade in zip(("red", "green", "blue"), rgb_of(moment.motion).T, strict=True):
        vertices[channel] = shade
    vertices["alpha"] = np.where(moment.completed, _PALE, 255)
    for name in ("motion", "trajectory", "completed", "confidence"):
        vertices[name] = getattr(moment, name)
    return vertices
