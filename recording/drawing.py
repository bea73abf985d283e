"""What pictures are made of: a depth image, dots, lines that are dotted where nothing was seen.

It is imported when something is drawn, for matplotlib takes its time.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Float32
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap

from recording.camera import Camera
from recording.palette import DEPTH, FAINT, colour_of

MOST_DOTS = 60_000
"""Points drawn in one panel at the most."""
_GREYS = LinearSegmentedColormap.from_list("greys", ("#B4B4B4", "#EEEEEE"))
_MOST_NAMED = 10
"""With more motions than this there is no legend."""


def new_axes(*, width: float = 6.4, shape: float = 0.75) -> Axes:
    """The axes of a new figure, which a notebook shows by itself; inches, and the height as a share of the width."""
    import matplotlib.pyplot as plt  # noqa: PLC0415 - what it looks for, a display, only a new figure needs.

    return plt.subplots(figsize=(width, shape * width), layout="constrained")[1]


def draw_depth(
    axes: Axes,
    depth: Float32[np.ndarray, "row column"],
    camera: Camera,
    *,
    within: tuple[float, float],
    faint: bool = False,
) -> None:
    """A depth image with its scale in metres, white where nothing returned; in faint greys, to draw upon."""
    extent = (0, camera.width, camera.height, 0)
    colours = _GREYS if faint else colormaps[DEPTH]
    low, high = within
    image = axes.imshow(depth, cmap=colours, extent=extent, vmin=low, vmax=high, interpolation="nearest")
    axes.figure.colorbar(image, ax=axes, label="depth [m]", shrink=0.8)
    as_picture(axes, camera)


def as_picture(axes: Axes, camera: Camera) -> None:
    """Make the axes the camera's picture."""
    axes.set(xlim=(0, camera.width), ylim=(camera.height, 0), aspect="equal", xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set(visible=True, color=FAINT)


def draw_dots(axes: Axes, place: np.ndarray, colours: np.ndarray | str, *, size: float, alpha: float) -> None:
    """Points in order; of too many every so-manieth. They are pixels in an SVG too."""
    step = -(-len(place) // MOST_DOTS) or 1
    chosen = colours if isinstance(colours, str) else colours[::step]
    place = place[::step]
    axes.scatter(place[:, 0], place[:, 1], s=size, c=chosen, alpha=alpha, linewidths=0, rasterized=True)


def draw_stretches(
    axes: Axes, place: Float[np.ndarray, "moment 2"], observed: Bool[np.ndarray, "moment"], *, colour: str, width: float
) -> None:
    """A line: full where it was observed, dotted elsewhere."""
    axes.plot(*place.T, color=colour, linewidth=0.8 * width, linestyle=":")
    axes.plot(*np.where(observed[:, None], place, np.nan).T, color=colour, linewidth=width)


def draw_ways(
    axes: Axes, ways: Sequence[tuple[int, Float[np.ndarray, "moment 2"], Bool[np.ndarray, "moment"]]]
) -> None:
    """Numbered ways in metres: a dot where each begins, full where it was observed, dotted elsewhere."""
    for number, place, observed in ways:
        colour = colour_of(number)
        draw_stretches(axes, place, observed, colour=colour, width=2.0)
        label = f"motion {number}" if len(ways) <= _MOST_NAMED else None
        axes.plot(*place[0], "o", color=colour, markersize=6, label=label)
    if 0 < len(ways) <= _MOST_NAMED:
        axes.legend(frameon=False, loc="best")
    axes.set_title(f"{len(ways)} motions (each from its dot on; dotted: not seen)")
    axes.set_aspect("equal", adjustable="datalim")
    axes.spines[["top", "right"]].set_visible(False)
