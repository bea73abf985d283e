"""Affinities cut into segments by spectral clustering."""

import logging
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import blobs, same_partition
from scipy import sparse

from algorithm import spectral
from algorithm.spectral import lowest_eigenvalues, spectral_segments

seeds = st.integers(0, 2**32)


def by_eigengap(graph: sparse.csr_array) -> np.ndarray:
    return spectral_segments(graph, smallest=0.0, most=10)


def apart(*graphs: sparse.csr_array) -> sparse.csr_array:
    """Graphs side by side, without an edge between them."""
    return sparse.csr_array(sparse.block_diag(graphs))


@pytest.mark.parametrize("sizes", [[8, 8], [6, 15], [10, 10, 10, 10], [40, 60], [90, 110]])
def test_blobs_with_weak_bridges_come_apart(sizes: list[int]) -> None:
    expected = np.repeat(np.arange(len(sizes)), sizes)
    assert same_partition(by_eigengap(blobs(sizes, bridge=0.01)), expected)


@settings(max_examples=20)
@given(seeds, st.integers(2, 5), st.sampled_from([0.001, 0.01]))
def test_the_eigengap_counts_well_separated_blobs(seed: int, count: int, bridge: float) -> None:
    assert same_partition(by_eigengap(blobs([12] * count, bridge, seed)), np.repeat(np.arange(count), 12))


@settings(max_examples=20)
@given(seeds, st.integers(1, 4))
def test_a_given_number_of_segments_is_found(seed: int, count: int) -> None:
    graph = blobs([12, 20, 9, 15], 0.01, seed)
    label = spectral_segments(graph, smallest=0.0, most=10, count=count)
    assert len(np.unique(label)) == count
    truth = np.repeat(np.arange(4), [12, 20, 9, 15])
    assert all(len(np.unique(label[truth == blob])) == 1 for blob in range(4))


def test_the_given_number_counts_all_components_and_cuts_the_loosest_first() -> None:
    graph = apart(blobs([12, 12], 0.3), blobs([12, 12], 0.001), blobs([12], 0.0))
    label = spectral_segments(graph, smallest=0.0, most=10, count=4)
    assert same_partition(label, np.repeat([0, 1, 2, 3], [24, 12, 12, 12]))


def test_components_are_never_joined() -> None:
    graph = apart(blobs([12], 0.0), blobs([12], 0.0), blobs([12], 0.0))
    for count in (1, 3):
        label = spectral_segments(graph, smallest=0.0, most=10, count=count)
        assert same_partition(label, np.repeat([0, 1, 2], 12))


def test_what_is_too_small_takes_no_part_in_the_count() -> None:
    graph = apart(blobs([3], 0.0), blobs([12, 12], 0.01), blobs([4], 0.0))
    label = spectral_segments(graph, smallest=5.0, most=10, count=2)
    np.testing.assert_array_equal(label < 0, np.repeat([True, False, True], [3, 24, 4]))
    assert same_partition(label[3:27], np.repeat([0, 1], 12))


def test_the_eigengap_finds_no_more_than_allowed() -> None:
    assert len(np.unique(spectral_segments(blobs([12] * 6, 0.01), smallest=0.0, most=3))) <= 3


@given(seeds, st.integers(4, 90))
@settings(max_examples=20)
def test_the_eigenvalues_are_those_of_the_dense_laplacian(seed: int, count: int) -> None:
    weight = blobs([count // 2, count - count // 2], 0.3, seed).toarray()
    degree = weight.sum(axis=1)
    expected = np.linalg.eigvalsh(np.eye(count) - weight / np.sqrt(np.outer(degree, degree)))
    found = lowest_eigenvalues(sparse.csr_array(weight), count=6)
    np.testing.assert_allclose(found, expected[: len(found)], atol=1e-3)
    assert len(found) == min(6, count - 1)


@settings(max_examples=20)
@given(seed=seeds)
def test_the_order_of_the_nodes_only_renames_the_segments(seed: int) -> None:
    graph = blobs([7, 9, 11], 0.02, seed)
    order = np.random.default_rng(seed).permutation(27)
    assert same_partition(by_eigengap(graph[order][:, order]), by_eigengap(graph)[order])


@given(seeds, st.floats(0.01, 100.0))
@settings(max_examples=20)
def test_the_scale_of_the_affinities_does_not_matter(seed: int, scale: float) -> None:
    graph = blobs([7, 9, 11], 0.02, seed)
    assert same_partition(by_eigengap(sparse.csr_array(graph * scale)), by_eigengap(graph))


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4])
def test_tiny_graphs_stay_whole(count: int) -> None:
    label = by_eigengap(sparse.csr_array(np.ones((count, count)) - np.eye(count)))
    np.testing.assert_array_equal(label, np.zeros(count))


def test_isolated_nodes_are_segments_of_their_own() -> None:
    assert sorted(by_eigengap(sparse.csr_array((5, 5)))) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("sizes", [[150, 200], [60, 70, 80]])
def test_amg_and_arpack_cut_alike(sizes: list[int]) -> None:
    graph = blobs(sizes, 0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # That it stopped a little early does not matter here.
        amg = spectral._clustered(graph, len(sizes), "amg")
    assert same_partition(amg, spectral._clustered(graph, len(sizes), "arpack"))


def test_where_amg_does_not_converge_arpack_takes_its_place(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    clustered = spectral._clustered

    def stubborn(affinity, pieces, solver):
        if solver == "amg":
            warnings.warn("Exited at iteration 20", UserWarning, stacklevel=1)
        return clustered(affinity, pieces, solver)

    monkeypatch.setattr(spectral, "_clustered", stubborn)
    with caplog.at_level(logging.INFO):
        label = by_eigengap(blobs([40, 60], 0.01))
    assert same_partition(label, np.repeat([0, 1], [40, 60]))
    assert "ARPACK takes its place" in caplog.text


def test_the_global_random_state_is_left_as_it_was_and_does_not_matter() -> None:
    graph = blobs([40, 60, 80], 0.5)
    np.random.seed(1)  # noqa: NPY002 - what pyamg draws from is what is tested.
    one = by_eigengap(graph)
    drawn = np.random.random()  # noqa: NPY002 - the same.
    np.random.seed(1)  # noqa: NPY002 - the same.
    assert np.random.random() == drawn  # noqa: NPY002 - the same.
    np.testing.assert_array_equal(by_eigengap(graph), one)
