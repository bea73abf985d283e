"""A recording at a glance: some frames with all that is known of them."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from algorithm.depth_image import depth_range
from evaluation.figures.style import write_figure
from recording.errors import InputError
from recording.frame import REASONS, Frame, Reason
from recording.over_time import spread_numbers
from recording.palette import COLOURS
from recording.recording import Recording

_FRAMES_SHOWN = 6
_REASON_COLOURS = {
    Reason.RETURN: "#FFFFFF",
    Reason.NOTHING_THERE: "#DDDDDD",
    Reason.OUT_OF_RANGE: "#AAAAAA",
    Reason.SHADOW: "#222222",
    Reason.EDGE: "#0072B2",
    Reason.GRAZING: "#E69F00",
    Reason.NO_SIGNAL: "#CC79A7",
    Reason.MIXED: "#D55E00",
}


def draw_contact_sheet(recording: Recording, path: Path, *, overwrite: bool = False) -> None:
    """Six frames spread over the recording: depth, and where they are known the objects and the reasons.

    PNG or SVG by the ending.
    """
    if path.suffix not in (".png", ".svg"):
        raise InputError(f"{path}: expected a picture that ends in .png or .svg")
    count = recording.metadata.frames
    moments = spread_numbers(count, _FRAMES_SHOWN)
    frames = [recording.frames[moment] for moment in moments]
    kinds = [kind for kind in (_depth, _objects, _reasons) if any(kind(frame) is not None for frame in frames)]
    low, high = depth_range([frame.depth for frame in frames])
    paints = {
        _depth: {"cmap": "viridis_r", "vmin": low, "vmax": high},
        _objects: {"cmap": ListedColormap(("#FFFFFF", *COLOURS)), "vmin": 0, "vmax": len(COLOURS)},
        _reasons: {"cmap": ListedColormap(tuple(_REASON_COLOURS.values())), "vmin": 0, "vmax": max(REASONS)},
    }
    shape = recording.metadata.height / recording.metadata.width
    with mpl.rc_context({"font.size": 8}):
        figure = Figure(figsize=(2.6 * len(frames), (2.6 * shape + 0.25) * len(kinds)), layout="constrained")
        axes = figure.subplots(len(kinds), len(frames), squeeze=False)
        for kind, row in zip(kinds, axes, strict=True):
            for panel, frame, moment in zip(row, frames, moments, strict=True):
                image = kind(frame)
                image = np.full(frame.depth.shape, np.nan) if image is None else image
                panel.imshow(image, **paints[kind], interpolation="nearest")
                _named(panel, kind.__name__.removeprefix("_"), int(moment), recording.fps)
        if _reasons in kinds:
            figure.legend(handles=_legend(frames), loc="outside lower center", ncols=len(REASONS), frameon=False)
        write_figure(figure, path, overwrite=overwrite, dpi=110.0)


def _legend(frames: Sequence[Frame]) -> list[Patch]:
    """The reasons that the frames give, with the share of the pixels that each has."""
    given = np.concatenate([frame.reason.ravel() for frame in frames if frame.reason is not None])
    count = np.bincount(given, minlength=len(REASONS))
    return [
        Patch(facecolor=_REASON_COLOURS[reason], edgecolor="#000000", label=f"{REASONS[reason]} {_percent(share)}")
        for reason, share in zip(Reason, count / len(given), strict=False)
        if share > 0
    ]


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


def _percent(share: float) -> str:
    """A share of the pixels; what is there is never shown as nothing."""
    return "under 0.1%" if 0 < share < 0.0005 else f"{share:.1%}"
