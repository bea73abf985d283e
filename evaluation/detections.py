"""What both baselines begin with: in each frame alone, the moving points that lie together are one detection."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from jaxtyping import Bool, Float, Int
from pydantic import Field
from sklearn.cluster import DBSCAN

from algorithm.pipeline import moving_depths
from algorithm.settings import Settings
from recording.camera import PIXEL_CENTRE, Camera
from recording.checks import Frozen
from recording.progress import tracked
from recording.recording import Recording

Positive = Annotated[float, Field(gt=0)]
Count = Annotated[int, Field(ge=1)]
NO_DETECTION = -1


class DetectorSettings(Frozen):
    """The settings of DBSCAN [Ester et al., KDD 1996] on a frame's occupied voxels: so picture size does not count."""

    voxel_m: Positive = 0.05
    """Metres: side of the cubes that points are gathered in before they are clustered."""
    radius_m: Positive = 0.3
    """Metres: occupied voxels this near are neighbours (DBSCAN's eps)."""
    neighbours: Count = 4
    """Occupied voxels within the radius that make a voxel the core of a cluster (DBSCAN's min_samples)."""
    smallest_voxels: Count = 40
    """Voxels: a smaller cluster is noise."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Detections:
    """The moving points of all frames, in order of frames, and the detections that they make."""

    frame: Int[np.ndarray, "point"]
    position: Float[np.ndarray, "point 3"]
    """World axes, metres."""
    column_row: Float[np.ndarray, "point 2"]
    """Picture position, pixels."""
    detection: Int[np.ndarray, "point"]
    """Number of each point's detection, counted through all frames; `NO_DETECTION` for noise."""
    moment: Int[np.ndarray, "detection"]
    """The frame of each detection, ascending."""
    centre: Float[np.ndarray, "detection 3"]
    """The mean of its points, world axes, metres."""

    @property
    def size(self) -> Int[np.ndarray, "detection"]:
        """The number of points of each detection."""
        return np.bincount(self.detection[self.detection != NO_DETECTION], minlength=len(self.moment))


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingPoints:
    """The points of a frame that do not stand still."""

    position: Float[np.ndarray, "point 3"]
    """World axes, metres."""
    column_row: Float[np.ndarray, "point 2"]
    """Picture position, pixels."""


def moving_points(recording: Recording) -> list[MovingPoints]:
    """The moving points of every frame, by the same removal of what stands still as the default preset's."""
    depths = moving_depths([frame.depth for frame in recording.frames], Settings())
    return [_points(depth, recording.camera) for depth in depths]


def detections_of(points: list[MovingPoints], settings: DetectorSettings) -> Detections:
    """The detections of all frames."""
    labels: list[np.ndarray] = []
    moments: list[int] = []
    for frame, here in enumerate(tracked(points, "detections", total=len(points))):
        label = _clustered(here.position, settings)
        labels.append(np.where(label >= 0, label + len(moments), NO_DETECTION))
        moments += [frame] * (int(label.max(initial=-1)) + 1)
    detection = np.concatenate(labels)
    position = np.concatenate([here.position for here in points])
    found = detection != NO_DETECTION
    count = np.bincount(detection[found], minlength=len(moments))
    total = [np.bincount(detection[found], position[found, axis], len(moments)) for axis in range(3)]
    return Detections(
        frame=np.repeat(np.arange(len(points)), [len(here.position) for here in points]),
        position=position,
        column_row=np.concatenate([here.column_row for here in points]),
        detection=detection,
        moment=np.array(moments, int),
        centre=np.stack(total, axis=1) / np.maximum(count, 1)[:, None],
    )


def _points(depth: np.ndarray, camera: Camera) -> MovingPoints:
    row, column = np.nonzero(np.isfinite(depth))
    column_row = np.stack([column, row], axis=1) + PIXEL_CENTRE
    return MovingPoints(
        position=camera.world_from_pixel(column_row, depth[row, column].astype(np.float64)), column_row=column_row
    )


def _clustered(position: Float[np.ndarray, "point 3"], settings: DetectorSettings) -> Int[np.ndarray, "point"]:
    """The cluster of each point, counted from 0; -1 for noise."""
    if not len(position):
        return np.zeros(0, int)
    voxel, index = np.unique(np.floor(position / settings.voxel_m), axis=0, return_inverse=True)
    method = DBSCAN(eps=settings.radius_m, min_samples=settings.neighbours)
    label = method.fit_predict(voxel * settings.voxel_m)
    return _renumbered(label, _large(label, settings.smallest_voxels))[index.ravel()]


def _large(label: Int[np.ndarray, "voxel"], smallest: int) -> Bool[np.ndarray, "voxel"]:
    size = np.bincount(label[label >= 0], minlength=1)
    return (label >= 0) & (size[label] >= smallest)


def _renumbered(label: Int[np.ndarray, "voxel"], kept: Bool[np.ndarray, "voxel"]) -> Int[np.ndarray, "voxel"]:
    names = np.unique(label[kept])
    return np.where(kept, np.searchsorted(names, label), -1)
