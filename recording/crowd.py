"""How near people come to one another and to obstacles, by their meshes alone."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Float64
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from recording.truth import MeshSequence

HEADROOM_M = 2.1
"""People pass under what hangs higher."""
WAIST = (0.55, 0.7)
"""Between which shares of a body's height its waist lies: above the legs, below the armpits."""


def centre_track(mesh: MeshSequence) -> Float64[np.ndarray, "frame 2"]:
    """Where a person's centre is in each frame: the mean of the vertices round the waist, on the ground, metres.

    World axes, z up. Which vertices these are is decided in the first frame, by the mesh alone: those of the largest
    piece between two heights, where arms are pieces of their own, and what is carried is none of the body. Of
    somebody without a waist it is the mean of all. On the bodies of this project the centre lies within 4.5 cm of
    the point of the path below the pelvis, mostly 2 to 3 cm before it.
    """
    return mesh.vertices[:, _waist(mesh), :2].astype(np.float64).mean(axis=1)


def smallest_gap_m(centres: Sequence[Float[np.ndarray, "frame 2"]]) -> float:
    """The smallest distance of two centres in any frame, metres; infinite for fewer than two."""
    between = (np.linalg.norm(a - b, axis=-1).min() for a, b in combinations(centres, 2))
    return float(min(between, default=np.inf))


def outline_distance_m(obstacle: MeshSequence, points: Float[np.ndarray, "point 2"]) -> float:
    """The smallest distance, on the ground, of the points from an obstacle's outline seen from above, metres.

    0 inside; infinite where people pass under it.
    """
    corners = obstacle.vertices_at(0).astype(np.float64)
    if corners[:, 2].min() >= HEADROOM_M:
        return float("inf")
    outline = ConvexHull(corners[:, :2])
    inside = (points @ outline.equations[:, :2].T + outline.equations[:, 2] <= 0).all(axis=1)
    begin, end = corners[outline.simplices, :2].swapaxes(0, 1)
    along = end - begin
    share = np.einsum("pex,ex->pe", points[:, None] - begin, along) / np.einsum("ex,ex->e", along, along)
    nearest = begin + np.clip(share, 0.0, 1.0)[..., None] * along
    return float(np.where(inside, 0.0, np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1)).min())


def deepest_inside_m(obstacle: MeshSequence, person: MeshSequence) -> float:
    """How deep the person's vertices get into a convex obstacle that stands still, metres; 0 where none is inside."""
    corners = obstacle.vertices_at(0).astype(np.float64)
    vertices = person.vertices.reshape(-1, 3)
    near = ((vertices > corners.min(axis=0)) & (vertices < corners.max(axis=0))).all(axis=1)
    planes = np.unique(ConvexHull(corners).equations.round(9), axis=0)
    outside = vertices[near] @ planes[:, :3].T + planes[:, 3]
    return float(np.max(-outside.max(axis=1, initial=-np.inf), initial=0.0))


def _waist(mesh: MeshSequence) -> Bool[np.ndarray, "vertex"]:
    """Mark the vertices round the waist."""
    height = mesh.vertices_at(0)[:, 2]
    body = _largest_piece(mesh, np.ones(len(height), bool))
    low, high = (share * height[body].max(initial=0.0) for share in WAIST)
    waist = _largest_piece(mesh, body & (height > low) & (height < high))
    return waist if waist.any() else np.ones(len(height), bool)


def _largest_piece(mesh: MeshSequence, allowed: Bool[np.ndarray, "vertex"]) -> Bool[np.ndarray, "vertex"]:
    """Mark the vertices of the piece with most surface among those that faces between allowed vertices make."""
    vertices, faces = mesh.vertices_at(0).astype(np.float64), mesh.faces[allowed[mesh.faces].all(axis=1)]
    if not len(faces):
        return np.zeros(len(allowed), bool)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(edges), bool), edges.T), shape=(len(allowed), len(allowed)))
    _, piece = connected_components(graph, directed=False)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    area = np.bincount(piece[faces[:, 0]], weights=np.linalg.norm(np.cross(b - a, c - a), axis=1))
    return np.asarray(piece == area.argmax())
