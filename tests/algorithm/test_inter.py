"""Segments joined across holes."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import line, random_rotation
from numpy.polynomial import Chebyshev

from algorithm.inter import (
    chains,
    fitted_polynomial,
    joined_by_polynomials,
    merged_curve,
    polynomial_links,
    smoothest_polynomial,
)
from algorithm.representative import Curve

seeds = st.integers(0, 2**32)


def curve_of(position: np.ndarray, first: int = 0, points: np.ndarray | None = None) -> Curve:
    return Curve(first=first, position=position, points=np.full(len(position), 50.0) if points is None else points)


def straight(start: list[float], step: list[float], first: int, frames: int) -> Curve:
    """Part of an endless line: `start` is its place in frame 0."""
    return curve_of(line(start, step, first + frames)[first:], first)


def links_of(curves: list[Curve], eps6_m: float = 0.15) -> set[tuple[int, int]]:
    return set(polynomial_links(curves, eps6_m=eps6_m))


@given(seeds, st.integers(2, 7))
def test_the_polynomial_is_numpys_chebyshev_fit(seed: int, degree: int) -> None:
    generator = np.random.default_rng(seed)
    before = curve_of(generator.normal(size=(12, 3)), 5)
    after = curve_of(generator.normal(size=(9, 3)), 30)
    found = fitted_polynomial(before, after, degree=degree)
    frame = np.concatenate([before.frames, after.frames])
    place = np.concatenate([before.position, after.position])
    expected = [Chebyshev.fit(frame, place[:, axis], degree) for axis in range(3)]
    asked = np.arange(5.0, 39.0)
    np.testing.assert_allclose(found.at(asked), np.stack([fit(asked) for fit in expected], axis=1), atol=1e-8)
    miss = np.linalg.norm(found.at(frame.astype(float)) - place, axis=1)
    assert found.error_m == pytest.approx(miss[:12].mean() + miss[12:].mean())
    assert found.cost == pytest.approx(found.error_m * np.e**degree)


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_the_lowest_degree_that_will_do_is_taken(degree: int) -> None:
    time = np.linspace(-1, 1, 40)
    path = np.stack([time**degree, time, 0 * time], axis=1)
    found = smoothest_polynomial(curve_of(path[:15]), curve_of(path[25:], 25), eps6_m=1e-3)
    assert found is not None
    assert found.degree == degree
    np.testing.assert_allclose(found.at(np.arange(15.0, 25.0)), path[15:25], atol=1e-9)


def test_a_straight_path_needs_no_more_than_degree_two() -> None:
    found = smoothest_polynomial(
        straight([0, 0, 0], [1, 0, 0], 0, 9), straight([0, 0, 0], [1, 0, 0], 15, 9), eps6_m=1.0
    )
    assert found is not None
    assert found.degree == 2


def test_where_no_polynomial_will_do_there_is_none() -> None:
    noise = np.random.default_rng(0).normal(size=(40, 3))
    assert smoothest_polynomial(curve_of(noise[:20]), curve_of(noise[20:], 30), eps6_m=0.1) is None


def test_a_degree_needs_more_places_than_coefficients() -> None:
    """Two and two places are met exactly by degree three, which would say nothing."""
    jagged = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 0], [1, 0, 0]])
    assert smoothest_polynomial(curve_of(jagged[:2]), curve_of(jagged[2:], 10), eps6_m=0.01) is None


@given(seeds, st.integers(2, 7))
def test_the_polynomial_is_that_of_polyfit(seed: int, degree: int) -> None:
    """As the power series in frames that the paper prints."""
    generator = np.random.default_rng(seed)
    before, after = curve_of(generator.normal(size=(9, 3))), curve_of(generator.normal(size=(7, 3)), 12)
    frame = np.concatenate([before.frames, after.frames])
    powers = np.polyfit(frame, np.concatenate([before.position, after.position]), degree)
    asked = np.arange(0.0, 19.0, 0.25)
    expected = np.stack([np.polyval(powers[:, axis], asked) for axis in range(3)], axis=1)
    np.testing.assert_allclose(fitted_polynomial(before, after, degree=degree).at(asked), expected, atol=1e-5)


def crossing() -> list[Curve]:
    """Two straight paths whose crossing no one sees."""
    right, left = ([0.0, 0.0, 3.0], [0.05, 0.0, 0.0]), ([3.0, 0.0, 4.0], [-0.05, 0.0, 0.0])
    return [
        straight(*right, first=0, frames=20),
        straight(*left, first=0, frames=20),
        straight(*left, first=40, frames=20),
        straight(*right, first=40, frames=20),
    ]


def backwards(curve: Curve, frames: int = 200) -> Curve:
    return curve_of(curve.position[::-1], frames - 1 - curve.last, curve.points[::-1])


def test_links_make_chains_in_the_order_of_time() -> None:
    polynomial = fitted_polynomial(*crossing()[:1], crossing()[3], degree=2)
    links = {(3, 1): polynomial, (1, 0): polynomial, (4, 5): polynomial}
    assert chains(links, 6) == [[2], [3, 1, 0], [4, 5]]
    assert chains({}, 2) == [[0], [1]]
    assert chains({}, 0) == []


def test_paths_through_a_hole_go_straight_on() -> None:
    assert links_of(crossing()) == {(0, 3), (1, 2)}


def test_a_newcomer_stays_alone_if_no_polynomial_leads_to_him() -> None:
    newcomer = straight([0.0, 3.0, 1.0], [0.0, -0.05, 0.0], 45, 20)
    assert links_of([*crossing(), newcomer], eps6_m=0.05) == {(0, 3), (1, 2)}


def test_links_make_chains_and_may_be_any_time_apart() -> None:
    path = ([0.0, 0.0, 0.0], [0.05, 0.01, 0.0])
    assert links_of([straight(*path, 60, 15), straight(*path, 0, 15), straight(*path, 30, 15)]) == {(1, 2), (2, 0)}
    assert links_of([straight(*path, 0, 15), straight(*path, 400, 15)]) == {(0, 1)}
    assert links_of([straight(*path, 0, 15), straight(*path, 14, 15)]) == set()


@pytest.mark.parametrize("count", [0, 1])
def test_no_one_has_no_partner(count: int) -> None:
    assert links_of(crossing()[:count]) == set()


def test_two_alike_side_by_side_each_go_on_as_themselves() -> None:
    curves = [straight([0.0, y, 0.0], [0.05, 0.0, 0.0], first, 20) for y in (0.0, 1.0) for first in (0, 30)]
    assert links_of(curves) == {(0, 1), (2, 3)}


def scattered(seed: int, count: int = 5) -> list[Curve]:
    """Short noisy lines, here and there in time."""
    generator = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        start, step = generator.normal(size=3), generator.normal(0, 0.05, 3)
        part = straight(start.tolist(), step.tolist(), int(generator.integers(0, 60)), int(generator.integers(5, 20)))
        found.append(curve_of(part.position + generator.normal(0, 0.002, part.position.shape), part.first))
    return found


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_the_links_are_as_many_as_can_be_and_the_cheapest_of_these(seed: int) -> None:
    """Against all ways to assign: the number first, then the cost."""
    curves = scattered(seed)
    cost = {}
    for i, before in enumerate(curves):
        for j, after in enumerate(curves):
            found = smoothest_polynomial(before, after, eps6_m=0.3) if before.last < after.first else None
            if found is not None:
                cost[i, j] = found.cost
    ways = [[pair for pair in enumerate(order) if pair in cost] for order in permutations(range(len(curves)))]
    best = min((-len(way), sum(cost[pair] for pair in way)) for way in ways)
    links = polynomial_links(curves, eps6_m=0.3)
    assert len(links) == -best[0]
    assert sum(found.cost for found in links.values()) == pytest.approx(best[1])


@settings(max_examples=20, deadline=None)
@given(seeds, st.booleans(), st.sampled_from([0.01, 1.0, 50.0]))
def test_the_links_do_not_depend_on_axes_mirror_or_unit(seed: int, mirrored: bool, scale: float) -> None:
    curves = scattered(seed)
    matrix = scale * random_rotation(seed, mirrored=mirrored)
    changed = [curve_of(curve.position @ matrix.T + [1.0, 2.0, 3.0], curve.first) for curve in curves]
    assert links_of(changed, eps6_m=0.3 * scale) == links_of(curves, eps6_m=0.3)


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_the_links_are_the_same_backwards_in_time_and_in_any_order(seed: int) -> None:
    curves = scattered(seed)
    reverse = links_of([backwards(curve) for curve in curves], eps6_m=0.3)
    assert {(after, before) for before, after in reverse} == links_of(curves, eps6_m=0.3)
    order = np.random.default_rng(seed).permutation(len(curves)).tolist()
    mixed = links_of([curves[number] for number in order], eps6_m=0.3)
    assert {(order[before], order[after]) for before, after in mixed} == links_of(curves, eps6_m=0.3)


def test_a_motions_curve_lies_on_the_polynomial_in_the_hole_and_may_jump() -> None:
    before = curve_of(line([0, 0, 0], [0.05, 0, 0], 20) + np.array([0.0, 0.05, 0.0]))
    after = straight([0, 0, 0], [0.05, 0, 0], 30, 20)
    polynomial = fitted_polynomial(before, after, degree=2)
    whole = merged_curve([before, after], [polynomial])
    assert (whole.first, whole.last) == (0, 49)
    np.testing.assert_array_equal(whole.position[20:30], polynomial.at(np.arange(20.0, 30.0)))
    np.testing.assert_array_equal(
        np.delete(whole.position, np.arange(20, 30), axis=0), np.concatenate([before.position, after.position])
    )
    np.testing.assert_array_equal(np.flatnonzero(~whole.observed), np.arange(20, 30))
    assert np.linalg.norm(np.diff(whole.position, axis=0), axis=1).max() > 0.051


def test_known_pairs_get_the_lowest_degree_even_where_none_is_good_enough() -> None:
    curves = scattered(3, count=2)
    curves = [curves[0], curve_of(curves[1].position, curves[0].last + 10)]
    found = joined_by_polynomials(curves, [(0, 1)], eps6_m=1e-9)
    assert found[0, 1].degree == 2
    assert found[0, 1].error_m > 1e-9
