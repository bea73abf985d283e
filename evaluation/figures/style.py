"""How all pictures look: one palette, one size of letters, one way to disk."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
import numpy as np
from jaxtyping import Int
from matplotlib.figure import Figure

from recording.atomic import whole_file
from recording.motions import NOISE

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000")
"""Okabe and Ito's palette, which colour-blind people can tell apart."""
FAINT = "#BBBBBB"
"""What belongs to nothing, or stands behind."""
TRUTH = "#999999"
DEPTH = "viridis_r"
"""Colours of depth: near is dark."""
COLUMN_INCHES, PAGE_INCHES = 3.4, 7.0
"""Widths of figures as they are printed, in one column or across the page."""
KINDS = ("png", "svg")
_DOTS_PER_INCH = {"png": 300, "svg": 200}
"""In an SVG that of what is drawn as pixels inside it: points in great number, depth images."""


@contextmanager
def styled(*, letters: float = 7.0) -> Iterator[None]:
    """Within this block figures are made and written in the house style; `letters` in points."""
    with mpl.rc_context(
        {
            "font.size": letters,
            "axes.titlesize": letters,
            "axes.titlelocation": "left",
            "axes.linewidth": 0.6,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "legend.frameon": False,
            "svg.hashsalt": "unocclude",
        }
    ):
        yield


def write_figure(figure: Figure, path: Path, *, overwrite: bool = False, dpi: float | None = None) -> None:
    """Write the figure, PNG or SVG by the ending, whole or not at all; the same figure gives the same bytes."""
    kind = path.suffix.removeprefix(".")
    with whole_file(path, overwrite=overwrite) as partial:
        metadata = {"Date": None} if kind == "svg" else None
        figure.savefig(partial, format=kind, dpi=dpi or _DOTS_PER_INCH[kind], metadata=metadata)


def colours_of(number: Int[np.ndarray, "number"]) -> np.ndarray:
    """The colours of motions or segments, by turns; noise is faint."""
    palette = np.array([*COLOURS, FAINT])
    return palette[np.where(number == NOISE, len(COLOURS), number % len(COLOURS))]


def colour_of(number: int) -> str:
    """The colour of one motion or segment."""
    return str(colours_of(np.array([number]))[0])
