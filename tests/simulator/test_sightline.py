"""The few rays of a sensor meet what the naive caster of `recording.sight` meets."""

from dataclasses import replace

import numpy as np
import pytest

from recording.camera import Camera
from recording.recording import Recording
from recording.sight import covering
from simulator.simulate import simulate
from simulator.view import View


@pytest.fixture(scope="module")
def recording() -> Recording:
    return simulate("9men", size=(120, 90), frames=2)


def view_of(recording: Recording) -> View:
    return View(camera=recording.camera, meshes=recording.truth, frame=1)


@pytest.mark.parametrize("side_m", [0.075, -0.3])
def test_what_is_not_reached_from_beside_is_covered_there(recording: Recording, side_m: float) -> None:
    depth = recording.frames[1].depth
    matrix = recording.camera.world_from_camera.copy()
    matrix[:3, 3] += side_m * matrix[:3, 0]
    beside: Camera = replace(
        recording.camera, world_from_camera=matrix, width=recording.camera.width + 400, cx=recording.camera.cx + 200
    )
    points = recording.camera.world_points(depth)[np.isfinite(depth)]
    covered = covering(recording.truth, beside, points, frame=1) > 0
    reached = view_of(recording).reached_from(side_m, depth)
    assert covered.mean() > 0.005
    assert not reached[np.isnan(depth)].any()
    # A shadow of less than a tenth of a pixel is none: so a few points differ that lie in folds.
    assert np.mean(reached[np.isfinite(depth)] == covered) < 0.005


def test_the_ray_through_a_pixels_centre_meets_what_the_picture_shows(recording: Recording) -> None:
    depth = recording.frames[1].depth
    row, column = np.indices(depth.shape) + 0.5
    found = view_of(recording).depth_at(np.stack([column, row], axis=-1))
    both = np.isfinite(depth) & np.isfinite(found)
    assert np.mean(np.isfinite(depth) != np.isfinite(found)) < 1e-3  # Rounding at the outlines.
    assert np.mean(np.abs(found - depth)[both] > 1e-4) < 1e-3


def test_a_view_of_nothing_shows_nothing(recording: Recording) -> None:
    empty = View(camera=recording.camera, meshes={})
    assert np.isnan(empty.depth_at(np.array([[10.0, 10.0]]))).all()
    assert empty.reached_from(0.1, np.full((90, 120), 2, np.float32)).all()


def test_without_meshes_behind_the_camera_nothing_changes(recording: Recording) -> None:
    mesh = recording.truth[1]
    behind = replace(
        mesh, vertices=mesh.vertices + (recording.camera.world_from_camera[:3, 2] * -40).astype(np.float32)
    )
    more = View(camera=recording.camera, meshes={**recording.truth, 99: behind}, frame=1)
    places = np.random.default_rng(0).uniform(0, 90, (500, 2))
    np.testing.assert_array_equal(more.depth_at(places), view_of(recording).depth_at(places))
