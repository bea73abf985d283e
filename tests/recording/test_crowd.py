"""Centres, clearances and depths inside obstacles, by meshes whose answers are known."""

import numpy as np
import pytest
import trimesh

from recording.crowd import centre_track, deepest_inside_m, outline_distance_m, smallest_gap_m
from recording.truth import MeshSequence


def mesh(*solids: trimesh.Trimesh, shifts: np.ndarray | None = None) -> MeshSequence:
    """One mesh of the solids, moved by each of the shifts in turn."""
    whole = trimesh.util.concatenate(solids)
    moved = whole.vertices + (np.zeros((1, 3)) if shifts is None else shifts)[:, None]
    return MeshSequence(faces=whole.faces.astype(np.int32), vertices=moved.astype(np.float32))


def box(size: tuple[float, float, float], middle: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(size).apply_translation(middle)


def column(radius: float, height: float, at: tuple[float, float] = (0.0, 0.0)) -> trimesh.Trimesh:
    """An upright one with rings of vertices all the way up."""
    solid = trimesh.creation.cylinder(radius=radius, height=height, sections=32).apply_translation((*at, height / 2))
    return solid.subdivide_to_size(0.1)


def test_the_centre_is_that_of_the_waist_whatever_is_carried() -> None:
    shifts = np.array([[0, 0, 0], [0.5, 0, 0], [1.0, 0.25, 0]])
    suitcase, umbrella = box((0.5, 0.2, 0.4), (0.0, -0.4, 0.3)), box((1.2, 1.2, 0.02), (0.3, 0.2, 2.2))
    swinging_hand = column(0.06, 0.3, (0.4, 0.3)).apply_translation((0, 0, 0.95))
    person = mesh(column(0.2, 1.8), suitcase, umbrella, swinging_hand, shifts=shifts)
    np.testing.assert_allclose(
        centre_track(person), shifts[:, :2], atol=0.03
    )  # Its rings have no even number of vertices.


def test_the_centre_of_what_has_no_waist_is_that_of_all_of_it() -> None:
    np.testing.assert_allclose(centre_track(mesh(box((1, 1, 1), (3, 4, 0.5)))), [[3, 4]])


def test_the_smallest_gap_is_that_of_the_nearest_two_in_any_frame() -> None:
    tracks = [
        np.array([[0.0, 0.0], [1.0, 0.0]]),
        np.array([[3.0, 4.0], [1.0, 0.5]]),
        np.array([[9.0, 9.0], [9.0, 9.0]]),
    ]
    assert smallest_gap_m(tracks) == pytest.approx(0.5)
    assert smallest_gap_m(tracks[:1]) == float("inf")


@pytest.mark.parametrize(
    ("point", "expected"), [((0.0, 0.0), 0.0), ((0.9, 0.4), 0.0), ((1.3, 0.0), 0.3), ((1.3, 0.9), 0.5)]
)
def test_the_distance_from_an_outline_is_0_inside(point: tuple[float, float], expected: float) -> None:
    wall = mesh(box((2, 1, 2), (0, 0, 1)))
    assert outline_distance_m(wall, np.array([point, (5.0, 5.0)])) == pytest.approx(expected, abs=1e-6)


def test_what_hangs_overhead_is_in_nobodys_way() -> None:
    assert outline_distance_m(mesh(box((2, 1, 0.2), (0, 0, 2.3))), np.zeros((1, 2))) == float("inf")


@pytest.mark.parametrize(("x", "expected"), [(1.5, 0.0), (1.1, 0.1), (0.9, 0.3)])
def test_the_depth_inside_an_obstacle_is_that_of_the_deepest_vertex(x: float, expected: float) -> None:
    wall, person = mesh(box((2, 4, 3), (0, 0, 1.5))), mesh(column(0.2, 1.8, (x, 0.0)))
    assert deepest_inside_m(wall, person) == pytest.approx(expected, abs=1e-6)


def test_beside_a_cone_is_not_inside_it() -> None:
    cone = mesh(trimesh.creation.cone(radius=1.0, height=2.0, sections=64))
    high, low = box((0.2, 0.2, 0.2), (0.5, 0, 1.8)), box((0.2, 0.2, 0.2), (0.5, 0, 0.3))
    assert deepest_inside_m(cone, mesh(high)) == 0.0
    assert deepest_inside_m(cone, mesh(low)) > 0.1
