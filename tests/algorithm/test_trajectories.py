"""Chains of matches."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from made import line, trajectories_of
from worlds import small_camera

from algorithm.chaining import chained
from algorithm.matching import Pairs
from algorithm.observations import sorted_trajectories
from algorithm.trajectories import Trajectories, lasting, thinned

CAMERA = small_camera(3, 2)
NONE = (np.zeros(0, int), np.zeros(0, int))


def full(depth: float = 2.0) -> np.ndarray:
    return np.full((2, 3), depth, np.float32)


def pairs(*matches: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    source, goal = np.array(matches).T
    return source, goal


def trajectories_along(depths: list[np.ndarray], matches: list[Pairs]) -> Trajectories:
    return sorted_trajectories(chained(depths, matches), camera=CAMERA)


def test_matches_are_chained_across_frames() -> None:
    found = trajectories_along([full(2.0), full(2.5), full(3.0)], [pairs((0, 1)), pairs((1, 5), (3, 3))])
    assert found.count == 6 + 5 + 4
    np.testing.assert_array_equal(found.frame[found.trajectory == 0], [0, 1, 2])
    np.testing.assert_array_equal(found.column_row[found.trajectory == 0], [[0.5, 0.5], [1.5, 0.5], [2.5, 1.5]])
    np.testing.assert_allclose(found.position[found.trajectory == 0][:, 2], [2.0, 2.5, 3.0])
    assert sorted(found.length) == [1] * 13 + [2, 3]


def test_places_are_those_of_the_camera() -> None:
    found = trajectories_along([full()], [])
    np.testing.assert_allclose(found.position, CAMERA.world_points(full()).reshape(-1, 3))


def test_a_frame_without_returns_splits_everything() -> None:
    empty = np.full((2, 3), np.nan, np.float32)
    everyone = pairs(*((pixel, pixel) for pixel in range(6)))
    found = trajectories_along([full(), full(), empty, full()], [everyone, NONE, NONE])
    assert found.count == 12
    assert 2 not in found.frame
    np.testing.assert_array_equal(found.first_frame, [0] * 6 + [3] * 6)
    np.testing.assert_array_equal(found.last_frame, [1] * 6 + [3] * 6)


def test_without_any_return_there_is_no_trajectory() -> None:
    empty = np.full((2, 3), np.nan, np.float32)
    found = trajectories_along([empty, empty], [NONE])
    assert found.count == 0
    assert len(found.first_row) == len(found.length) == 0
    assert lasting(found, extent_m=0.0, frames=1).count == 0


@given(st.integers(0, 2**32), st.integers(1, 6))
def test_every_return_is_on_exactly_one_trajectory(seed: int, frames: int) -> None:
    generator = np.random.default_rng(seed)
    depths = [np.where(generator.random((2, 3)) < 0.3, np.nan, 2.0).astype(np.float32) for _ in range(frames)]
    matches = []
    for before, after in pairwise(depths):
        source = generator.permutation(np.flatnonzero(np.isfinite(before)))
        goal = generator.permutation(np.flatnonzero(np.isfinite(after)))
        size = generator.integers(0, min(len(source), len(goal)) + 1)
        matches.append((source[:size], goal[:size]))
    found = trajectories_along(depths, matches)
    assert len(found.frame) == sum(int(np.isfinite(depth).sum()) for depth in depths)
    assert found.count == len(found.frame) - sum(len(source) for source, _ in matches)
    assert_well_formed(found)


def assert_well_formed(found: Trajectories) -> None:
    """Sorted by trajectory, then consecutive frames; numbered from 0 without gaps."""
    same = found.trajectory[1:] == found.trajectory[:-1]
    assert (np.diff(found.frame)[same] == 1).all()
    assert (np.diff(found.trajectory)[~same] == 1).all()
    assert found.length.sum() == len(found.frame)
    np.testing.assert_array_equal(found.trajectory[found.first_row], np.arange(found.count))


def test_what_hardly_moves_or_hardly_lasts_is_noise() -> None:
    made = trajectories_of(
        [
            (0, line([0, 0, 1], [0.02, 0, 0], 10)),  # 0.18 m.
            (0, line([0, 0, 1], [0.01, 0, 0], 10)),  # 0.09 m.
            (5, line([0, 0, 1], [0.1, 0, 0], 3)),  # 0.2 m, 3 frames.
            (2, np.concatenate([line([0, 0, 1], [0.05, 0, 0], 4), line([0.1, 0, 1], [-0.05, 0, 0], 3)])),  # And back.
            (2, line([0, 0, 1], [0.02, 0.02, 0.02], 5)),  # The box's diagonal is 0.139 m.
        ]
    )
    kept = lasting(made, extent_m=0.1, frames=4)
    np.testing.assert_array_equal(kept.length, [10, 7, 5])
    np.testing.assert_array_equal(kept.first_frame, [0, 2, 2])
    assert_well_formed(kept)
    assert lasting(made, extent_m=0.1, frames=1).count == 4


def test_the_chosen_are_numbered_anew() -> None:
    made = trajectories_of([(0, line([n, 0, 1], [0.1, 0, 0], n + 1)) for n in range(5)])
    some = made.chosen(np.array([False, True, False, True, True]))
    np.testing.assert_array_equal(some.length, [2, 4, 5])
    np.testing.assert_array_equal(some.position[some.first_row, 0], [1, 3, 4])
    assert_well_formed(some)
    assert replace(made).chosen(np.zeros(5, bool)).count == 0


def test_fewer_points_are_the_same_points() -> None:
    depths = [full(depth) for depth in (2.0, 2.1, 2.2)]
    everyone = pairs(*((pixel, pixel) for pixel in range(6)))
    every = trajectories_along(depths, [everyone, everyone])
    fewer = thinned(every, apart_px=2)
    np.testing.assert_array_equal(fewer.column_row[fewer.first_row], [[0.5, 0.5], [2.5, 0.5]])
    np.testing.assert_array_equal(fewer.position, every.chosen(np.isin(np.arange(6), [0, 2])).position)
    assert thinned(every, apart_px=1).count == every.count
    assert thinned(every.chosen(np.zeros(6, bool)), apart_px=3).count == 0
