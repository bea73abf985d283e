"""Which trajectories share a fate."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import line, random_paths, random_rotation, trajectories_of

from algorithm import affinity
from algorithm.affinity import (
    PairStatistics,
    affinity_matrix,
    neighbour_pairs,
    pair_statistics,
    product_distance,
    similarity,
)
from algorithm.trajectories import Trajectories

seeds = st.integers(0, 2**32)


def all_pairs(count: int) -> tuple[np.ndarray, np.ndarray]:
    first, second = np.array(list(combinations(range(count), 2))).T
    return first, second


@given(seeds)
def test_statistics_are_those_of_a_naive_loop(seed: int) -> None:
    paths = random_paths(seed)
    pairs = all_pairs(len(paths))
    found = pair_statistics(trajectories_of(paths), pairs)
    for index, (one, other) in enumerate(zip(*pairs, strict=True)):
        places = [dict(enumerate(path, start=first)) for first, path in (paths[one], paths[other])]
        common = sorted(places[0].keys() & places[1].keys())
        distance = np.array([np.linalg.norm(places[0][frame] - places[1][frame]) for frame in common])
        assert found.overlap[index] == len(common)
        values = [getattr(found, name)[index] for name in ("largest", "mean", "variance")]
        expected = [distance.max(), distance.mean(), distance.var()] if common else [np.nan] * 3
        np.testing.assert_allclose(values, expected, atol=1e-9)


def test_statistics_in_parts_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    made = trajectories_of(random_paths(3, count=20))
    whole = pair_statistics(made, all_pairs(20))
    monkeypatch.setattr(affinity, "_ROWS_AT_ONCE", 7)
    parts = pair_statistics(made, all_pairs(20))
    np.testing.assert_array_equal(parts.mean, whole.mean)
    np.testing.assert_array_equal(parts.variance, whole.variance)


def statistics(*, overlap: int, largest: float, mean: float, variance: float) -> PairStatistics:
    return PairStatistics(
        overlap=np.array([overlap]),
        largest=np.array([largest]),
        mean=np.array([mean]),
        variance=np.array([variance]),
    )


def test_the_product_is_the_papers_formula() -> None:
    pair = statistics(overlap=5, largest=0.6, mean=0.4, variance=0.02)
    # In spacings of 0.2 m: max 3, avg 2, var 0.5; 9 * 4 * 0.25 / 5.
    np.testing.assert_allclose(product_distance(pair, unit_m=0.2), [1.8])


def test_the_similarity_falls_from_one_to_a_half_at_epsilon_3() -> None:
    np.testing.assert_allclose(similarity(np.array([0.0, 1.5, 3.0]), eps3=3.0), [1.0, 2 / 3, 0.5])


def test_two_in_step_are_one_to_the_product_however_far_apart() -> None:
    """The paper's degeneracy (section 5 of `docs/method.md`): two people in step beat a person's own foot."""
    step = [0.05, 0.0, 0.0]
    foot = line([0.0, 0.0, 0.0], step, 20)
    foot[:, 0] += 0.05 * np.sin(np.arange(20))
    made = trajectories_of([(0, line([0, 0, 1], step, 20)), (0, line([0, 5, 1], step, 20)), (0, foot)])
    distance = product_distance(pair_statistics(made, (np.array([0, 0]), np.array([1, 2]))), unit_m=0.02)
    assert distance[0] < 1e-9 < distance[1]


def test_without_a_common_frame_there_is_no_distance_and_with_one_it_is_zero() -> None:
    still = line([0, 0, 1], [0, 0, 0], 5)
    made = trajectories_of([(0, still), (5, still), (4, still + 1.0)])
    found = pair_statistics(made, (np.array([0, 0]), np.array([1, 2])))
    np.testing.assert_array_equal(found.overlap, [0, 1])
    np.testing.assert_array_equal(product_distance(found, unit_m=0.02), [np.nan, 0.0])


@given(seeds, st.booleans())
def test_turning_moving_and_mirroring_the_world_change_nothing(seed: int, mirrored: bool) -> None:
    made = trajectories_of(random_paths(seed))
    moved = replace(made, position=made.position @ random_rotation(seed, mirrored=mirrored).T + [3.0, -2.0, 9.0])
    one, other = (
        product_distance(pair_statistics(world, all_pairs(made.count)), unit_m=1.0) for world in (made, moved)
    )
    np.testing.assert_allclose(other, one, rtol=1e-6, atol=1e-9)


@given(seeds, st.sampled_from([0.01, 50.0]))
def test_in_point_spacings_the_unit_of_length_does_not_matter(seed: int, scale: float) -> None:
    made = trajectories_of(random_paths(seed))
    larger = pair_statistics(replace(made, position=scale * made.position), all_pairs(made.count))
    expected = product_distance(pair_statistics(made, all_pairs(made.count)), unit_m=0.1)
    np.testing.assert_allclose(product_distance(larger, unit_m=0.1 * scale), expected, rtol=1e-6, atol=1e-9)


@given(seeds)
def test_the_order_of_two_does_not_matter(seed: int) -> None:
    made = trajectories_of(random_paths(seed))
    first, second = all_pairs(made.count)
    one, other = pair_statistics(made, (first, second)), pair_statistics(made, (second, first))
    np.testing.assert_array_equal(one.mean, other.mean)
    np.testing.assert_array_equal(one.overlap, other.overlap)


def naive_neighbours(made: Trajectories, neighbours: int, radius_m: float) -> set[tuple[int, int]]:
    found = set()
    for frame in np.unique(made.frame):
        rows = np.flatnonzero(made.frame == frame)
        for row in rows:
            distance = np.linalg.norm(made.position[rows] - made.position[row], axis=1)
            near = [other for other in np.argsort(distance) if rows[other] != row][:neighbours]
            for other in near:
                if distance[other] < radius_m:
                    pair = sorted((int(made.trajectory[row]), int(made.trajectory[rows[other]])))
                    found.add((pair[0], pair[1]))
    return found


@settings(max_examples=40)
@given(seeds, st.integers(1, 5), st.floats(0.1, 5))
def test_neighbours_are_those_of_a_naive_search(seed: int, neighbours: int, radius_m: float) -> None:
    made = trajectories_of(random_paths(seed))
    first, second = neighbour_pairs(made, neighbours=neighbours, radius_m=radius_m)
    assert (first < second).all()
    pairs = list(zip(first.tolist(), second.tolist(), strict=True))
    assert len(set(pairs)) == len(pairs)
    assert set(pairs) == naive_neighbours(made, neighbours, radius_m)


@pytest.mark.parametrize("count", [0, 1])
def test_no_one_has_no_neighbours(count: int) -> None:
    made = trajectories_of([(0, line([0, 0, 1], [0.1, 0, 0], 3))] * count)
    first, second = neighbour_pairs(made, neighbours=3, radius_m=1.0)
    assert len(first) == len(second) == 0
    assert len(pair_statistics(made, (first, second)).mean) == 0


def test_the_matrix_is_symmetric() -> None:
    matrix = affinity_matrix((np.array([0, 1]), np.array([1, 2])), np.array([0.5, 0.25]), count=4)
    np.testing.assert_array_equal(matrix.toarray(), [[0, 0.5, 0, 0], [0.5, 0, 0.25, 0], [0, 0.25, 0, 0], [0, 0, 0, 0]])
    assert matrix.nnz == 4
