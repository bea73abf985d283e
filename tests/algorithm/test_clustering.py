"""Affinities cut into segments."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import line, trajectories_of
from scipy import sparse

from algorithm import clustering
from algorithm.clustering import cut_at_eigengap, cut_while_cheap, followers, normalised_cut, without_small

METHODS = {
    "cheap": lambda graph: cut_while_cheap(graph, cut_below=0.1, smallest=2),
    "eigengap": lambda graph: cut_at_eigengap(graph, most=10),
}
seeds = st.integers(0, 2**32)


def blobs(sizes: list[int], bridge: float, seed: int = 0) -> sparse.csr_array:
    """Dense groups, each tied to the next by one edge of the bridge's weight."""
    weight = np.random.default_rng(seed).uniform(0.5, 1.0, (sum(sizes), sum(sizes)))
    label = np.repeat(np.arange(len(sizes)), sizes)
    weight *= label[:, None] == label
    ends = np.cumsum(sizes)
    for end in ends[:-1]:
        weight[end - 1, end] = bridge
    weight = np.triu(weight, 1)
    return sparse.csr_array(weight + weight.T)


def same_partition(one: np.ndarray, other: np.ndarray) -> bool:
    return bool(((one[:, None] == one) == (other[:, None] == other)).all())


def cuts(graph: sparse.csr_array, side: np.ndarray) -> float:
    """The normalised cut, from its definition."""
    weight = graph.toarray()
    cut = sum(weight[i, j] for i in np.flatnonzero(side) for j in np.flatnonzero(~side))
    return float(cut / weight[side].sum() + cut / weight[~side].sum())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("sizes", [[8, 8], [6, 15], [10, 10, 10, 10], [40, 60]])
def test_blobs_with_weak_bridges_come_apart(method: str, sizes: list[int]) -> None:
    label = METHODS[method](blobs(sizes, bridge=0.01))
    assert same_partition(label, np.repeat(np.arange(len(sizes)), sizes))


@pytest.mark.parametrize("sizes", [[20], [100]])
def test_one_dense_blob_stays_whole_when_cuts_are_dear(sizes: list[int]) -> None:
    assert len(np.unique(METHODS["cheap"](blobs(sizes, bridge=0.0)))) == 1


def test_a_strong_bridge_is_not_cut() -> None:
    assert len(np.unique(METHODS["cheap"](blobs([6, 6], bridge=30.0)))) == 1


@settings(max_examples=20)
@given(seeds, st.integers(2, 5), st.sampled_from([0.001, 0.01]))
def test_the_eigengap_counts_well_separated_blobs(seed: int, count: int, bridge: float) -> None:
    label = cut_at_eigengap(blobs([12] * count, bridge, seed), most=10)
    assert same_partition(label, np.repeat(np.arange(count), 12))


def test_no_more_segments_than_allowed() -> None:
    assert len(np.unique(cut_at_eigengap(blobs([12] * 6, 0.01), most=3))) <= 3


@given(seeds, st.integers(3, 12))
def test_the_normalised_cut_is_that_of_its_definition(seed: int, count: int) -> None:
    generator = np.random.default_rng(seed)
    graph = blobs([count], 0.0, seed)
    side = generator.permutation(np.arange(count) < generator.integers(1, count))
    assert normalised_cut(graph, side) == pytest.approx(cuts(graph, side))


@given(seeds, st.integers(4, 14), st.integers(1, 3))
def test_the_cheapest_cut_is_that_of_a_naive_sweep(seed: int, count: int, smallest: int) -> None:
    """Along the second eigenvector of the random walk's Laplacian, every cut that leaves enough members."""
    if count < 2 * smallest:
        return
    graph = blobs([count // 2, count - count // 2], 0.3, seed)
    found = clustering._cheapest_cut(graph, smallest)
    assert found is not None
    cost, side = found
    weight = graph.toarray()
    degree = weight.sum(axis=1)
    value, vector = np.linalg.eigh(np.eye(count) - weight / np.sqrt(np.outer(degree, degree)))
    order = np.argsort(vector[:, np.argsort(value)[1]] / np.sqrt(degree))
    naive = [cuts(graph, np.isin(np.arange(count), order[:size])) for size in range(smallest, count - smallest + 1)]
    assert cost == pytest.approx(min(naive))
    assert cuts(graph, side) == pytest.approx(cost)
    assert smallest <= side.sum() <= count - smallest


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=20)
@given(seed=seeds)
def test_the_order_of_the_nodes_only_renames_the_segments(method: str, seed: int) -> None:
    graph = blobs([7, 9, 11], 0.02, seed)
    order = np.random.default_rng(seed).permutation(27)
    assert same_partition(METHODS[method](graph[order][:, order]), METHODS[method](graph)[order])


@pytest.mark.parametrize("method", METHODS)
@given(seed=seeds)
@settings(max_examples=20)
def test_what_is_not_connected_stays_apart(method: str, seed: int) -> None:
    graph = sparse.csr_array(sparse.block_diag([blobs([5], 0, seed), blobs([8, 8], 0.5, seed), np.zeros((1, 1))]))
    label = METHODS[method](graph)
    parts = [set(label[:5]), set(label[5:21]), set(label[21:])]
    assert not any(parts[i] & parts[j] for i, j in ((0, 1), (0, 2), (1, 2)))
    np.testing.assert_array_equal(np.unique(label), np.arange(label.max() + 1))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("count", [0, 1, 2, 3, 4])
def test_tiny_graphs_stay_whole(method: str, count: int) -> None:
    full = np.ones((count, count)) - np.eye(count)
    label = METHODS[method](sparse.csr_array(full))
    assert label.shape == (count,)
    if count != 4:  # The four-node graph has several second eigenvectors.
        assert len(np.unique(label)) == min(count, 1)


@pytest.mark.parametrize("method", METHODS)
def test_isolated_nodes_are_segments_of_their_own(method: str) -> None:
    label = METHODS[method](sparse.csr_array((5, 5)))
    assert sorted(label) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("smallest", [0, 1])
def test_a_smallest_size_of_nothing_ends_too(smallest: int) -> None:
    label = cut_while_cheap(blobs([6, 6], 0.01), cut_below=0.1, smallest=smallest)
    assert same_partition(label, np.repeat([0, 1], 6))
    apart = cut_while_cheap(blobs([3, 4], 0.01), cut_below=3.0, smallest=smallest)
    assert len(np.unique(apart)) == 7


def test_no_segment_is_cut_below_the_smallest_size() -> None:
    label = cut_while_cheap(blobs([3, 12], 0.01), cut_below=0.2, smallest=4)
    assert np.bincount(label).min() >= 4
    assert len(np.unique(cut_while_cheap(blobs([8, 8], 0.01), cut_below=0.0, smallest=2))) == 1


def test_a_large_graph_is_cut_as_a_small_one_is() -> None:
    """Above some size the eigenvectors are found by iteration."""
    label = METHODS["cheap"](blobs([90, 110], 0.01))
    assert same_partition(label, np.repeat([0, 1], [90, 110]))


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


def test_a_chain_is_cut_where_it_is_weakest() -> None:
    weight = np.array([1.0, 1.0, 1.0, 0.01, 1.0, 1.0, 1.0])
    graph = sparse.diags_array([weight, weight], offsets=[-1, 1]).tocsr()
    label = cut_while_cheap(graph, cut_below=0.1, smallest=1)
    assert [bool(one != other) for one, other in pairwise(label)] == [value == 0.01 for value in weight]
