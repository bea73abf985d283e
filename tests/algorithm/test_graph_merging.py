"""Segments by merging along a graph."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import same_partition
from scipy import sparse
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree

from algorithm.graph_merging import merged_segments

seeds = st.integers(0, 2**32)


def random_graph(seed: int, count: int) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
    """Some of all pairs, with distances."""
    generator = np.random.default_rng(seed)
    first, second = np.triu_indices(count, 1)
    kept = generator.random(len(first)) < 0.5
    return (first[kept], second[kept]), generator.exponential(1.0, int(kept.sum()))


def inner_distance(weight: np.ndarray, members: set[int]) -> float:
    """The largest edge of the minimum spanning tree: Int of the article."""
    nodes = sorted(members)
    return float(minimum_spanning_tree(sparse.csr_array(weight[np.ix_(nodes, nodes)])).toarray().max(initial=0.0))


def naive_segments(pairs: tuple[np.ndarray, np.ndarray], distance: np.ndarray, count: int, k: float) -> np.ndarray:
    """The article's algorithm 1 as it stands there."""
    weight = np.zeros((count, count))
    weight[pairs] = distance
    segment = [{node} for node in range(count)]
    for edge in np.argsort(distance):
        one, other = segment[pairs[0][edge]], segment[pairs[1][edge]]
        if one is other:
            continue
        if distance[edge] <= min(inner_distance(weight, part) + k / len(part) for part in (one, other)):
            union = one | other
            for node in union:
                segment[node] = union
    return np.array([min(part) for part in segment])


@settings(deadline=None)  # The first call compiles.
@given(seeds, st.integers(1, 9), st.sampled_from([0.1, 0.5, 2.0]))
def test_the_segments_are_those_of_a_naive_implementation(seed: int, count: int, k: float) -> None:
    pairs, distance = random_graph(seed, count)
    found = merged_segments(pairs, distance, count=count, k=k)
    assert same_partition(found, naive_segments(pairs, distance, count, k))
    np.testing.assert_array_equal(np.unique(found), np.arange(found.max() + 1))


@given(seeds, st.integers(1, 30))
def test_a_boundless_k_gives_the_connected_components(seed: int, count: int) -> None:
    pairs, distance = random_graph(seed, count)
    graph = sparse.coo_array((np.ones(len(distance)), pairs), shape=(count, count))
    found = merged_segments(pairs, distance, count=count, k=1e9)
    assert same_partition(found, connected_components(graph, directed=False)[1])


@given(seeds, st.integers(2, 30))
def test_neither_the_order_nor_the_unit_matters(seed: int, count: int) -> None:
    pairs, distance = random_graph(seed, count)
    expected = merged_segments(pairs, distance, count=count, k=0.5)
    generator = np.random.default_rng(seed)
    name, order = generator.permutation(count), generator.permutation(len(distance))
    mixed = (name[pairs[1][order]], name[pairs[0][order]])
    assert same_partition(merged_segments(mixed, 7.0 * distance[order], count=count, k=3.5)[name], expected)


def test_what_is_alike_inside_does_not_merge_with_what_is_not() -> None:
    """Two chains of equal steps, 1 and 3 long, and a step of 2 between them."""
    pairs = (np.arange(7), np.arange(1, 8))
    distance = np.array([1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0])
    assert same_partition(merged_segments(pairs, distance, count=8, k=3.1), np.repeat([0, 1], 4))


@pytest.mark.parametrize("count", [0, 1, 3])
def test_without_pairs_everyone_is_a_segment(count: int) -> None:
    nothing = np.zeros(0, int)
    found = merged_segments((nothing, nothing), np.zeros(0), count=count, k=1.0)
    np.testing.assert_array_equal(found, np.arange(count))


def test_at_no_distance_all_are_one() -> None:
    pairs = (np.array([0, 1]), np.array([1, 2]))
    np.testing.assert_array_equal(merged_segments(pairs, np.zeros(2), count=3, k=1e-9), 0)
