"""Segments joined across holes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made import line, random_rotation, trajectories_of
from numpy.polynomial import Chebyshev
from worlds import small_camera

from algorithm.inter import (
    chain_curve,
    chains,
    fitted_polynomial,
    linked,
    seen_areas,
    smoothest_polynomial,
    trusted,
)
from algorithm.representative import Curve

seeds = st.integers(0, 2**32)


def curve_of(position: np.ndarray, first: int = 0, points: np.ndarray | None = None) -> Curve:
    return Curve(first=first, position=position, points=np.full(len(position), 50.0) if points is None else points)


def straight(start: list[float], step: list[float], first: int, frames: int) -> Curve:
    """Part of an endless line: `start` is its place in frame 0."""
    return curve_of(line(start, step, first + frames)[first:], first)


def links_of(curves: list[Curve], eps6_m: float = 0.15, weight: np.ndarray | None = None) -> set[tuple[int, int]]:
    weight = np.ones(len(curves)) if weight is None else weight
    return set(linked(curves, curves, weight, eps6_m=eps6_m, ends_frames=30.0, longest_frames=90.0))


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


def crossing() -> list[Curve]:
    """Two straight paths whose crossing no one sees."""
    right, left = ([0.0, 0.0, 3.0], [0.05, 0.0, 0.0]), ([3.0, 0.0, 4.0], [-0.05, 0.0, 0.0])
    return [
        straight(*right, first=0, frames=20),
        straight(*left, first=0, frames=20),
        straight(*left, first=40, frames=20),
        straight(*right, first=40, frames=20),
    ]


def test_paths_through_a_hole_go_straight_on() -> None:
    assert links_of(crossing()) == {(0, 3), (1, 2)}


def test_a_newcomer_stays_alone() -> None:
    newcomer = straight([0.0, 3.0, 1.0], [0.0, -0.05, 0.0], 45, 20)
    assert links_of([*crossing(), newcomer]) == {(0, 3), (1, 2)}


def test_what_overlaps_in_time_or_lies_too_far_apart_is_not_linked() -> None:
    path = ([0.0, 0.0, 0.0], [0.05, 0.0, 0.0])
    assert links_of([straight(*path, 0, 20), straight(*path, 19, 20)]) == set()
    assert links_of([straight(*path, 0, 20), straight(*path, 20, 20)]) == {(0, 1)}
    assert links_of([straight(*path, 0, 20), straight(*path, 109, 20)]) == {(0, 1)}
    assert links_of([straight(*path, 0, 20), straight(*path, 110, 20)]) == set()


def test_three_in_a_row_are_a_chain() -> None:
    path = ([0.0, 0.0, 0.0], [0.05, 0.01, 0.0])
    curves = [straight(*path, 60, 15), straight(*path, 0, 15), straight(*path, 30, 15)]
    assert links_of(curves) == {(1, 2), (2, 0)}


def moved(curve: Curve, seed: int) -> Curve:
    return curve_of(curve.position @ random_rotation(seed).T + [1.0, 2.0, 3.0], curve.first, curve.points)


@given(seeds)
def test_the_axes_of_the_world_do_not_matter(seed: int) -> None:
    assert links_of([moved(curve, seed) for curve in crossing()]) == links_of(crossing())


def backwards(curve: Curve, frames: int = 200) -> Curve:
    return curve_of(curve.position[::-1], frames - 1 - curve.last, curve.points[::-1])


@given(seeds)
def test_backwards_in_time_the_links_are_the_same(seed: int) -> None:
    generator = np.random.default_rng(seed)
    curves = []
    for _ in range(6):
        start, step = generator.normal(size=3), generator.normal(0, 0.05, 3)
        frames = int(generator.integers(5, 20))
        curve = straight(start.tolist(), step.tolist(), int(generator.integers(0, 60)), frames)
        curves.append(curve_of(curve.position + generator.normal(0, 0.002, (frames, 3)), curve.first))
    reverse = links_of([backwards(curve) for curve in curves], eps6_m=0.3)
    assert {(after, before) for before, after in reverse} == links_of(curves, eps6_m=0.3)


def test_a_scrap_does_not_take_a_bodys_partner() -> None:
    """The scrap fits a little better, but the body would stay alone for it."""
    body = straight([0.0, 0.0, 0.0], [0.05, 0.0, 0.0], 0, 20)
    wavy = body.position + 0.02 * np.sin(np.arange(20))[:, None] * [0.0, 1.0, 0.0]
    curves = [curve_of(wavy), body, straight([0.0, 0.0, 0.0], [0.05, 0.0, 0.0], 40, 20)]
    assert links_of(curves) == {(1, 2)}
    assert links_of(curves, weight=np.array([1.0, 1e-5, 1.0])) == {(0, 2)}


@pytest.mark.parametrize("count", [0, 1])
def test_no_one_has_no_partner(count: int) -> None:
    assert links_of(crossing()[:count]) == set()


def test_areas_do_not_depend_on_the_distance() -> None:
    near, far = line([0, 0, 2], [0, 0, 0], 4), line([0, 0, 4], [0, 0, 0], 1)
    made = trajectories_of([(0, near), (0, far), (0, far)])
    np.testing.assert_allclose(seen_areas(made, np.array([0, 1, -1]), camera=small_camera()), [1.0, 1.0])


def test_faint_ends_do_not_count() -> None:
    points = np.array([1.0, 5, 50, 60, 55, 12, 40, 7, 2])
    curve = curve_of(line([0, 0, 0], [1, 0, 0], 9), 10, points)
    kept = trusted(curve, share=0.2, window_frames=5)  # The medians there are 50 and 12.
    assert (kept.first, kept.last) == (12, 17)
    np.testing.assert_array_equal(kept.position[:, 0], np.arange(2, 8))
    whole = trusted(curve, share=0.0, window_frames=5)
    assert (whole.first, whole.last) == (10, 18)


def test_links_make_chains_in_the_order_of_time() -> None:
    polynomial = fitted_polynomial(*crossing()[:1], crossing()[3], degree=2)
    links = {(3, 1): polynomial, (1, 0): polynomial, (4, 5): polynomial}
    assert chains(links, 6) == [[2], [3, 1, 0], [4, 5]]
    assert chains({}, 2) == [[0], [1]]
    assert chains({}, 0) == []


def test_a_motions_curve_passes_through_its_segments_and_on_the_polynomial_between() -> None:
    time = np.linspace(-1, 1, 60)
    path = np.stack([time, time**2, 0 * time], axis=1)
    curves = [curve_of(path[:20]), curve_of(path[35:], 35)]
    polynomial = fitted_polynomial(*curves, degree=2)
    whole = chain_curve(curves, curves, [polynomial])
    assert (whole.first, whole.last) == (0, 59)
    np.testing.assert_allclose(whole.position, path, atol=1e-9)
    np.testing.assert_array_equal(whole.observed, (np.arange(60) < 20) | (np.arange(60) >= 35))


def test_what_the_polynomial_misses_leaves_no_jump() -> None:
    before = curve_of(line([0, 0, 0], [0.05, 0, 0], 20) + np.array([0.0, 0.05, 0.0]))
    after = straight([0, 0, 0], [0.05, 0, 0], 30, 20)
    whole = chain_curve([before, after], [before, after], [fitted_polynomial(before, after, degree=2)])
    assert np.abs(np.diff(whole.position, axis=0)).max() < 0.06
    np.testing.assert_array_equal(whole.position[:20], before.position)
    np.testing.assert_array_equal(whole.position[30:], after.position)


def test_faint_ends_are_replaced_at_a_hole_and_kept_at_the_ends_of_a_motion() -> None:
    position = line([0, 0, 0], [0.05, 0, 0], 60)
    wrong = position.copy()
    wrong[[0, 19, 35, 59]] += [0.0, 0.5, 0.0]
    curves = [curve_of(wrong[:20]), curve_of(wrong[35:], 35)]
    ends = [curves[0].between(1, 18), curves[1].between(36, 58)]
    whole = chain_curve(curves, ends, [fitted_polynomial(*ends, degree=2)])
    assert (whole.first, whole.last) == (0, 59)
    np.testing.assert_allclose(whole.position[1:59], position[1:59], atol=1e-9)
    np.testing.assert_allclose(whole.position[[0, 59]], wrong[[0, 59]])
    np.testing.assert_array_equal(np.flatnonzero(~whole.observed), np.arange(19, 36))
