"""One curve for a segment."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made import line, random_rotation, trajectories_of

from algorithm.representative import Curve, representative

seeds = st.integers(0, 2**32)


def body(frames: int, path: np.ndarray, points: int = 30, seed: int = 0) -> list[tuple[int, np.ndarray]]:
    """Points around a path that are seen for a while each, at least two in every frame from first to last."""
    generator = np.random.default_rng(seed)
    offsets = generator.normal(0, 0.2, (points, 3))
    spans = [sorted(generator.choice(frames + 1, 2, replace=False)) for _ in range(points)]
    spans[:2] = [[0, frames], [0, frames]]
    return [(int(a), path[a:b] + offset) for (a, b), offset in zip(spans, offsets, strict=True)]


@given(seeds)
def test_a_rigid_translation_gives_its_path_exactly(seed: int) -> None:
    path = np.random.default_rng(seed).normal(size=(20, 3)).cumsum(axis=0)
    curve = representative(trajectories_of(body(20, path, seed=seed)))
    assert (curve.first, curve.last) == (0, 19)
    np.testing.assert_allclose(np.diff(curve.position, axis=0), np.diff(path, axis=0), atol=1e-9)


def test_it_passes_through_the_centre_of_mass_of_the_densest_frame() -> None:
    made = trajectories_of(body(20, line([0, 0, 3], [0.1, 0, 0], 20)))
    curve = representative(made)
    densest = int(np.argmax(curve.points))
    np.testing.assert_allclose(curve.position[densest], made.position[made.frame == densest].mean(axis=0))
    np.testing.assert_array_equal(curve.points, np.bincount(made.frame))
    assert curve.observed.all()


def test_a_frame_in_which_no_one_is_seen_takes_its_neighbours_step() -> None:
    path = line([0, 0, 3], [0.1, 0.02, 0], 20)
    made = trajectories_of([(5, path[:8]), (15, path[10:])])
    curve = representative(made)
    assert (curve.first, curve.last) == (5, 24)
    np.testing.assert_allclose(np.diff(curve.position, axis=0), np.diff(path, axis=0), atol=1e-9)
    np.testing.assert_array_equal(np.flatnonzero(~curve.observed), [8, 9])


def test_summed_displacements_drift_and_the_correction_draws_them_back() -> None:
    """Points that are followed wrongly by 1 cm a frame, and given up after five."""
    frames = 60
    path = line([0, 0, 3], [0.05, 0, 0], frames)
    paths = []
    for begin in range(0, frames, 5):
        for offset in np.random.default_rng(begin).normal(0, 0.2, (40, 3)):
            slip = np.arange(5)[:, None] * np.array([0.0, 0.01, 0.0])
            paths.append((begin, path[begin : begin + 5] + slip + offset - offset.mean()))
    joint = [(begin + 4, np.stack([path[begin + 4], path[begin + 5]])) for begin in range(0, frames - 5, 5)]
    made = trajectories_of(paths + joint)
    plain = representative(made).position[:, 1]
    corrected = representative(made, drift_frames=10.0).position[:, 1]
    assert np.ptp(plain) > 0.3
    assert np.ptp(corrected) < 0.15


def test_without_drift_the_correction_changes_little() -> None:
    path = line([0, 0, 3], [0.05, 0, 0], 40)
    offsets = np.random.default_rng(0).normal(0, 0.2, (30, 3))
    made = trajectories_of([(0, path + offset) for offset in offsets])
    np.testing.assert_allclose(
        representative(made, drift_frames=8.0).position, representative(made).position, atol=1e-9
    )


@pytest.mark.parametrize("drift_frames", [0.0, 5.0])
@given(seed=seeds)
def test_the_axes_of_the_world_do_not_matter(drift_frames: float, seed: int) -> None:
    made = trajectories_of(body(15, np.random.default_rng(seed).normal(size=(15, 3)).cumsum(axis=0), seed=seed))
    rotation, shift = random_rotation(seed), np.array([1.0, -2.0, 0.5])
    moved = replace(made, position=made.position @ rotation.T + shift)
    np.testing.assert_allclose(
        representative(moved, drift_frames=drift_frames).position,
        representative(made, drift_frames=drift_frames).position @ rotation.T + shift,
        atol=1e-8,
    )


@given(seeds, st.booleans(), st.sampled_from([0.01, 50.0]))
def test_mirror_unit_and_order_do_not_matter(seed: int, mirrored: bool, scale: float) -> None:
    paths = body(15, np.random.default_rng(seed).normal(size=(15, 3)).cumsum(axis=0), seed=seed)
    matrix = scale * random_rotation(seed, mirrored=mirrored)
    expected = representative(trajectories_of(paths)).position @ matrix.T
    mixed = [paths[number] for number in np.random.default_rng(seed).permutation(len(paths))]
    found = representative(trajectories_of([(first, path @ matrix.T) for first, path in mixed]))
    np.testing.assert_allclose(found.position, expected, atol=1e-8 * scale)


def test_a_single_point_in_a_single_frame_has_a_curve() -> None:
    curve = representative(trajectories_of([(7, np.array([[1.0, 2.0, 3.0]]))]), drift_frames=5.0)
    assert (curve.first, curve.last) == (7, 7)
    np.testing.assert_allclose(curve.position, [[1, 2, 3]])


def test_points_that_are_never_followed_leave_the_curve_where_it_is() -> None:
    curve = representative(trajectories_of([(0, np.zeros((1, 3))), (2, np.ones((1, 3)))]))
    np.testing.assert_array_equal(curve.position, np.zeros((3, 3)))


def test_a_part_of_a_curve_keeps_its_frames() -> None:
    curve = Curve(first=10, position=line([0, 0, 0], [1, 0, 0], 8), points=np.arange(8.0))
    part = curve.between(12, 15)
    np.testing.assert_array_equal(part.frames, [12, 13, 14, 15])
    np.testing.assert_array_equal(part.position[:, 0], [2, 3, 4, 5])
    np.testing.assert_array_equal(part.points, [2, 3, 4, 5])
    assert len(curve.between(13, 12).position) == 0


def test_far_from_every_dense_frame_the_last_correction_goes_on() -> None:
    """Points that slip while many are seen must not make the curve jump where few are."""
    step = np.array([0.04, 0.0, 0.0])
    dense = [(0, np.array([0.0, 0.1 * number, 3.0]) + np.outer(np.arange(40), step)) for number in range(20)]
    thin = [(30, np.array([0.9, 0.1 * number, 3.0]) + np.outer(np.arange(90), 1.2 * step)) for number in range(3)]
    curve = representative(trajectories_of(dense + thin), drift_frames=3.0)
    steps = np.diff(curve.position[:, 0])
    assert steps.min() > 0.0
    assert steps.max() < 0.15
