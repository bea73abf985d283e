"""A solved recording in one picture, as the paper's figure 3 shows it."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithm.depth_image import DepthRange, depth_range
from evaluation.figures.panels import (
    PLAN,
    as_metres,
    draw_curve,
    draw_points,
    moments_of,
    on_plane,
)
from evaluation.figures.style import styled, write_figure
from recording.camera import Camera
from recording.drawing import as_picture, draw_dots
from recording.errors import InputError
from recording.motions import NOISE, Motions, Representative, mean_places
from recording.palette import TRUTH, colours_of
from recording.recording import Recording
from recording.visibility import visibility_of

_FRAMES_SHOWN = 5


def draw_overview(recording: Recording, motions: Motions, path: Path, *, overwrite: bool = False) -> None:
    """Frames, segments, representatives and completed motion of a recording, as PNG or SVG by the ending.

    Above: depth at five moments, with the points in the colours of their motions, the completed ones paler.
    Below: all observed points in the colours of their segments; the representatives, completed parts
    dotted, in the picture and from the camera's top, truth in grey where it is known; all points, completed ones paler.
    """
    if path.suffix not in (".png", ".svg"):
        raise InputError(f"{path}: expected a picture that ends in .png or .svg")
    with styled(letters=9.0):
        figure = Figure(figsize=(15, 6.6), layout="constrained")
        above, below = np.asarray(figure.subfigures(2, 1, height_ratios=(1, 1.25)))
        moments = moments_of(recording.metadata.frames, _FRAMES_SHOWN, margin=1 / (_FRAMES_SHOWN + 1))
        within = depth_range([recording.frames[frame].depth for frame in moments])
        for axes, frame in zip(above.subplots(1, len(moments), squeeze=False)[0], moments, strict=True):
            _draw_frame(axes, recording, motions, frame, within)
        panels = below.subplots(1, 4)
        _draw_segments(panels[0], recording.camera, motions)
        curves = motions.representatives or mean_places(motions)
        _draw_representatives(panels[1], recording.camera, curves)
        _draw_plan(panels[2], recording, curves)
        _draw_completed(panels[3], recording.camera, motions)
        write_figure(figure, path, overwrite=overwrite, dpi=110.0)


def _draw_frame(axes: Axes, recording: Recording, motions: Motions, frame: int, within: DepthRange) -> None:
    depth = recording.frames[frame].depth
    nearest, farthest = within
    extent = (0, depth.shape[1], depth.shape[0], 0)
    axes.imshow(depth, cmap="gray", extent=extent, alpha=0.7, vmin=nearest - 0.1, vmax=farthest + 0.1)
    draw_points(axes, recording.camera, motions.rows(motions.frame == frame), alphas=(0.25, 0.8), size=2.5)
    axes.set_title(f"frame {frame}, {frame / recording.fps:.2f} s")
    as_picture(axes, recording.camera)


def _draw_segments(axes: Axes, camera: Camera, motions: Motions) -> None:
    rows = np.flatnonzero(motions.observed)
    draw_dots(axes, motions.column_row[rows], colours_of(motions.segment[rows]), size=0.6, alpha=0.4)
    count = len(np.unique(motions.segment[motions.segment != NOISE]))
    axes.set_title(f"segments: {count} (noise grey)")
    as_picture(axes, camera)


def _draw_representatives(axes: Axes, camera: Camera, curves: tuple[Representative, ...]) -> None:
    for curve in curves:
        draw_curve(axes, camera.pixel_from_world(curve.position)[0], curve)
    axes.set_title(f"representatives: {len(curves)} motions (dotted: completed)")
    as_picture(axes, camera)


def _draw_plan(axes: Axes, recording: Recording, curves: tuple[Representative, ...]) -> None:
    if recording.xray is not None:
        centres = visibility_of(recording).centre
        for centre in () if centres is None else centres:
            axes.plot(*on_plane(recording, centre, PLAN).T, color=TRUTH, linewidth=4, alpha=0.6, zorder=0)
    for curve in curves:
        draw_curve(axes, on_plane(recording, curve.position, PLAN), curve)
    as_metres(axes, PLAN)
    axes.set_title("from above" + (" (grey: truth)" if recording.xray is not None else ""))


def _draw_completed(axes: Axes, camera: Camera, motions: Motions) -> None:
    draw_points(axes, camera, motions, alphas=(0.06, 0.4), size=0.6)
    axes.set_title("completed motion (pale: completed)")
    as_picture(axes, camera)
