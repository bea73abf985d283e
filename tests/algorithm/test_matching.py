"""Matches: the right pairs, one to one, and none where the flows disagree."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from worlds import small_camera

from algorithm.lifting import SceneFlow
from algorithm.matching import Pairs, matched_pixels

HEIGHT, WIDTH = 6, 8
CAMERA = small_camera(WIDTH, HEIGHT)
NAN = np.float32(np.nan)


def uniform(columns: float, rows: float, metres: float = 0.0) -> SceneFlow:
    """The same motion everywhere."""
    column_row = np.broadcast_to(np.array([columns, rows], np.float32), (HEIGHT, WIDTH, 2)).copy()
    return SceneFlow(column_row=column_row, depth=np.full((HEIGHT, WIDTH), metres, np.float32))


def flat(depth: float = 2.0) -> np.ndarray:
    return np.full((HEIGHT, WIDTH), depth, np.float32)


def matched(
    flows: tuple[SceneFlow, SceneFlow], depths: tuple[np.ndarray, np.ndarray], tolerance_m: float = 0.1
) -> Pairs:
    return matched_pixels(flows, depths, camera=CAMERA, tolerance_m=tolerance_m, similar_depth_m=0.1)


@pytest.mark.parametrize(("columns", "rows"), [(0, 0), (2, 0), (-1, 0), (0, 3), (1, -2)])
def test_a_translation_matches_each_pixel_with_its_own(columns: int, rows: int) -> None:
    source, goal = matched((uniform(columns, rows), uniform(-columns, -rows)), (flat(), flat()))
    assert len(source) == (WIDTH - abs(columns)) * (HEIGHT - abs(rows))
    np.testing.assert_array_equal(goal % WIDTH, source % WIDTH + columns)
    np.testing.assert_array_equal(goal // WIDTH, source // WIDTH + rows)


def test_a_plane_that_approaches_matches_in_place() -> None:
    source, goal = matched((uniform(0, 0, -0.2), uniform(0, 0, 0.2)), (flat(2.0), flat(1.8)))
    np.testing.assert_array_equal(source, goal)
    assert len(source) == WIDTH * HEIGHT


@st.composite
def random_worlds(draw: st.DrawFn) -> tuple[tuple[SceneFlow, SceneFlow], tuple[np.ndarray, np.ndarray]]:
    generator = np.random.default_rng(draw(st.integers(0, 2**32)))
    size = draw(st.floats(0, 3))

    def flow() -> SceneFlow:
        return SceneFlow(
            column_row=generator.normal(0, size, (HEIGHT, WIDTH, 2)).astype(np.float32),
            depth=generator.normal(0, 0.02 * size, (HEIGHT, WIDTH)).astype(np.float32),
        )

    def depth() -> np.ndarray:
        values = generator.uniform(2.0, 2.05, (HEIGHT, WIDTH)).astype(np.float32)
        return np.where(generator.random(values.shape) < 0.2, NAN, values)

    return (flow(), flow()), (depth(), depth())


@given(random_worlds(), st.floats(0.01, 2))
def test_no_pixel_is_in_two_pairs_and_all_pairs_have_depth(world, tolerance_m: float) -> None:
    flows, depths = world
    source, goal = matched(flows, depths, tolerance_m)
    assert len(np.unique(source)) == len(source)
    assert len(np.unique(goal)) == len(goal)
    assert np.isfinite(depths[0].ravel()[source]).all()
    assert np.isfinite(depths[1].ravel()[goal]).all()


@given(random_worlds(), st.floats(0.01, 2))
def test_the_pairs_are_those_of_a_naive_loop(world, tolerance_m: float) -> None:
    (forward, backward), (before, after) = world
    best: dict[int, tuple[float, int]] = {}
    for row, column in np.ndindex(HEIGHT, WIDTH):
        place = np.array([column + 0.5, row + 0.5]) + forward.column_row[row, column]
        to_column, to_row = np.floor(place).astype(int)
        if not (0 <= to_column < WIDTH and 0 <= to_row < HEIGHT):
            continue
        depth = before[row, column] + forward.depth[row, column]
        if not abs(after[to_row, to_column] - depth) <= 0.1:
            continue
        home = CAMERA.camera_from_pixel(
            place + backward.column_row[to_row, to_column],
            np.asarray(depth + backward.depth[to_row, to_column], np.float64),
        )
        begun = CAMERA.camera_from_pixel(
            np.array([column + 0.5, row + 0.5]), np.asarray(before[row, column], np.float64)
        )
        miss = float(np.linalg.norm(home - begun))
        goal = int(to_row * WIDTH + to_column)
        if abs(miss - tolerance_m) < 1e-6:
            return  # Rounding decides.
        if miss <= tolerance_m and miss < best.get(goal, (np.inf, 0))[0]:
            best[goal] = (miss, row * WIDTH + column)
    source, goals = matched(*world, tolerance_m)
    assert dict(zip(goals.tolist(), source.tolist(), strict=True)) == {key: value[1] for key, value in best.items()}


def test_a_backward_flow_that_disagrees_matches_nothing() -> None:
    source, goal = matched((uniform(2, 0), uniform(0, 0)), (flat(), flat()))
    assert len(source) == len(goal) == 0


def test_the_tolerance_is_a_distance_in_space() -> None:
    """One pixel off at 2 m is 2 / 8 = 0.25 m with a focal length of 8 pixels."""
    flows = (uniform(2, 0), uniform(-1, 0))
    assert len(matched(flows, (flat(), flat()), 0.26)[0]) > 0
    assert len(matched(flows, (flat(), flat()), 0.24)[0]) == 0
    depth_only = (uniform(0, 0, 0.05), uniform(0, 0, 0.05))
    assert len(matched(depth_only, (flat(), flat()), 0.14)[0]) > 0
    assert len(matched(depth_only, (flat(), flat()), 0.05)[0]) == 0


def test_a_point_of_another_depth_is_another_surface() -> None:
    assert len(matched((uniform(1, 0), uniform(-1, 0)), (flat(2.0), flat(2.5)))[0]) == 0


def test_a_flow_of_unknown_depth_matches_nothing() -> None:
    unknown = SceneFlow(column_row=uniform(0, 0).column_row, depth=np.full((HEIGHT, WIDTH), NAN))
    for flows in ((unknown, uniform(0, 0)), (uniform(0, 0), unknown)):
        assert len(matched(flows, (flat(), flat()))[0]) == 0


def test_of_two_that_reach_one_pixel_the_one_that_comes_home_nearer_is_matched() -> None:
    forward, backward = uniform(0, 0), uniform(0, 0)
    forward.column_row[2, 3] = [1.0, 0.0]  # Pixel (2, 3) reaches (2, 4), where (2, 4) stays.
    backward.column_row[2, 4] = [-0.8, 0.0]  # From where home is nearer to (2, 3).
    source, goal = matched((forward, backward), (flat(), flat()), 1.0)
    assert source[goal == 2 * WIDTH + 4] == [2 * WIDTH + 3]
    assert 2 * WIDTH + 4 not in source


@pytest.mark.parametrize("which", [0, 1])
def test_an_empty_frame_matches_nothing(which: int) -> None:
    depths = [flat(), flat()]
    depths[which] = np.full((HEIGHT, WIDTH), NAN)
    source, goal = matched((uniform(0, 0), uniform(0, 0)), (depths[0], depths[1]))
    assert len(source) == len(goal) == 0
