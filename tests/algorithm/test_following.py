"""Points followed between the pixels: known motion, who goes on, who is lost, where new ones begin."""

from itertools import pairwise

import numpy as np
import pytest
from worlds import box, depths_of, plane, small_camera, sphere

from algorithm.following import Tolerances, followed
from algorithm.lifting import SceneFlow
from algorithm.observations import sorted_trajectories
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories

CAMERA = small_camera(64, 48)
WIDE = Tolerances(surface_m=0.1, home_m=0.05, jolt_m=1.0)


def uniform(depth: np.ndarray, columns: float, rows: float, change: float = 0.0) -> SceneFlow:
    column_row = np.broadcast_to(np.array([columns, rows], np.float32), (*depth.shape, 2)).copy()
    return SceneFlow(column_row=column_row, depth=np.where(np.isfinite(depth), np.float32(change), np.float32(np.nan)))


def there_and_back(
    depths: list[np.ndarray], columns: float, rows: float = 0.0, change: float = 0.0
) -> list[tuple[SceneFlow, SceneFlow]]:
    return [(uniform(a, columns, rows, change), uniform(b, -columns, -rows, -change)) for a, b in pairwise(depths)]


def follow(
    depths: list[np.ndarray], flows: list[tuple[SceneFlow, SceneFlow]], tolerances: Tolerances = WIDE
) -> Trajectories:
    history = followed(depths, flows, camera=CAMERA, tolerances=tolerances, watch=Stopwatch())
    return sorted_trajectories(history, camera=CAMERA)


def patch(column: int, frames: int, step: int = 0, depth: float = 3.0) -> list[np.ndarray]:
    images = []
    for frame in range(frames):
        image = np.full((48, 64), np.nan, np.float32)
        image[10:20, column + step * frame : column + step * frame + 12] = depth
        images.append(image)
    return images


def test_a_patch_that_moves_by_whole_pixels_keeps_its_points() -> None:
    depths = patch(5, frames=8, step=3)
    found = follow(depths, there_and_back(depths, 3.0))
    assert found.count == 120
    np.testing.assert_array_equal(found.length, 8)
    moves = np.diff(found.column_row.reshape(120, 8, 2), axis=1)
    np.testing.assert_allclose(moves, np.broadcast_to([3.0, 0.0], moves.shape), atol=1e-5)


def test_parts_of_a_pixel_add_up() -> None:
    depths = depths_of([plane(lambda _: 3.0)], CAMERA, 10)[0]
    found = follow(depths, there_and_back(depths, 0.3, 0.2))
    oldest = found.chosen((found.first_frame == 0) & (found.length == 10))
    assert oldest.count > 2000
    whole = oldest.column_row.reshape(-1, 10, 2)
    whole = whole[(whole[:, -1] < [63.0, 47.0]).all(axis=1)]  # Beyond, a place is drawn into the picture.
    np.testing.assert_allclose(whole[:, -1] - whole[:, 0], np.broadcast_to([2.7, 1.8], whole[:, 0].shape), atol=1e-4)


def test_nothing_moves_and_every_pixel_keeps_its_point() -> None:
    depths, _ = depths_of([sphere(lambda _: (0.0, 0.0, 3.0), 0.5)], CAMERA, 5)
    found = follow(depths, there_and_back(depths, 0.0))
    assert found.count == np.isfinite(depths[0]).sum()
    np.testing.assert_array_equal(found.length, 5)


def test_who_does_not_come_home_is_lost() -> None:
    depths = patch(20, frames=3)
    forward, backward = uniform(depths[0], 1.0, 0.0), uniform(depths[0], 1.0, 0.0)
    found = follow(depths, [(forward, backward)] * 2)
    assert found.length.max() == 1


def test_a_jolt_ends_a_trajectory_and_a_steady_one_goes_on() -> None:
    depths = depths_of([plane(lambda _: 3.0)], CAMERA, 4)[0]
    steady, jolt = there_and_back(depths, 0.5)[0], there_and_back(depths, 6.0)[0]
    strict = Tolerances(surface_m=0.1, home_m=0.05, jolt_m=0.1)
    assert follow(depths, [steady, steady, steady], strict).length.max() == 4
    broken = follow(depths, [steady, steady, jolt], strict)
    assert broken.length[broken.first_frame == 0].max() == 3


def test_a_point_does_not_cross_to_another_surface() -> None:
    near, far = patch(8, frames=2, depth=2.0), patch(20, frames=2, depth=4.0)
    depths = [np.fmin(a, b) for a, b in zip(near, far, strict=True)]
    found = follow(depths, there_and_back(depths, 6.0))
    depth = found.position[:, 2].round(3)
    for trajectory in range(found.count):
        assert len(set(depth[found.trajectory == trajectory])) == 1


def test_of_points_that_meet_the_oldest_goes_on() -> None:
    depths = depths_of([plane(lambda _: 3.0)], CAMERA, 3)[0]
    squeeze = uniform(depths[0], 0.0, 0.0)
    column = np.arange(64)
    squeeze.column_row[..., 0] = 0.4 * (32 - column)
    back = uniform(depths[0], 0.0, 0.0)
    back.column_row[..., 0] = -0.4 * (32 - column) / 0.6
    still = there_and_back(depths, 0.0)[0]
    found = follow(depths, [still, (squeeze, back)])
    assert (found.first_frame[found.last_frame == 2] == 0).mean() > 0.5
    cells = np.floor(found.column_row[found.frame == 2] * 2)
    assert len(np.unique(cells, axis=0)) == len(cells)


def test_who_leaves_the_picture_takes_nobody_along() -> None:
    depths = depths_of([plane(lambda _: 3.0)], CAMERA, 2)[0]
    found = follow(depths, there_and_back(depths, -0.7))
    ends = found.column_row[(found.frame == 1) & (found.first_frame[found.trajectory] == 0)]
    assert len(ends) == 48 * 64  # All places are within reach of the border's returns, and no two in one cell.


def test_what_comes_into_view_begins_new_trajectories() -> None:
    depths = patch(5, frames=2)
    depths[1][30:34, 40:44] = 2.0
    found = follow(depths, there_and_back(depths, 0.0))
    assert (found.first_frame == 1).sum() == 16


@pytest.mark.parametrize("frames", [1, 2, 4])
def test_empty_frames_have_no_trajectories(frames: int) -> None:
    depths = [np.full((48, 64), np.nan, np.float32)] * frames
    assert follow(depths, there_and_back(depths, 0.0)).count == 0


def test_an_empty_frame_between_ends_everything() -> None:
    depths = patch(5, frames=3)
    depths[1] = np.full((48, 64), np.nan, np.float32)
    found = follow(depths, there_and_back(depths, 0.0))
    assert found.length.max() == 1
    assert found.count == 240


def test_every_picture_position_is_in_a_pixel_of_its_surface() -> None:
    depths, _ = depths_of([box(lambda t: (0.02 * t - 0.1, 0.0, 3.0), (0.3, 0.3, 0.3))], CAMERA, 6)
    found = follow(depths, there_and_back(depths, 0.02 / 2.7 * 64))
    column, row = np.floor(found.column_row).astype(int).T
    seen = np.stack(depths)[found.frame, row, column]
    np.testing.assert_allclose(seen, found.position[:, 2], atol=0.1)


def test_points_of_a_noisy_surface_are_not_lost_for_its_noise() -> None:
    """It moves by a pixel a frame; steps jump by three times the bound that holds without noise."""
    generator = np.random.default_rng(0)
    depths = [
        np.where(np.isfinite(depth), depth + generator.normal(0, 0.02, depth.shape), np.nan) for depth in patch(5, 8, 1)
    ]
    noisy = [depth.astype(np.float32) for depth in depths]
    narrow = Tolerances(surface_m=0.1, home_m=0.05, jolt_m=0.02)
    found = follow(noisy, there_and_back(noisy, 1.0), narrow)
    assert np.median(found.length) == 8
    assert narrow.under_noise(0.0) == narrow
