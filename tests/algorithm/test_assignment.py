"""The sparse assignment against SciPy's dense one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from algorithm.assignment import cheapest_assignment

seeds = st.integers(0, 2**32)
ALONE = 1.0


@given(seeds, st.integers(1, 9), st.integers(1, 9), st.booleans())
def test_it_costs_as_little_as_scipys_dense_one(seed: int, rows: int, columns: int, ties: bool) -> None:
    cost = np.random.default_rng(seed).uniform(0, 1.5, (rows, columns))
    cost = np.round(4 * cost) / 4 if ties else cost
    row, column = np.nonzero(cost <= ALONE)
    chosen = cheapest_assignment(row, column, cost[row, column], alone=ALONE)
    assert len(np.unique(row[chosen])) == len(chosen) == len(np.unique(column[chosen]))
    dense = np.concatenate([np.where(cost <= ALONE, cost, 1e6), np.full((rows, rows), ALONE)], axis=1)
    best = dense[linear_sum_assignment(dense)].sum()
    assert cost[row[chosen], column[chosen]].sum() + ALONE * (rows - len(chosen)) == pytest.approx(best)


@given(seeds)
def test_the_order_of_pairs_and_the_names_do_not_matter(seed: int) -> None:
    generator = np.random.default_rng(seed)
    row, column = np.nonzero(generator.uniform(size=(6, 6)) < 0.6)
    cost = generator.uniform(0, 1, len(row))
    chosen = cheapest_assignment(row, column, cost, alone=ALONE)
    mixed = generator.permutation(len(row))
    again = cheapest_assignment(7 * row[mixed] + 3, column[mixed] - 4, cost[mixed], alone=ALONE)
    np.testing.assert_array_equal(np.sort(mixed[again]), chosen)


def test_nothing_to_choose_from_is_nothing() -> None:
    nothing = np.zeros(0, int)
    assert len(cheapest_assignment(nothing, nothing, np.zeros(0), alone=ALONE)) == 0
