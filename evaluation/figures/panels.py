"""What pictures are made of: depth, points and curves in a picture, or curves on axes in metres."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from recording.camera import Camera, transformed
from recording.drawing import draw_dots, draw_stretches
from recording.motions import NOISE, Motions, Representative
from recording.palette import colour_of, colours_of
from recording.recording import Recording

COMPLETED, OBSERVED = 0.25, 0.9
"""How opaque points are."""


def moments_of(frames: int, count: int, *, margin: float = 0.06) -> list[int]:
    """Up to so many frames spread over a recording, its ends left out."""
    share = np.linspace(margin, 1 - margin, count)
    return [int(frame) for frame in np.unique((share * (frames - 1)).round())]


def draw_places(
    axes: Axes, camera: Camera, places: np.ndarray, colours: np.ndarray, *, size: float, alpha: float
) -> None:
    """World points in a camera's picture, far ones first, so that near ones lie upon them."""
    column_row, depth = camera.pixel_from_world(places.astype(np.float64))
    order = np.argsort(-depth, kind="stable")
    draw_dots(axes, column_row[order], colours[order], size=size, alpha=alpha)


def draw_points(
    axes: Axes, camera: Camera, motions: Motions, *, alphas: tuple[float, float] = (COMPLETED, OBSERVED), size: float
) -> None:
    """The points of motions in the picture; `alphas` are those of completed and of observed ones."""
    for observed, alpha in zip((False, True), alphas, strict=True):
        rows = np.flatnonzero((motions.motion != NOISE) & (motions.observed == observed))
        draw_places(axes, camera, motions.position[rows], colours_of(motions.motion[rows]), size=size, alpha=alpha)


def draw_segments(axes: Axes, camera: Camera, motions: Motions, *, size: float, alpha: float = OBSERVED) -> None:
    """The observed points of motions in the picture, in the colours of their segments; noise faint and below."""
    for noise in (True, False):
        rows = np.flatnonzero(motions.observed & ((motions.segment == NOISE) == noise))
        draw_places(axes, camera, motions.position[rows], colours_of(motions.segment[rows]), size=size, alpha=alpha)


def draw_curve(axes: Axes, place: Float[np.ndarray, "moment 2"], curve: Representative, *, width: float = 1.5) -> None:
    """A curve: full where it was observed, dotted where it was completed."""
    draw_stretches(axes, place, curve.observed, colour=colour_of(curve.motion), width=width)


Plane = tuple[int, int]
"""Two of the axes right, down, forward of the camera."""
PLAN: Plane = (0, 2)
ELEVATION: Plane = (0, 1)
_AXES = ("right of the camera [m]", "above the camera [m]", "before the camera [m]")


def plane_of(recording: Recording, places: Sequence[Float[np.ndarray, "place 3"]]) -> Plane:
    """From above, or from the front where the places spread more upwards than forwards: balls, not walkers."""
    if not places:
        return PLAN
    spread = np.ptp(in_camera(recording, np.concatenate(places)), axis=0)
    return ELEVATION if spread[1] > spread[2] else PLAN


def on_plane(recording: Recording, place: Float[np.ndarray, "place 3"], plane: Plane) -> Float[np.ndarray, "place 2"]:
    """World points on the two axes, metres; upwards is up."""
    return in_camera(recording, place)[:, plane] * np.where(np.array(plane) == 1, -1.0, 1.0)


def in_camera(recording: Recording, place: Float[np.ndarray, "place 3"]) -> Float[np.ndarray, "place 3"]:
    """World points in the camera's axes, metres."""
    return transformed(np.linalg.inv(recording.camera.world_from_camera), place)


def as_metres(axes: Axes, plane: Plane, *, adjustable: Literal["box", "datalim"] = "datalim") -> None:
    """Label the axes of a plane; a metre is as long along both, whether the box or its limits give way."""
    axes.set(xlabel=_AXES[plane[0]], ylabel=_AXES[plane[1]])
    axes.set_aspect("equal", adjustable=adjustable)
    axes.locator_params(nbins=5)
