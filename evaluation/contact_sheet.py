"""A recording at a glance: some frames with all that is known of them."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithm.depth_image import depth_range
from evaluation.picture import COLOURS
from recording.atomic import whole_file
from recording.errors import InputError
from recording.frame import REASONS, Frame
from recording.recording import Recording

_FRAMES_SHOWN = 6


def draw_contact_sheet(recording: Recording, path: Path, *, overwrite: bool = False) -> None:
    """Six frames spread over the recording: depth, and where they are known the objects and the reasons.

    PNG or SVG by the ending.
    """
    if path.suffix not in (".png", ".svg"):
        raise InputError(f"{path}: expected a picture that ends in .png or .svg")
    count = recording.metadata.frames
    moments = np.unique(np.linspace(0, count - 1, _FRAMES_SHOWN).round().astype(int))
    frames = [recording.frames[int(moment)] for moment in moments]
    kinds = [kind for kind in (_depth, _objects, _reasons) if any(kind(frame) is not None for frame in frames)]
    limits = {_depth: depth_range([frame.depth for frame in frames]), _objects: (0, 9), _reasons: (0, len(REASONS))}
    shape = recording.metadata.height / recording.metadata.width
    with mpl.rc_context({"font.size": 8}):
        figure = Figure(figsize=(2.6 * len(frames), (2.6 * shape + 0.25) * len(kinds)), layout="constrained")
        axes = figure.subplots(len(kinds), len(frames), squeeze=False)
        for kind, row in zip(kinds, axes, strict=True):
            for panel, frame, moment in zip(row, frames, moments, strict=True):
                low, high = limits[kind]
                image = kind(frame)
                image = np.full(frame.depth.shape, np.nan) if image is None else image
                colours = "viridis_r" if kind is _depth else mpl.colors.ListedColormap(("#FFFFFF", *COLOURS, "#999999"))
                panel.imshow(image, cmap=colours, vmin=low, vmax=high, interpolation="nearest")
                _named(panel, kind.__name__.removeprefix("_"), int(moment), recording.fps)
        with whole_file(path, overwrite=overwrite) as partial:
            figure.savefig(partial, format=path.suffix.removeprefix("."), dpi=110)


def _named(axes: Axes, kind: str, moment: int, fps: float) -> None:
    axes.set(xticks=[], yticks=[])
    axes.set_title(f"{kind}, frame {moment}, {moment / fps:.2f} s")


def _depth(frame: Frame) -> np.ndarray | None:
    return frame.depth


def _objects(frame: Frame) -> np.ndarray | None:
    """The objects' ids in the colours of the palette, by turns."""
    if frame.labels is None:
        return None
    number = frame.labels.objectid.astype(int)
    return np.where(number > 0, (number - 1) % len(COLOURS) + 1, 0)


def _reasons(frame: Frame) -> np.ndarray | None:
    return frame.reason
