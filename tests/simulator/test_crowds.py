"""Clearances of many crowds at once, against a loop over everything."""

from itertools import combinations

import numpy as np

from simulator.crowds import clearances


def naive(walks: np.ndarray, discs: np.ndarray) -> tuple[float, float]:
    """The smallest distances in one crowd, one pair and one moment at a time."""
    people, beside = [np.inf], [np.inf]
    for moment in range(walks.shape[1]):
        for a, b in combinations(walks[:, moment], 2):
            people.append(float(np.hypot(*(a - b))))
        for place in walks[:, moment]:
            beside.extend(float(np.hypot(*(place - disc[:2])) - disc[2]) for disc in discs)
    return float(np.nanmin(people)), float(np.nanmin(beside))


def test_the_fast_clearances_are_those_of_a_loop() -> None:
    generator = np.random.default_rng(3)
    walks, discs = generator.uniform(-3, 3, (5, 4, 7, 2)), generator.uniform(0.1, 2, (5, 3, 3))
    walks[1, 2] = np.nan
    discs[2, 1, 2] = np.nan
    found = clearances(walks, discs)
    wanted = [naive(own, around) for own, around in zip(walks, discs, strict=True)]
    np.testing.assert_allclose(np.stack([found.people_m, found.discs_m], axis=-1), wanted, rtol=1e-12)


def test_where_nothing_is_to_measure_the_clearance_is_infinite() -> None:
    for people, discs in ((0, 0), (1, 0), (0, 2)):
        found = clearances(np.zeros((3, people, 5, 2)), np.zeros((3, discs, 3)))
        assert np.isinf(found.people_m).all()
        assert np.isinf(found.discs_m).all()
    nobody = clearances(np.full((1, 2, 5, 2), np.nan), np.full((1, 2, 3), np.nan))
    assert np.isinf([*nobody.people_m, *nobody.discs_m]).all()


def test_inside_a_disc_the_clearance_is_negative() -> None:
    found = clearances(np.zeros((1, 1, 2, 2)), np.array([[[0.1, 0.0, 0.5]]]))
    np.testing.assert_allclose(found.discs_m, -0.4)
