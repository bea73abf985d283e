"""Clustering scores: parity with scikit-learn, known values, laws."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import adjusted_rand_score, v_measure_score
from sklearn.metrics.cluster import contingency_matrix

from evaluation.clustering import (
    adjusted_rand_index,
    assigned,
    contingency,
    extracted,
    inverse_purity,
    majority,
    over_segmented,
    purity,
    v_measure,
)

points = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 4)), min_size=1, max_size=60)


@given(points)
def test_scores_equal_those_of_scikit_learn(pairs: list[tuple[int, int]]) -> None:
    cluster, label = np.array(pairs).T
    table = contingency(cluster, label)
    matrix = contingency_matrix(label, cluster)
    assert v_measure(table) == pytest.approx(v_measure_score(label, cluster), abs=1e-6)
    assert adjusted_rand_index(table) == pytest.approx(adjusted_rand_score(label, cluster), abs=1e-6)
    assert purity(table) == pytest.approx(matrix.max(axis=0).sum() / len(pairs), abs=1e-6)
    assert inverse_purity(table) == pytest.approx(matrix.max(axis=1).sum() / len(pairs), abs=1e-6)


@given(points, st.permutations(range(6)), st.randoms(use_true_random=False))
def test_names_of_clusters_and_order_of_points_do_not_matter(pairs, names, random) -> None:
    shuffled = random.sample(pairs, len(pairs))
    first, second = np.array(pairs).T, np.array(shuffled).T
    table = contingency(first[0], first[1])
    renamed = contingency(np.array(names)[second[0]], second[1])
    for measure in (purity, inverse_purity, v_measure, adjusted_rand_index, over_segmented):
        assert measure(renamed) == pytest.approx(measure(table), abs=1e-12)
    assert extracted(renamed, [0, 1, 2]) == extracted(table, [0, 1, 2])


def test_one_cluster_a_point_is_pure_and_nothing_else() -> None:
    table = contingency(np.arange(100), np.repeat([1, 2], 50))
    assert purity(table) == 1
    assert inverse_purity(table) == 0.02
    assert adjusted_rand_index(table) == 0
    assert over_segmented(table) == 98
    assert extracted(table, [1, 2]) == 2  # Every cluster goes to its object: over-segmentation is counted apart.


def test_one_cluster_of_everything_is_complete_and_nothing_else() -> None:
    table = contingency(np.zeros(100, int), np.repeat([1, 2], 50))
    assert purity(table) == 0.5
    assert inverse_purity(table) == 1
    assert v_measure(table) == 0
    assert extracted(table, [1, 2]) == 0


def test_no_points_have_no_scores() -> None:
    nothing = contingency(np.zeros(0, int), np.zeros(0, int))
    for measure in (purity, inverse_purity, v_measure, adjusted_rand_index, over_segmented):
        assert measure(nothing) is None
    assert extracted(nothing, [1, 2]) == 0
    assert assigned(nothing, [], [1, 2]) == {}


def test_majority_of_equals_is_the_lowest_class() -> None:
    assert majority(contingency(np.array([5, 5, 6]), np.array([2, 1, 3]))) == {5: 1, 6: 3}


def test_assignment_is_one_to_one_and_counts_points_outside() -> None:
    cluster = np.repeat([1, 1, 2, -1], [60, 40, 50, 50])
    label = np.repeat([10, 20, 20, 10], [60, 40, 50, 50])
    found = assigned(contingency(cluster, label), [1, 2], [10, 20])
    assert found[10] == (1, pytest.approx(2 * 60 / (100 + 110)))
    assert found[20] == (2, pytest.approx(2 * 50 / (50 + 90)))


@pytest.mark.parametrize(("foreign", "count"), [(10, 1), (12, 0)])
def test_an_object_is_extracted_below_ten_percent_of_error(foreign: int, count: int) -> None:
    label = np.repeat([1, 0], [100, foreign])  # 10 of 110 points are too many: 9.1 %; 12 of 112: 10.7 %.
    assert extracted(contingency(np.zeros(len(label), int), label), [1]) == count
