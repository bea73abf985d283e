"""Trajectories joined along their motion's curve."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made import line, random_rotation, trajectories_of
from scipy.spatial.transform import Rotation

from algorithm.intra import aligned, bridged, joined
from algorithm.representative import Curve
from algorithm.trajectories import Trajectories

seeds = st.integers(0, 2**32)


def curve_of(position: np.ndarray, first: int = 0) -> Curve:
    return Curve(first=first, position=position, points=np.ones(len(position)))


def bend(frames: int = 30) -> np.ndarray:
    """A path that leaves no rotation open."""
    time = np.arange(frames) / 10
    return np.stack([time, 0.3 * time**2, 0.1 * np.sin(time)], axis=1)


@given(seeds, st.integers(4, 20))
def test_rigid_alignment_is_that_of_scipy(seed: int, frames: int) -> None:
    generator = np.random.default_rng(seed)
    path, own = generator.normal(size=(2, frames, 3))
    alignment = aligned(trajectories_of([(0, own)]), curve_of(path), method="rigid")
    expected, _ = Rotation.align_vectors(own - own.mean(0), path - path.mean(0))
    np.testing.assert_allclose(alignment.rotation[0], expected.as_matrix(), atol=1e-6)
    np.testing.assert_allclose(alignment.shift[0], own.mean(0) - expected.apply(path.mean(0)), atol=1e-6)


@given(seeds)
def test_a_rigid_motion_is_found_exactly(seed: int) -> None:
    rotation, shift = random_rotation(seed), np.array([1.0, -2.0, 0.5])
    made = trajectories_of([(5, bend()[5:15] @ rotation.T + shift), (0, bend())])
    alignment = aligned(made, curve_of(bend()), method="rigid")
    np.testing.assert_allclose(alignment.rotation[0], rotation, atol=1e-5)
    np.testing.assert_allclose(alignment.shift[0], shift, atol=1e-5)
    np.testing.assert_allclose(alignment.rotation[1], np.eye(3), atol=1e-9)


@given(seeds)
def test_a_mirror_image_is_no_rotation(seed: int) -> None:
    mirrored = bend() @ random_rotation(seed, mirrored=True).T
    rotation = aligned(trajectories_of([(0, mirrored)]), curve_of(bend()), method="rigid").rotation[0]
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)


def test_a_short_straight_trajectory_still_gives_a_rotation() -> None:
    straight = line([0, 0, 0], [0.1, 0, 0], 2)
    made = trajectories_of([(0, straight), (0, straight[:1])])
    rotation = aligned(made, curve_of(straight), method="rigid").rotation
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0)


def test_a_translation_meets_the_last_place() -> None:
    made = trajectories_of([(2, bend()[2:9] + np.array([1.0, 2.0, 3.0]))])
    alignment = aligned(made, curve_of(bend()), method="translation")
    assert alignment.rotation is None
    np.testing.assert_allclose(alignment.shift[0], [1, 2, 3])
    np.testing.assert_allclose(
        alignment.extended(np.array([0]), bend()[20:21]), bend()[20:21] + np.array([1.0, 2.0, 3.0])
    )


def hidden(offset: np.ndarray, end: int, begin: int, frames: int = 30) -> list[tuple[int, np.ndarray]]:
    """A point of the motion that is not seen from frame `end` to before frame `begin`."""
    path = bend(frames) + offset
    return [(0, path[:end]), (begin, path[begin:])]


@pytest.mark.parametrize("method", ["rigid", "translation"])
def test_two_halves_of_a_track_are_joined_and_the_gap_lies_on_the_true_path(method) -> None:
    made = trajectories_of(hidden(np.array([0.2, 0.1, 0.0]), 12, 19))
    curve = curve_of(bend())
    alignment = aligned(made, curve, method=method)
    joins = joined(made, curve, alignment, gate_m=0.05, longest_frames=30.0)
    np.testing.assert_array_equal(joins[0], [0])
    np.testing.assert_array_equal(joins[1], [1])
    np.testing.assert_allclose(joins[2], 0.0, atol=1e-6)
    number, frame, place = bridged(made, curve, alignment, joins)
    np.testing.assert_array_equal(number, 0)
    np.testing.assert_array_equal(frame, np.arange(12, 19))
    np.testing.assert_allclose(place, bend()[12:19] + np.array([0.2, 0.1, 0.0]), atol=1e-6)


def found_joins(made: Trajectories, *, gate_m: float, longest_frames: float = 30.0) -> list[tuple[int, int]]:
    curve = curve_of(bend())
    alignment = aligned(made, curve, method="translation")
    before, after, _ = joined(made, curve, alignment, gate_m=gate_m, longest_frames=longest_frames)
    return sorted(zip(before.tolist(), after.tolist(), strict=True))


def test_many_halves_find_their_own() -> None:
    offsets = np.random.default_rng(0).normal(size=(40, 3))
    halves = [hidden(offset, 12, 19) for offset in offsets]
    made = trajectories_of([half[0] for half in halves] + [half[1] for half in halves[::-1]])
    assert found_joins(made, gate_m=0.05) == [(number, 79 - number) for number in range(40)]


def test_the_gate_leaves_strangers_alone() -> None:
    one, other = hidden(np.zeros(3), 12, 19)
    stranger = (19, other[1] + np.array([0.0, 0.3, 0.0]))
    made = trajectories_of([one, stranger])
    assert found_joins(made, gate_m=0.29) == []
    assert found_joins(made, gate_m=0.31) == [(0, 1)]


def test_only_what_is_consecutive_is_joined() -> None:
    path = bend()
    overlapping = trajectories_of([(0, path[:15]), (14, path[14:])])
    assert found_joins(overlapping, gate_m=1.0) == []
    far = trajectories_of([(0, path[:5]), (25, path[25:])])
    assert found_joins(far, gate_m=0.1, longest_frames=20.0) == []
    assert found_joins(far, gate_m=0.1, longest_frames=21.0) == [(0, 1)]


def test_one_beginning_is_joined_to_one_end_only() -> None:
    path = bend()
    made = trajectories_of([(0, path[:10]), (0, path[:10] + 0.02), (15, path[15:] + 0.005)])
    assert found_joins(made, gate_m=0.2) == [(0, 2)]


def test_an_end_without_an_offset_leaves_no_jump() -> None:
    """What the extension misses is spread over the gap: constant steps from end to beginning."""
    still = curve_of(np.zeros((20, 3)))
    made = trajectories_of([(0, np.zeros((5, 3))), (9, np.full((5, 3), 0.1))])
    alignment = aligned(made, still, method="translation")
    joins = joined(made, still, alignment, gate_m=1.0, longest_frames=20.0)
    _, frame, place = bridged(made, still, alignment, joins)
    np.testing.assert_array_equal(frame, [5, 6, 7, 8])
    np.testing.assert_allclose(place[:, 0], 0.02 * np.arange(1, 5))


def test_a_join_without_a_gap_adds_no_place() -> None:
    path = bend()
    made = trajectories_of([(0, path[:10]), (10, path[10:])])
    assert found_joins(made, gate_m=0.1) == [(0, 1)]
    alignment = aligned(made, curve_of(path), method="translation")
    joins = joined(made, curve_of(path), alignment, gate_m=0.1, longest_frames=9.0)
    assert len(bridged(made, curve_of(path), alignment, joins)[1]) == 0
