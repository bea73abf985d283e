"""A solved recording in one picture, as the paper's figure 3 shows it."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithm.depth_image import DepthRange, depth_range
from recording.atomic import whole_file
from recording.camera import Camera, transformed
from recording.errors import InputError
from recording.motions import NOISE, Motions, Representative, mean_places
from recording.recording import Recording
from recording.visibility import visibility_of

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000")
"""Okabe and Ito's palette, which colour-blind people can tell apart."""
_NOISE_COLOUR = "#BBBBBB"
_FRAMES_SHOWN = 5
_DOTS = 60_000
"""Points drawn in one panel at the most."""


def draw_overview(recording: Recording, motions: Motions, path: Path, *, overwrite: bool = False) -> None:
    """Frames, segments, representatives and completed motion of a recording, as PNG or SVG by the ending.

    Above: depth at five moments, with the points in the colours of their motions, the completed ones paler.
    Below: all observed points in the colours of their segments; the representatives, completed parts
    dotted, in the picture and from the camera's top, truth in grey where it is known; all points, completed ones paler.
    """
    if path.suffix not in (".png", ".svg"):
        raise InputError(f"{path}: expected a picture that ends in .png or .svg")
    with mpl.rc_context({"font.size": 9, "svg.hashsalt": "unocclude"}):
        figure = Figure(figsize=(15, 6.6), layout="constrained")
        above, below = np.asarray(figure.subfigures(2, 1, height_ratios=(1, 1.25)))
        moments = np.unique(np.linspace(0, recording.metadata.frames - 1, _FRAMES_SHOWN + 2).round().astype(int)[1:-1])
        within = depth_range([recording.frames[int(frame)].depth for frame in moments])
        for axes, frame in zip(above.subplots(1, len(moments), squeeze=False)[0], moments, strict=True):
            _draw_frame(axes, recording, motions, int(frame), within)
        panels = below.subplots(1, 4)
        _draw_segments(panels[0], recording.camera, motions)
        curves = motions.representatives or mean_places(motions)
        _draw_representatives(panels[1], recording.camera, curves)
        _draw_plan(panels[2], recording, curves)
        _draw_completed(panels[3], recording.camera, motions)
        kind = path.suffix.removeprefix(".")
        with whole_file(path, overwrite=overwrite) as partial:
            figure.savefig(partial, format=kind, dpi=110, metadata={"Date": None} if kind == "svg" else None)


def _draw_frame(axes: Axes, recording: Recording, motions: Motions, frame: int, within: DepthRange) -> None:
    depth = recording.frames[frame].depth
    nearest, farthest = within
    extent = (0, depth.shape[1], depth.shape[0], 0)
    axes.imshow(depth, cmap="gray", extent=extent, alpha=0.7, vmin=nearest - 0.1, vmax=farthest + 0.1)
    _draw_points(axes, recording.camera, motions.rows(motions.frame == frame), alphas=(0.25, 0.8), size=2.5)
    axes.set_title(f"frame {frame}, {frame / recording.fps:.2f} s")
    _as_picture(axes, recording.camera)


def _draw_segments(axes: Axes, camera: Camera, motions: Motions) -> None:
    rows = np.flatnonzero(motions.observed)
    _dots(axes, motions.column_row[rows], _colours(motions.segment[rows]), size=0.6, alpha=0.4)
    count = len(np.unique(motions.segment[motions.segment != NOISE]))
    axes.set_title(f"segments: {count} (noise grey)")
    _as_picture(axes, camera)


def _draw_representatives(axes: Axes, camera: Camera, curves: tuple[Representative, ...]) -> None:
    for curve in curves:
        column_row, _ = camera.pixel_from_world(curve.position)
        _draw_curve(axes, column_row, curve)
    axes.set_title(f"representatives: {len(curves)} motions (dotted: completed)")
    _as_picture(axes, camera)


def _draw_plan(axes: Axes, recording: Recording, curves: tuple[Representative, ...]) -> None:
    camera_from_world = np.linalg.inv(recording.camera.world_from_camera)
    if recording.xray is not None:
        centres = visibility_of(recording).centre
        for centre in () if centres is None else centres:
            place = transformed(camera_from_world, centre)
            axes.plot(place[:, 0], place[:, 2], color="#999999", linewidth=4, alpha=0.6, zorder=0)
    for curve in curves:
        place = transformed(camera_from_world, curve.position)
        _draw_curve(axes, place[:, [0, 2]], curve)
    axes.set_title("right and forward" + (" (grey: truth)" if recording.xray is not None else ""))
    axes.set_xlabel("right of the camera [m]")
    axes.set_ylabel("before the camera [m]")
    axes.set_aspect("equal", adjustable="datalim")


def _draw_completed(axes: Axes, camera: Camera, motions: Motions) -> None:
    _draw_points(axes, camera, motions, alphas=(0.06, 0.4), size=0.6)
    axes.set_title("completed motion (pale: completed)")
    _as_picture(axes, camera)


def _draw_points(axes: Axes, camera: Camera, motions: Motions, *, alphas: tuple[float, float], size: float) -> None:
    """The points of motions; `alphas` are those of completed and of observed ones."""
    for observed, alpha in zip((False, True), alphas, strict=True):
        rows = np.flatnonzero((motions.motion != NOISE) & (motions.observed == observed))
        column_row, _ = camera.pixel_from_world(motions.position[rows].astype(np.float64))
        _dots(axes, column_row, _colours(motions.motion[rows]), size=size, alpha=alpha)


def _draw_curve(axes: Axes, place: np.ndarray, curve: Representative) -> None:
    """A curve: full where it was observed, dotted where it was completed."""
    colour = COLOURS[curve.motion % len(COLOURS)]
    axes.plot(*place.T, color=colour, linewidth=1.5, linestyle=":")
    axes.plot(*np.where(curve.observed[:, None], place, np.nan).T, color=colour, linewidth=2)


def _dots(axes: Axes, place: np.ndarray, colours: np.ndarray, *, size: float, alpha: float) -> None:
    step = -(-len(place) // _DOTS) or 1
    axes.scatter(place[::step, 0], place[::step, 1], s=size, c=colours[::step], alpha=alpha, linewidths=0)


def _colours(number: np.ndarray) -> np.ndarray:
    palette = np.array([*COLOURS, _NOISE_COLOUR])
    return palette[np.where(number == NOISE, len(COLOURS), number % len(COLOURS))]


def _as_picture(axes: Axes, camera: Camera) -> None:
    axes.set(xlim=(0, camera.width), ylim=(camera.height, 0), aspect="equal", xticks=[], yticks=[])
