"""The colours of points: by motion, segment, error or depth, in the project's palette."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8
from matplotlib import colormaps

from recording.palette import COLOURS, DEPTH, FAINT, TRUTH, rgb, rgb_of
from viewer.answer import Answer
from viewer.clouds import Cloud

Colouring = Literal["motion", "segment", "error", "depth"]
COLOURINGS: tuple[Colouring, ...] = get_args(Colouring)
LARGEST_ERROR_M = 0.5
"""Errors of this and more have the last colour."""
ERROR = "cividis"
"""Colours of errors: small ones are dark."""
MARK_COLOURS = COLOURS[:2]
"""Of the first and of the second marked segment."""
_PALE = 0.75
"""How far what is not picked goes towards white."""


@dataclass(frozen=True, kw_only=True)
class Shades:
    """What decides on the colours of points."""

    colouring: Colouring
    depth_m: tuple[float, float]
    """The nearest and the farthest depth that differ in colour."""
    picked: int | None = None
    """The motion that keeps its colours while all others pale; None = all keep theirs."""
    marked: tuple[int | None, ...] = ()
    """The first and the second segment that stand out, while all others pale; None = not marked yet."""


def scaled(value: Float[np.ndarray, "point"], low: float, high: float, scale: str) -> UInt8[np.ndarray, "point 3"]:
    """The colours of numbers between two bounds; NaN is faint."""
    table = (255 * colormaps[scale](np.arange(256))[:, :3]).round().astype(np.uint8)
    table = np.concatenate([table, rgb(FAINT)[None]])
    share = np.clip((value - low) / max(high - low, 1e-9), 0.0, 1.0)
    return table[np.where(np.isfinite(share), np.nan_to_num(share) * 255, 256).astype(np.intp)]


def pale(colours: UInt8[np.ndarray, "point 3"], where: Bool[np.ndarray, "point"]) -> UInt8[np.ndarray, "point 3"]:
    """The colours, some of them made pale."""
    light = (colours + _PALE * (255.0 - colours)).astype(np.uint8)
    return np.where(where[:, None], light, colours)


def bare_colours(cloud: Cloud, shades: Shades, *, truth: bool) -> UInt8[np.ndarray, "point 3"]:
    """The colours of points that belong to no motion: by depth, else as the truth's or faint."""
    if shades.colouring == "depth":
        return scaled(cloud.depth_m, *shades.depth_m, DEPTH)
    return np.tile(rgb(TRUTH if truth else FAINT), (len(cloud.points), 1))


def motion_colours(cloud: Cloud, answer: Answer, shades: Shades) -> UInt8[np.ndarray, "point 3"]:
    """The colours of points of motions; in errors what has none that is known is faint."""
    if cloud.row is None:
        raise ValueError("expected a cloud of rows of motions")
    motions, row = answer.motions, cloud.row
    if shades.colouring == "depth":
        colours = scaled(cloud.depth_m, *shades.depth_m, DEPTH)
    elif shades.colouring == "error":
        known = answer.judgement.error_m[row] if answer.judgement else np.full(len(row), np.nan, np.float32)
        colours = scaled(known, 0.0, LARGEST_ERROR_M, ERROR)
    else:
        colours = rgb_of(motions.motion[row] if shades.colouring == "motion" else motions.segment[row])
    if any(segment is not None for segment in shades.marked):
        return _marked_colours(colours, motions.segment[row], shades.marked)
    return colours if shades.picked is None else pale(colours, motions.motion[row] != shades.picked)


def _marked_colours(
    colours: UInt8[np.ndarray, "point 3"], segment: Int[np.ndarray, "point"], marked: tuple[int | None, ...]
) -> UInt8[np.ndarray, "point 3"]:
    shown = pale(colours, np.ones(len(colours), bool))
    for number, colour in reversed(list(zip(marked, MARK_COLOURS, strict=False))):  # Of one segment the first counts.
        if number is not None:
            shown[segment == number] = rgb(colour)
    return shown


def legend(shades: Shades) -> str:
    """What the colours mean, as HTML."""
    if shades.colouring in ("motion", "segment"):
        chips = "".join(f'<span style="background:{colour};{_CHIP}"></span>' for colour in COLOURS)
        return f'<div style="{_LEGEND}">{chips} by turns; <span style="background:{FAINT};{_CHIP}"></span> noise</div>'
    scale, low, high = (DEPTH, *shades.depth_m) if shades.colouring == "depth" else (ERROR, 0.0, 100 * LARGEST_ERROR_M)
    unit, digits, more = ("m", 1, "") if shades.colouring == "depth" else ("cm", 0, " and more; faint: not hidden")
    stops = ",".join(
        "rgb({},{},{})".format(*colour) for colour in scaled(np.linspace(0, 1, 9), 0.0, 1.0, scale).tolist()
    )
    bar = f'<span style="background:linear-gradient(to right,{stops});{_BAR}"></span>'
    return f'<div style="{_LEGEND}">{low:.{digits}f} {bar} {high:.{digits}f} {unit}{more}</div>'


_LEGEND = "font-size:0.8em;padding:0 0.9em 0.3em"
_CHIP = "display:inline-block;width:0.9em;height:0.9em;margin-right:2px;vertical-align:middle"
_BAR = "display:inline-block;width:8em;height:0.8em;vertical-align:middle"
