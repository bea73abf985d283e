"""What stands before a camera in one frame, for those who want more of it than the picture of its pixels' centres.

Nothing is done before it is asked for.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Float32, Float64, Integer

from recording.camera import Camera, pixel_grid
from recording.errors import InputError
from recording.truth import Truth
from simulator.sightline import Targets, first_inverse_depths
from simulator.window import camera_points

_LEAST_SHADOW_PX = 0.1
"""What casts a narrower shadow than this on the surface behind it casts none: it is part of that surface."""


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A camera, and the meshes in one frame."""

    camera: Camera
    meshes: Truth | None = None
    """By object id; None where they are not known."""
    frame: int = 0
    """Which of the meshes' postures."""

    def reached_from(self, side_m: float, depth: Float32[np.ndarray, "row column"]) -> Bool[np.ndarray, "row column"]:
        """Whether a straight way leads from each pixel's point to the place `side_m` to the right of the camera.

        By a ray to the point of the pixel's centre at its depth. Where the depth is NaN, there is no point and no way.
        """
        moved = self.camera.world_from_camera.copy()
        moved[:3, 3] += side_m * moved[:3, 0]
        beside = replace(self.camera, world_from_camera=moved)
        reached = np.isfinite(depth)
        place = pixel_grid(*depth.shape)[reached].T
        target = 1.0 / depth[reached].astype(np.float64)
        place[0] -= self.camera.fx * side_m * target  # Seen from there the points have moved along the rows.
        own = target + _LEAST_SHADOW_PX / max(self.camera.fx * abs(side_m), _LEAST_SHADOW_PX)
        reached[reached] = self._first(beside, Targets(places=place, inverse_depth=own)) == 0
        return reached

    def depth_at(self, column_row: Float[np.ndarray, "*shape 2"]) -> Float64[np.ndarray, "*shape"]:
        """The depth that the ray through each place of the picture meets first, metres; NaN where it meets nothing."""
        places = np.ascontiguousarray(column_row.reshape(-1, 2).T.astype(np.float64))
        inverse = self._first(self.camera, Targets(places=places, inverse_depth=np.zeros(places.shape[1])))
        return (1.0 / np.where(inverse > 0, inverse, np.nan)).reshape(column_row.shape[:-1])

    def _first(self, camera: Camera, targets: Targets) -> Float64[np.ndarray, "ray"]:
        """The inverse depth of what lies first before each target; 0 where nothing does."""
        vertices, faces = self._posture
        return first_inverse_depths(camera, camera_points(camera, vertices), faces, targets)

    @cached_property
    def _posture(self) -> tuple[Float32[np.ndarray, "vertex 3"], Integer[np.ndarray, "face 3"]]:
        """The vertices of all meshes in the frame, one after the other, world axes, and their faces."""
        if self.meshes is None:
            raise InputError("this sensor casts rays of its own, for which the objects' meshes (truth.npz) are missing")
        meshes = [self.meshes[objectid] for objectid in sorted(self.meshes)]
        vertices = [mesh.vertices_at(self.frame) for mesh in meshes]
        first = np.cumsum([0, *(len(part) for part in vertices)])
        faces = [mesh.faces + begin for mesh, begin in zip(meshes, first[:-1], strict=True)]
        if not meshes:
            return np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32)
        return np.concatenate(vertices), np.concatenate(faces).astype(np.uint32)
