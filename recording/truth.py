"""The exact truth behind a simulated recording: every object's mesh in every frame."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int32, Integer


@dataclass(frozen=True, kw_only=True, eq=False)
class MeshSequence:
    """One object's surface over time: fixed faces, moving vertices."""

    faces: Int32[np.ndarray, "face 3"]
    """Vertex numbers of each face's corners A, B, C."""
    vertices: Float32[np.ndarray, "frame vertex 3"]
    """World axes, metres; a single frame where the object never moves."""

    @property
    def moving(self) -> bool:
        """Whether there is more than the one frame of an object that never moves."""
        return len(self.vertices) > 1

    def vertices_at(self, frame: int) -> Float32[np.ndarray, "vertex 3"]:
        """The vertices in one frame, world axes, metres."""
        return self.vertices[frame if self.moving else 0]

    def material_points(
        self,
        *,
        frame: int | Integer[np.ndarray, "point"],
        face: Integer[np.ndarray, "point"],
        u: Float[np.ndarray, "point"],
        v: Float[np.ndarray, "point"],
    ) -> Float[np.ndarray, "point 3"]:
        """Where the material points (1 - u - v) A + u B + v C of the faces lie in the frame or frames.

        World axes, metres, float64. The same (face, u, v) in another frame is the same point of the
        object's surface: that is what makes a hidden point's place known.
        """
        moment = np.broadcast_to(frame if self.moving else 0, face.shape)
        corners = self.vertices[moment[:, None], self.faces[face]].astype(np.float64)
        weights = np.stack([1.0 - u - v, u, v], axis=-1)
        return np.einsum("pc,pcx->px", weights, corners)


Truth = Mapping[int, MeshSequence]
"""Each object id's mesh."""
