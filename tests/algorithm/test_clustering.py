"""Trajectories become segments as in the paper."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as few
from hypothesis import strategies as st
from made import line, random_rotation, same_partition, trajectories_of

from algorithm.clustering import clustered, followers, without_small
from algorithm.settings import Settings
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories

METHODS = ["spectral", "graph_merging"]
seeds = st.integers(0, 2**32)


def body(seed: int, centre: list[float], path: np.ndarray, points: int = 40) -> list[tuple[int, np.ndarray]]:
    """Points of a soft body about a path, near one another, seen for most of it."""
    generator = np.random.default_rng(seed)
    found = []
    for offset in generator.uniform(-0.15, 0.15, (points, 3)):
        begin, end = int(generator.integers(0, 5)), len(path) - int(generator.integers(0, 5))
        wobble = 0.004 * generator.normal(size=(end - begin, 3))
        found.append((begin, path[begin:end] + centre + offset + wobble))
    return found


def two_bodies(seed: int = 0) -> tuple[Trajectories, np.ndarray]:
    """Two that pass each other a hand apart, and whose each trajectory is."""
    step = np.array([0.04, 0.01, 0.0])
    one = body(seed, [0.0, 0.0, 3.0], line([0, 0, 0], step.tolist(), 30))
    other = body(seed + 1, [0.45, 0.45, 3.0], line([0, 0, 0], (-step).tolist(), 30))
    return trajectories_of([*one, *other]), np.repeat([0, 1], 40)


def segments_of(made: Trajectories, clustering: str, *, spacing_m: float = 0.02, **changes: object) -> np.ndarray:
    known = {"clustering": clustering, "segment_count": 2, "merging_k": 1000.0, "eps3": 10.0, "eps4": 5.0, "eps5": 1}
    return clustered(made, Settings.model_validate(known | changes), spacing_m, Stopwatch())


@pytest.mark.parametrize("eps5", [1, 3])
@pytest.mark.parametrize("method", METHODS)
def test_two_that_pass_each_other_are_two_segments(method: str, eps5: int) -> None:
    made, truth = two_bodies()
    label = segments_of(made, method, eps5=eps5)
    kept = label >= 0
    assert same_partition(label[kept], truth[kept])
    assert kept.mean() > 0.95
    assert sorted(np.unique(label[kept])) == [0, 1]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("count", [0, 1])
def test_no_one_and_a_single_trajectory_are_noise(method: str, count: int) -> None:
    made = two_bodies()[0].chosen(np.arange(80) < count)
    np.testing.assert_array_equal(segments_of(made, method), np.full(count, -1))


@pytest.mark.parametrize("method", METHODS)
def test_two_alike_and_far_apart_are_two(method: str) -> None:
    path = line([0, 0, 0], [0.04, 0.01, 0.0], 30)
    made = trajectories_of([*body(0, [0.0, 0.0, 3.0], path), *body(0, [0.0, 5.0, 3.0], path)])
    assert same_partition(segments_of(made, method), np.repeat([0, 1], 40))


@pytest.mark.parametrize("method", METHODS)
@few(max_examples=8, deadline=None)
@given(seed=seeds, mirrored=st.booleans())
def test_turning_moving_and_mirroring_the_world_change_nothing(method: str, seed: int, mirrored: bool) -> None:
    made, _ = two_bodies(seed % 5)
    turned = made.position @ random_rotation(seed, mirrored=mirrored).T + [3.0, -2.0, 9.0]
    moved = segments_of(replace(made, position=turned), method)
    np.testing.assert_array_equal(moved, segments_of(made, method))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scale", [0.01, 30.0])
def test_with_the_sizes_the_unit_of_length_does_not_matter(method: str, scale: float) -> None:
    made, _ = two_bodies()
    larger = replace(made, position=scale * made.position)
    found = segments_of(larger, method, spacing_m=0.02 * scale, neighbour_radius_m=0.25 * scale)
    np.testing.assert_array_equal(found, segments_of(made, method))


@pytest.mark.parametrize("method", METHODS)
@few(max_examples=8, deadline=None)
@given(seed=seeds)
def test_the_order_of_the_trajectories_only_renames_the_segments(method: str, seed: int) -> None:
    made, _ = two_bodies()
    paths = [(int(made.first_frame[number]), made.position[made.trajectory == number]) for number in range(made.count)]
    order = np.random.default_rng(seed).permutation(made.count)
    mixed = segments_of(trajectories_of([paths[number] for number in order]), method)
    assert same_partition(mixed, segments_of(made, method)[order])


def test_small_segments_become_noise_and_the_rest_is_numbered_anew() -> None:
    label = np.array([5, 5, 5, 2, 2, 9, -1, -1, -1])
    np.testing.assert_array_equal(without_small(label, smallest=2.0), [1, 1, 1, 0, 0, -1, -1, -1, -1])
    np.testing.assert_array_equal(without_small(label, smallest=2.5), [0, 0, 0, -1, -1, -1, -1, -1, -1])
    assert (without_small(label, smallest=100.0) == -1).all()
    assert len(without_small(np.zeros(0, int), smallest=1.0)) == 0


def test_followers_take_the_label_of_the_nearest_in_their_middle_frame() -> None:
    step = [0.1, 0.0, 0.0]
    made = trajectories_of(
        [
            (0, line([0, 0, 1], step, 11)),  # Sampled, segment 4.
            (0, line([0, 1, 1], step, 11)),  # Sampled, segment 7.
            (2, line([0, 0.2, 1], step, 5)),
            (2, line([0, 0.9, 1], step, 5)),
            (9, line([0, 0.9, 1], step, 9)),  # In its middle frame no sampled one is there.
        ]
    )
    label = followers(made, np.array([True, True, False, False, False]), np.array([4, 7]), radius_m=0.5)
    np.testing.assert_array_equal(label, [4, 7, 4, 7, -1])
    label = followers(made, np.array([True, True, False, False, False]), np.array([4, 7]), radius_m=0.25)
    np.testing.assert_array_equal(label, [4, 7, -1, 7, -1])
