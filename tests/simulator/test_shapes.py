"""Shapes have the size and the place that were asked for, closed and facing outwards."""

import numpy as np
import pytest
import trimesh

from recording.truth import MeshSequence
from simulator.shapes import ball, box, cone, cylinder, moved


def solid(mesh: MeshSequence) -> trimesh.Trimesh:
    return trimesh.Trimesh(vertices=mesh.vertices[0], faces=mesh.faces, process=False)


@pytest.mark.parametrize(
    ("mesh", "volume", "height"),
    [
        (box((1.0, 0.5, 2.0), (3.0, -2.0, 0.0), yaw=0.7), 1.0, 2.0),
        (cylinder(0.2, 1.9, (3.0, -2.0, 0.0)), np.pi * 0.04 * 1.9, 1.9),
        (cone(0.6, 2.5, (3.0, -2.0, 0.0)), np.pi * 0.36 * 2.5 / 3, 2.5),
    ],
)
def test_stands_on_the_ground_with_its_volume_facing_outwards(mesh: MeshSequence, volume: float, height: float) -> None:
    shape = solid(mesh)
    assert shape.is_watertight
    assert shape.volume == pytest.approx(volume, rel=0.01)  # Negative if the faces looked inwards.
    assert shape.bounds[:, 2] == pytest.approx([0.0, height])
    assert shape.center_mass[:2] == pytest.approx([3.0, -2.0], abs=1e-5)
    assert not mesh.moving


def test_ball_lies_about_its_centre() -> None:
    mesh = ball(0.3, (1.0, 2.0, 3.0))
    distance = np.linalg.norm(mesh.vertices[0] - [1.0, 2.0, 3.0], axis=-1)
    assert distance == pytest.approx(0.3, abs=1e-6)
    assert solid(mesh).volume == pytest.approx(4 / 3 * np.pi * 0.027, rel=0.02)


def test_yaw_turns_x_towards_y() -> None:
    mesh = box((2.0, 0.2, 1.0), (0.0, 0.0, 0.0), yaw=np.pi / 2)
    assert solid(mesh).extents == pytest.approx([0.2, 2.0, 1.0], abs=1e-6)
    corner = box((2.0, 2.0, 1.0), (0.0, 0.0, 0.0), yaw=np.pi / 4).vertices[0]
    assert np.abs(corner[:, :2]).max(axis=0) == pytest.approx([np.sqrt(2)] * 2, abs=1e-6)


def test_moved_follows_every_position() -> None:
    positions = np.array([[0.0, 0.0, 1.0], [0.5, 0.0, 2.0], [1.0, -1.0, 1.0]])
    mesh = moved(ball(0.1), positions)
    assert mesh.moving
    assert mesh.vertices.mean(axis=1) == pytest.approx(positions, abs=1e-6)
    assert mesh.vertices.dtype == np.float32
