"""Figures as pictures of a page: data inside it, small enough to send."""

import io
from base64 import b64encode
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from matplotlib.figure import Figure

from evaluation.figures.style import styled
from evaluation.report.page import Picture

_DOTS_PER_INCH = 150.0
_QUALITY = 82
"""Of WebP, 0 to 100: dots and letters stay sharp."""
LETTERS = 9.0
"""Points; pages are read from afar too."""
_KINDS = {".png": "image/png", ".svg": "image/svg+xml", ".webp": "image/webp"}


def drawn(
    draw: Callable[[], Figure],
    *,
    alt: str,
    caption: str = "",
    kind: Literal["webp", "svg"] = "webp",
    letters: float = LETTERS,
) -> Picture:
    """The picture of a figure that is drawn in the house style: WebP of what has many points, SVG of curves."""
    content = io.BytesIO()
    with styled(letters=letters):
        figure = draw()
        if kind == "svg":
            figure.savefig(content, format="svg", metadata={"Date": None})
        else:
            figure.savefig(content, format="webp", dpi=_DOTS_PER_INCH, pil_kwargs={"quality": _QUALITY, "method": 4})
    return Picture(source=_data_uri(content.getvalue(), _KINDS[f".{kind}"]), alt=alt, caption=caption)


def stored(path: Path, *, alt: str, caption: str = "") -> Picture:
    """The picture that a file holds."""
    return Picture(source=_data_uri(path.read_bytes(), _KINDS[path.suffix]), alt=alt, caption=caption)


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{b64encode(content).decode('ascii')}"
