"""How values show themselves in a notebook: tables and depth images as HTML, all text escaped."""

import base64
from collections.abc import Iterable, Sequence

import cv2
import numpy as np
from jaxtyping import Float32
from markupsafe import Markup

from recording.palette import DEPTH, FAINT

_WIDTH_PX = 320
_STOPS = 9
_NOTE = "font-size:0.9em"


def facts(rows: Iterable[tuple[str, object]]) -> Markup:
    """A table of names and what is to be said of each."""
    lines = (Markup('<tr><th style="text-align:left">{}</th>{}</tr>').format(name, _cell(what)) for name, what in rows)
    return Markup("<table>{}</table>").format(Markup().join(lines))


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> Markup:
    """A table with a head, a row each of the values."""
    names = Markup().join(Markup('<th style="text-align:left">{}</th>').format(name) for name in head)
    lines = (Markup("<tr>{}</tr>").format(Markup().join(map(_cell, row))) for row in rows)
    return Markup("<table><thead><tr>{}</tr></thead><tbody>{}</tbody></table>").format(names, Markup().join(lines))


def _cell(value: object) -> Markup:
    return Markup('<td style="text-align:left">{}</td>').format(value)


def note(text: str) -> Markup:
    """A line in small letters."""
    return Markup('<div style="{}">{}</div>').format(_NOTE, text)


def folded(title: str, content: Markup) -> Markup:
    """What is shown when its title is clicked."""
    return Markup("<details><summary>{}</summary>{}</details>").format(title, content)


def beside(left: Markup, right: Markup) -> Markup:
    """Two things in a row, or one below the other where there is no room."""
    return Markup('<div style="display:flex;flex-wrap:wrap;gap:1.5em;align-items:center">{}{}</div>').format(
        left, right
    )


def chip(colour: str) -> Markup:
    """A small square of a colour."""
    style = f"display:inline-block;width:0.9em;height:0.9em;vertical-align:-0.1em;background:{colour}"
    return Markup('<span style="{}"></span>').format(style)


def depth_thumbnail(depth: Float32[np.ndarray, "row column"], title: str) -> Markup:
    """A small depth image with its scale in metres; what has no return is grey."""
    step = -(-depth.shape[1] // (2 * _WIDTH_PX))
    small = depth[::step, ::step]
    present = small[np.isfinite(small)]
    low, high = (float(present.min()), float(present.max())) if present.size else (0.0, 0.0)
    style = f"width:{_WIDTH_PX}px;image-rendering:pixelated"
    image = Markup('<img style="{}" alt="depth image" src="data:image/png;base64,{}">').format(
        style, _png(_coloured(small, low, high))
    )
    return Markup("<div>{}{}</div>").format(image, _scale(low, high, title))


def _scale(low: float, high: float, title: str) -> Markup:
    """What the colours of a depth image mean."""
    shares = np.linspace(0.0, 1.0, _STOPS, dtype=np.float32)
    stops = ",".join(f"rgb({red},{green},{blue})" for red, green, blue in _coloured(shares[None], 0.0, 1.0)[0].tolist())
    bar = f"display:inline-block;width:6em;height:0.8em;background:linear-gradient(to right,{stops})"
    return Markup('<div style="{}">{}, depth {:.1f} <span style="{}"></span> {:.1f} m</div>').format(
        _NOTE, title, low, bar, high
    )


def _coloured(depth: np.ndarray, low: float, high: float) -> np.ndarray:
    """Red, green and blue of each depth, 0 to 255."""
    from matplotlib import colormaps  # noqa: PLC0415 - it is slow to import, and few recordings are looked at.

    share = (depth - low) / max(high - low, 1e-9)
    colours = colormaps[DEPTH].with_extremes(bad=FAINT)(np.ma.masked_invalid(share))
    return np.round(255 * colours[..., :3]).astype(np.uint8)


def _png(colours: np.ndarray) -> str:
    """The picture as a PNG, as text."""
    return base64.b64encode(cv2.imencode(".png", colours[..., ::-1])[1].tobytes()).decode()
