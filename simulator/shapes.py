"""Boxes, cylinders, cones and balls: what people walk behind, and what jugglers throw."""

import numpy as np
import trimesh
from jaxtyping import Float

from recording.truth import MeshSequence

SECTIONS = 48
"""Sides of a round shape's prism: at a radius of 0.6 m it is nowhere more than 1.3 mm inside the circle."""
SUBDIVISIONS = 3
"""How often the icosahedron of a ball is refined: 1,280 faces, nowhere more than 0.5 % inside the sphere."""

Position = tuple[float, float, float]


def box(size: Position, position: Position, *, yaw: float = 0.0) -> MeshSequence:
    """A box with edges of `size` along x, y and z, metres; its base is centred at `position`.

    `yaw` turns it about the vertical through `position`, radians, counter-clockwise seen from above.
    """
    solid = trimesh.creation.box(extents=size)
    return _standing(solid, (0.0, 0.0, size[2] / 2), position, yaw)


def cylinder(radius: float, height: float, position: Position, *, yaw: float = 0.0) -> MeshSequence:
    """An upright cylinder, metres, closed at both ends; its base is centred at `position`. `yaw`: see `box`."""
    solid = trimesh.creation.cylinder(radius=radius, height=height, sections=SECTIONS)
    return _standing(solid, (0.0, 0.0, height / 2), position, yaw)


def cone(radius: float, height: float, position: Position, *, yaw: float = 0.0) -> MeshSequence:
    """An upright cone with its tip up, metres, closed below; its base is centred at `position`. `yaw`: see `box`."""
    solid = trimesh.creation.cone(radius=radius, height=height, sections=SECTIONS)
    return _standing(solid, (0.0, 0.0, 0.0), position, yaw)


def ball(radius: float, centre: Position = (0.0, 0.0, 0.0)) -> MeshSequence:
    """A ball, metres."""
    solid = trimesh.creation.icosphere(subdivisions=SUBDIVISIONS, radius=radius)
    return _standing(solid, (0.0, 0.0, 0.0), centre, 0.0)


def moved(mesh: MeshSequence, positions: Float[np.ndarray, "frame 3"]) -> MeshSequence:
    """The mesh, made about the origin, with the origin carried to a position in every frame; it never turns.

    The mesh is taken as it is in its first frame. World axes, metres.
    """
    vertices = mesh.vertices[0].astype(np.float64) + positions[:, None]
    return MeshSequence(faces=mesh.faces, vertices=vertices.astype(np.float32))


def _standing(solid: trimesh.Trimesh, centre: Position, position: Position, yaw: float) -> MeshSequence:
    """The solid, lifted so that its own centre lies at `centre` above its base, turned, then put in place."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    world_from_base = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    vertices = (solid.vertices + np.array(centre)) @ world_from_base.T + np.array(position)
    return MeshSequence(faces=np.array(solid.faces, dtype=np.int32), vertices=vertices.astype(np.float32)[None])
