"""Small analytic worlds with known answers: planes, spheres and boxes before a camera at the origin."""

from collections.abc import Callable, Sequence

import numpy as np

from recording.camera import Camera, pixel_grid
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.recording import Recording

FPS = 30.0
Surface = Callable[[np.ndarray, int], np.ndarray]
"""Takes the rays (row, column, 3) of unit depth and the frame; gives the depth of each, inf for a miss."""


def small_camera(width: int = 80, height: int = 60) -> Camera:
    """A camera at the origin that looks along z, about 53 degrees wide."""
    return Camera(
        width=width,
        height=height,
        fx=float(width),
        fy=float(width),
        cx=width / 2,
        cy=height / 2,
        world_from_camera=np.eye(4),
    )


def plane(depth: Callable[[int], float]) -> Surface:
    """A plane that faces the camera, at the depth of each frame."""
    return lambda rays, frame: np.full(rays.shape[:2], depth(frame))


def sphere(centre: Callable[[int], Sequence[float]], radius: float) -> Surface:
    """A ball with its centre where each frame has it."""

    def depth(rays: np.ndarray, frame: int) -> np.ndarray:
        middle = np.asarray(centre(frame), float)
        a = np.sum(rays**2, axis=-1)
        b = rays @ middle
        root = b**2 - a * (middle @ middle - radius**2)
        with np.errstate(invalid="ignore"):
            nearest = (b - np.sqrt(root)) / a
        return np.where((root >= 0) & (nearest > 0), nearest, np.inf)

    return depth


def box(
    centre: Callable[[int], Sequence[float]], half: Sequence[float], turn: Callable[[int], float] = lambda _: 0.0
) -> Surface:
    """A box about its centre, turned about the camera's vertical axis."""

    def depth(rays: np.ndarray, frame: int) -> np.ndarray:
        cosine, sine = np.cos(turn(frame)), np.sin(turn(frame))
        box_from_camera = np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
        origin = -box_from_camera @ np.asarray(centre(frame), float)
        direction = rays @ box_from_camera.T
        direction = np.where(np.abs(direction) < 1e-12, 1e-12, direction)
        walls = np.stack([(sign * np.asarray(half) - origin) / direction for sign in (-1.0, 1.0)])
        enter, leave = walls.min(axis=0).max(axis=-1), walls.max(axis=0).min(axis=-1)
        return np.where((enter <= leave) & (enter > 0), enter, np.inf)

    return depth


def depths_of(surfaces: Sequence[Surface], camera: Camera, frames: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """The depth of each frame, NaN where there is nothing, and the number of the surface from 1, 0 for none."""
    ones = np.ones((camera.height, camera.width))
    rays = camera.camera_from_pixel(pixel_grid(camera.height, camera.width), ones)
    depths, labels = [], []
    for frame in range(frames):
        layers = np.stack([surface(rays, frame) for surface in surfaces])
        nearest = layers.min(axis=0)
        hit = np.isfinite(nearest)
        depths.append(np.where(hit, nearest, np.nan).astype(np.float32))
        labels.append(np.where(hit, layers.argmin(axis=0) + 1, 0).astype(np.uint32))
    return depths, labels


def recorded(
    surfaces: Sequence[Surface], *, frames: int, moving: Sequence[bool], camera: Camera | None = None
) -> Recording:
    """A recording of the surfaces, which are its objects 1, 2, ..."""
    camera = camera or small_camera()
    depths, labels = depths_of(surfaces, camera, frames)
    objects = tuple(
        ObjectRecord(id=number + 1, name=f"object {number + 1}", kind="ball" if moves else "box", moving=moves)
        for number, moves in enumerate(moving)
    )
    return Recording(
        metadata=metadata_of(camera, frames=frames, fps=FPS, objects=objects),
        frames=tuple(
            Frame(depth=depth, labels=Labels(objectid=label)) for depth, label in zip(depths, labels, strict=True)
        ),
    )


def recording_of(depths: Sequence[np.ndarray]) -> Recording:
    """A recording of depth images alone."""
    height, width = depths[0].shape
    camera = small_camera(width, height)
    return Recording(
        metadata=metadata_of(camera, frames=len(depths), fps=FPS),
        frames=tuple(Frame(depth=depth.astype(np.float32)) for depth in depths),
    )


def ball_behind_another() -> Recording:
    """A ball passes behind one that stands still."""
    near = sphere(lambda frame: (0.1, 0, 1.5), 0.25)
    far = sphere(lambda frame: (-0.9 + 0.12 * frame, 0, 2.5), 0.3)
    return recorded([near, far], frames=16, moving=[False, True])
