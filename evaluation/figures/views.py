"""Where a figure looks from: the sensor's own place, or one above and behind it that parts who stands in line."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from recording.camera import Camera, looking_at
from recording.palette import FAINT
from recording.recording import Recording

_ELEVATION = np.radians(30.0)
_DISTANCES = 2.0
"""Extents of what is shown between it and the raised camera."""
_FOCAL_PX = 1000.0
_RIM = 0.03


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A camera to draw through, and the part of its picture that is shown."""

    camera: Camera
    left: float
    right: float
    top: float
    bottom: float
    ground: Float[np.ndarray, "line 2 2"]
    """Lines on the ground, a metre apart, in the picture; none where the sensor's own picture is shown."""

    @property
    def shape(self) -> float:
        """Its height as a share of its width."""
        return (self.bottom - self.top) / (self.right - self.left)

    def picture(self, places: Float[np.ndarray, "*shape 3"]) -> Float[np.ndarray, "*shape 2"]:
        """Where world points are drawn."""
        return self.camera.pixel_from_world(places)[0]

    def frame(self, axes: Axes) -> None:
        """Make the axes this view's picture."""
        axes.add_collection(LineCollection(list(self.ground), colors=FAINT, linewidths=0.3, zorder=0))
        axes.set(xlim=(self.left, self.right), ylim=(self.bottom, self.top), aspect="equal", xticks=[], yticks=[])
        for side in axes.spines.values():
            side.set(visible=True, color=FAINT)


def front_view(recording: Recording, places: Float[np.ndarray, "place 3"]) -> View:
    """The sensor's picture, as much of it as shows the places."""
    return _around(recording.camera, places, np.zeros((0, 2, 2)))


def raised_view(recording: Recording, places: Float[np.ndarray, "place 3"]) -> View:
    """From above and behind the sensor, at 30 degrees; for worlds whose z axis points upwards."""
    low, high = places.min(axis=0), places.max(axis=0)
    middle = (low + high) / 2
    forward = recording.camera.world_from_camera[:2, 2]
    forward = forward / max(np.linalg.norm(forward), 1e-9)
    distance = _DISTANCES * max(float(np.linalg.norm(high - low)), 1.0)
    away = np.append(-forward * np.cos(_ELEVATION), np.sin(_ELEVATION))
    position = middle + distance * away
    camera = Camera(
        width=int(_FOCAL_PX),
        height=int(_FOCAL_PX),
        fx=_FOCAL_PX,
        fy=_FOCAL_PX,
        cx=_FOCAL_PX / 2,
        cy=_FOCAL_PX / 2,
        world_from_camera=looking_at(_triple(position), _triple(middle)),
    )
    return _around(camera, places, camera.pixel_from_world(_grid(low, high))[0])


def _around(camera: Camera, places: np.ndarray, ground: np.ndarray) -> View:
    """The view of the places, with a rim around them."""
    picture = camera.pixel_from_world(places)[0]
    low, high = picture.min(axis=0), picture.max(axis=0)
    rim = _RIM * float((high - low).max())
    (left, top), (right, bottom) = (low - rim).tolist(), (high + rim).tolist()
    return View(camera=camera, left=left, right=right, top=top, bottom=bottom, ground=ground)


def _grid(low: np.ndarray, high: np.ndarray) -> Float[np.ndarray, "line 2 3"]:
    """Lines on the ground at whole metres, below the box between two corners."""
    begin, end = np.floor(low[:2]), np.ceil(high[:2])
    along = [[(x, begin[1], 0.0), (x, end[1], 0.0)] for x in np.arange(begin[0], end[0] + 1)]
    across = [[(begin[0], y, 0.0), (end[0], y, 0.0)] for y in np.arange(begin[1], end[1] + 1)]
    return np.array([*along, *across])


def _triple(place: np.ndarray) -> tuple[float, float, float]:
    x, y, z = place.tolist()
    return x, y, z
