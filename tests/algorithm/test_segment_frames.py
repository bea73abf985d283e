"""What is known of each segment in each frame."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made import bare_patches, line, person, random_paths, rows_of, trajectories_of

from algorithm.segment_frames import SegmentFrames, segment_frames


def assert_same(one: SegmentFrames, other: SegmentFrames) -> None:
    for name, column in vars(one).items():
        np.testing.assert_allclose(column, vars(other)[name], rtol=1e-6, atol=1e-6, err_msg=name)


def test_a_body_in_motion_has_its_centre_step_and_outline() -> None:
    made = trajectories_of(person(3, (0, 0, 1), (0.04, 0.01, 0), 5))
    rows = rows_of(made, [0] * 200)
    assert rows.frame.tolist() == [3, 4, 5, 6, 7]
    assert (rows.points == 200).all()
    assert (rows.followed > 0).tolist() == [True] * 4 + [False]
    np.testing.assert_allclose(rows.step[:-1], np.tile([0.04, 0.01, 0], (4, 1)), atol=1e-9)
    for frame, centre, low, high in zip(rows.frame, rows.centre, rows.low, rows.high, strict=True):
        place = made.position[made.frame == frame]
        np.testing.assert_allclose(centre, place.mean(axis=0), atol=1e-3)
        np.testing.assert_allclose([low[0], low[-1]], place.min(axis=0)[[0, 2]], rtol=1e-6)
        np.testing.assert_allclose([high[0], high[-1]], place.max(axis=0)[[0, 2]], rtol=1e-6)


def test_the_area_does_not_shrink_with_distance() -> None:
    """A hundred pixels at 2 m show as much as 25 at 4 m do."""
    made = trajectories_of(
        [(0, line((0, 2, 0), (0, 0, 0), 1))] * 100 + [(0, line((0, 4, 0), (0, 0, 0), 1))] * 25  # The camera is at 0.
    )
    segment = np.repeat([0, 1], [100, 25])
    rows = segment_frames(made, segment, bare_patches(made), camera_position=np.zeros(3))
    assert rows.area[0] == pytest.approx(rows.area[1])


def test_noise_and_nothing_have_no_rows() -> None:
    assert rows_of(trajectories_of([]), np.zeros(0, int)).count == 0
    made = trajectories_of(random_paths(0))
    assert len(rows_of(made, [-1] * 8).frame) == 0
    assert rows_of(made, [-1] * 8).singles() == []


@given(seed=st.integers(0, 300))
@settings(max_examples=40)
def test_renamed_rows_are_the_rows_of_the_renamed_segments(seed: int) -> None:
    generator = np.random.default_rng(seed)
    made = trajectories_of(random_paths(seed))
    segment = generator.permutation(np.r_[np.arange(5), generator.integers(-1, 5, 3)])
    name = generator.integers(-1, 3, 5)
    renamed = np.where(segment >= 0, name[segment], -1)
    assert_same(rows_of(made, segment).renamed(name), rows_of(made, renamed))


@given(seed=st.integers(0, 100))
@settings(max_examples=40)
def test_single_segments_put_together_are_the_union(seed: int) -> None:
    made = trajectories_of(random_paths(seed))
    rows = rows_of(made, np.arange(8) % 2)
    one, other = rows.singles()
    assert_same(SegmentFrames.together(one, other), rows_of(made, np.zeros(8, int)))
    assert_same(one, rows_of(made, np.where(np.arange(8) % 2, -1, 0)))
