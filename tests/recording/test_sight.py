"""The small ray caster, held against one written plainly."""

import numpy as np
import pytest

from recording.camera import Camera, looking_at, pixel_grid
from recording.sight import covering, first_depths
from recording.truth import MeshSequence

CAMERA = Camera(
    width=16,
    height=12,
    fx=10.0,
    fy=12.0,
    cx=7.5,
    cy=6.0,
    world_from_camera=looking_at((0.5, -3.0, 1.0), (0.0, 0.0, 1.0)),
)


def soup(seed: int, faces: int = 40) -> MeshSequence:
    """Faces of all sizes round the camera, some of them behind it or across its plane."""
    generator = np.random.default_rng(seed)
    centres = generator.uniform([-4, -5, -2], [4, 5, 4], (faces, 1, 3))
    corners = centres + generator.normal(size=(faces, 3, 3)) * generator.uniform(0.05, 2, (faces, 1, 1))
    return MeshSequence(
        faces=np.arange(3 * faces, dtype=np.int32).reshape(-1, 3), vertices=corners.reshape(1, -1, 3).astype(np.float32)
    )


def first_hit(mesh: MeshSequence, target: np.ndarray) -> float:
    """How far the way from the camera to the target is when it first meets the mesh, as a share of it."""
    shares = [np.inf]
    for a, b, c in mesh.vertices[0].astype(np.float64)[mesh.faces]:
        way = target - CAMERA.position
        u, v, share = np.linalg.solve(np.stack([b - a, c - a, -way], axis=1), CAMERA.position - a)
        if u >= 0 and v >= 0 and u + v <= 1 and share > 0:
            shares.append(share)
    return min(shares)


@pytest.mark.parametrize("seed", range(5))
def test_depths_are_those_of_a_plain_ray_caster(seed: int) -> None:
    mesh = soup(seed)
    found = first_depths(mesh, CAMERA, frame=0)
    targets = CAMERA.world_from_pixel(pixel_grid(12, 16), np.ones((12, 16)))
    expected = np.array([[first_hit(mesh, target) for target in line] for line in targets])
    assert 0.1 < np.isfinite(expected).mean() < 1
    np.testing.assert_allclose(found.least, expected, rtol=1e-9)
    np.testing.assert_allclose(found.most, expected, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_a_point_is_covered_by_what_its_view_first_meets(seed: int) -> None:
    truth = {4: soup(seed, 15), 9: soup(seed + 100, 15)}
    points = np.random.default_rng(seed).uniform([-2, -1, -1], [2, 4, 3], (200, 3))
    inside = CAMERA.contains(CAMERA.pixel_from_world(points)[0])
    shares = np.array([[first_hit(mesh, point) for mesh in truth.values()] for point in points])
    nearest = np.array([4, 9])[shares.argmin(axis=1)]
    expected = np.where(inside & (shares.min(axis=1) < 1), nearest, 0)
    assert np.any(expected > 0)
    np.testing.assert_array_equal(covering(truth, CAMERA, points, frame=0), expected)


def test_nothing_covers_what_is_not_in_the_picture() -> None:
    truth = {1: soup(0)}
    behind, aside, nowhere = [0.5, -9.0, 1.0], [90.0, 0.0, 1.0], [np.nan] * 3
    assert covering(truth, CAMERA, np.array([behind, aside, nowhere]), frame=0).tolist() == [0, 0, 0]
    assert covering(truth, CAMERA, np.empty((0, 3)), frame=0).shape == (0,)


def test_a_ray_through_an_edge_falls_through_neither_face() -> None:
    corners = np.array([[-1, 0, 2], [1, -1, 2], [1, 1, 2], [-1, -1, 2], [-1, 1, 2]], np.float32)
    fan = MeshSequence(faces=np.array([[0, 1, 2], [0, 3, 1], [0, 2, 4]], np.int32), vertices=corners[None])
    camera = Camera(width=3, height=3, fx=9.0, fy=9.0, cx=1.5, cy=1.5, world_from_camera=np.eye(4))
    folded = MeshSequence(faces=np.array([[0, 1, 2], [0, 3, 2]], np.int32), vertices=fold()[None])
    assert np.all(first_depths(fan, camera, frame=0).least == 2)
    found = first_depths(folded, camera, frame=0)
    np.testing.assert_allclose(found.least[1], 2)  # The middle row's rays run along the edge.
    assert np.all(np.isinf(found.most[1]))


def fold() -> np.ndarray:
    """Two faces that meet in a level edge before the camera."""
    return np.array([[-1, 0, 2], [1, -1, 2], [1, 0, 2], [1, 1, 2]], np.float32)
