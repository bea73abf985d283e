"""How all pictures look: one size of letters, one way to disk."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from recording.atomic import whole_file

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
