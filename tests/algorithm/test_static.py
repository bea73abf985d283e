"""What stands still is found, whatever passes before it and however the floor wobbles."""

import numpy as np
import pytest
from worlds import box, depths_of, plane, small_camera, sphere

from algorithm.static import background, noise_in_time, usual_depth

FRAMES = 30
CAMERA = small_camera(40, 30)


def scene(moving: bool = True, wall: bool = True) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """A wall at 4 m, and a ball that goes by before it."""
    ball = sphere(lambda t: (-1.0 + 2.0 * t / FRAMES if moving else 0.0, 0.0, 2.0), 0.3)
    return depths_of([ball, plane(lambda _: 4.0)] if wall else [ball], CAMERA, FRAMES)


def test_the_wall_stands_still_and_the_ball_moves() -> None:
    depths, labels = scene()
    still = background(depths, tolerance_m=0.03)
    np.testing.assert_allclose(still.depth, 4.0)
    for depth, label in zip(depths, labels, strict=True):
        np.testing.assert_array_equal(still.moving(depth), label == 1)


def test_where_nothing_moves_all_stands_still() -> None:
    depths, _ = scene(moving=False)
    still = background(depths, tolerance_m=0.03)
    assert not any(still.moving(depth).any() for depth in depths)


def test_noise_below_the_tolerance_stands_still() -> None:
    generator = np.random.default_rng(0)
    depths = [(4.0 + generator.uniform(-0.01, 0.01, (20, 20))).astype(np.float32) for _ in range(FRAMES)]
    still = background(depths, tolerance_m=0.03)
    assert not any(still.moving(depth).any() for depth in depths)


def test_a_floor_that_wobbles_from_frame_to_frame_stands_still() -> None:
    depths, labels = scene()
    shift = np.where(np.arange(FRAMES) % 2 == 0, 0.03, -0.03)  # It jumps by 6 cm.
    shift += np.random.default_rng(0).uniform(-0.005, 0.005, FRAMES)
    wobbling = [(depth + by).astype(np.float32) for depth, by in zip(depths, shift, strict=True)]
    still = background(wobbling, tolerance_m=0.03)
    moving = [still.moving(depth) for depth in wobbling]
    for found, label in zip(moving, labels, strict=True):
        np.testing.assert_array_equal(found, label == 1)


@pytest.mark.parametrize("kind", ["jumps", "wanders"])
def test_a_floor_that_wobbles_by_six_centimetres_either_way_stands_still(kind: str) -> None:
    depths, labels = scene()
    generator = np.random.default_rng(1)
    jumps = generator.choice([-0.06, 0.0, 0.06], FRAMES)
    shift = jumps if kind == "jumps" else generator.uniform(-0.06, 0.06, FRAMES)
    wobbling = [(depth + by).astype(np.float32) for depth, by in zip(depths, shift, strict=True)]
    still = background(wobbling, tolerance_m=0.03)
    wrong = np.mean([np.mean(still.moving(d) != (m == 1)) for d, m in zip(wobbling, labels, strict=True)])
    assert wrong < 0.01


def test_the_wobble_is_the_shift_of_the_frame() -> None:
    depths, _ = scene()
    still = background(depths, tolerance_m=0.03)
    assert still.wobble(depths[5]) == pytest.approx(0.0, abs=1e-6)
    assert still.wobble(depths[5] + np.float32(0.06)) == pytest.approx(0.06, abs=1e-5)
    assert still.wobble(np.full_like(depths[5], np.nan)) == 0.0


def test_someone_who_passes_before_nothing_moves() -> None:
    """His pixels see him alone, so their usual depth is his own."""
    depths, labels = scene(wall=False)
    still = background(depths, tolerance_m=0.03)
    for depth, label in zip(depths, labels, strict=True):
        np.testing.assert_array_equal(still.moving(depth), label == 1)


def test_what_hides_the_wall_less_than_half_of_the_time_is_not_the_background() -> None:
    depths = [np.full((3, 3), 2.0 if 10 <= t < 22 else 4.0, np.float32) for t in range(FRAMES)]
    still = background(depths, tolerance_m=0.03)
    np.testing.assert_array_equal(still.depth, 4.0)
    assert [bool(still.moving(depth).all()) for depth in depths] == [10 <= t < 22 for t in range(FRAMES)]


def test_a_ball_that_comes_back_to_its_pixels_before_nothing_moves() -> None:
    """It goes round in ten frames before a small board, and is as deep in a pixel each time."""
    ball = sphere(lambda t: (0.6 * np.cos(0.2 * np.pi * t), 0.6 * np.sin(0.2 * np.pi * t), 2.0), 0.15)
    board = box(lambda _: (0.0, 0.0, 2.5), (0.2, 0.2, 0.1))
    depths, labels = depths_of([ball, board], CAMERA, FRAMES)
    still = background(depths, tolerance_m=0.03)
    for depth, label in zip(depths, labels, strict=True):
        np.testing.assert_array_equal(still.moving(depth), label == 1)


@pytest.mark.parametrize("away", [4, 6])
def test_what_comes_and_goes_before_nothing_moves_however_often_it_is_there(away: int) -> None:
    """It is there for five frames, as deep each time, and away for some."""
    here = np.arange(90) % (5 + away) < 5
    depths = [np.full((8, 8), 2.0 if there else np.nan, np.float32) for there in here]
    still = background(depths, tolerance_m=0.03)
    assert [bool(still.moving(depth).all()) for depth in depths] == here.tolist()


def test_faint_returns_that_flicker_stand_still() -> None:
    generator = np.random.default_rng(3)
    depths = [np.where(generator.random((20, 20)) < 0.35, np.float32(4.0), np.float32(np.nan)) for _ in range(90)]
    still = background(depths, tolerance_m=0.03)
    assert np.mean([still.moving(depth).mean() for depth in depths]) < 0.01


def test_a_wall_that_is_hidden_for_long_and_then_lost_stands_still() -> None:
    """It is seen in half of the frames, but in three quarters of those in which nothing hides it."""
    depths = [np.full((4, 4), 4.0, np.float32) for _ in range(90)]
    for number in range(20, 50):
        depths[number][:] = 1.0 + number / 50
    for number in range(50, 65):
        depths[number][:] = np.nan
    still = background(depths, tolerance_m=0.03)
    assert [bool(still.moving(depth).any()) for depth in depths] == [20 <= number < 50 for number in range(90)]


def test_what_swings_before_a_board_does_not_count_as_its_noise() -> None:
    """The swing is seen in a third of the frames: more than a quarter, which decides how much a pixel scatters."""
    board = np.full((10, 10), 4.0, np.float32)
    depths = [board.copy() for _ in range(FRAMES)]
    for t in range(0, FRAMES, 3):
        depths[t][:5, :5] = 3.85
    still = background(depths, tolerance_m=0.03)
    for t, depth in enumerate(depths):
        np.testing.assert_array_equal(still.moving(depth), depth < 3.9, err_msg=f"frame {t}")


def test_the_noise_of_a_pixel_is_what_scatters_from_frame_to_frame() -> None:
    """A surface that goes evenly by, two metres in all, has none."""
    generator = np.random.default_rng(0)
    evenly = [np.full((20, 20), 2.0 + 0.05 * t, np.float32) for t in range(FRAMES)]
    noise = generator.normal(scale=0.04, size=(FRAMES, 20, 20)).astype(np.float32)
    np.testing.assert_allclose(noise_in_time(evenly), 0.0, atol=1e-6)
    rough = noise_in_time([depth + own for depth, own in zip(evenly, noise, strict=True)])
    assert np.median(rough) == pytest.approx(0.04, rel=0.1)
    assert not noise_in_time(evenly[:2]).any()


def test_missing_returns_do_not_move_and_do_not_matter() -> None:
    generator = np.random.default_rng(0)
    depths = []
    for _ in range(FRAMES):
        depth = np.full((20, 20), 4.0, np.float32)
        depth[generator.random((20, 20)) < 0.4] = np.nan
        depths.append(depth)
    still = background(depths, tolerance_m=0.03)
    np.testing.assert_array_equal(still.depth, 4.0)
    assert not any(still.moving(depth).any() for depth in depths)


def test_the_usual_depth_is_a_median_of_the_returns() -> None:
    depths = [np.array([[value, np.nan]], np.float32) for value in (5.0, 1.0, np.nan, 3.0)]
    usual = usual_depth(depths)
    assert usual[0, 0] == 3.0
    assert np.isnan(usual[0, 1])


@pytest.mark.parametrize("frames", [1, 2])
def test_the_shortest_recordings_have_no_trouble(frames: int) -> None:
    still = background([np.full((2, 2), 4.0, np.float32)] * frames, tolerance_m=0.03)
    assert still.moving(np.full((2, 2), 4.0, np.float32)).all() == (frames == 1)  # Nothing repeats itself in one.


def test_an_empty_recording_has_no_background() -> None:
    empty = np.full((2, 2), np.nan, np.float32)
    still = background([empty, empty], tolerance_m=0.03)
    assert np.isnan(still.depth).all()
    assert not still.moving(empty).any()
