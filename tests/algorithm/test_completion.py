"""The places of a motion's points in its holes."""

import numpy as np
import pytest
from made import line, trajectories_of

from algorithm.completion import Completion, completed
from algorithm.faint import faint_stretches
from algorithm.representative import Curve
from algorithm.settings import Settings
from recording.motions import INTER, INTRA

FRAMES = 60
PATH = line([0, 0, 3], [0.05, 0, 0], FRAMES)


def curve_with_holes(*hidden: tuple[int, int]) -> Curve:
    points = np.full(FRAMES, 50.0)
    for first, last in hidden:
        points[first : last + 1] = 0
    return Curve(first=0, position=PATH, points=points)


def completion(
    paths: list[tuple[int, np.ndarray]], curve: Curve, segment: list[int] | None = None, **changes: object
) -> Completion:
    return completed(
        trajectories_of(paths),
        np.array(segment or [0] * len(paths)),
        curve,
        settings=Settings.model_validate(changes),
        spacing_m=0.01,
        fps=30.0,
    )


def seen(first: int, last: int, offset: float = 0.0) -> tuple[int, np.ndarray]:
    return first, PATH[first : last + 1] + np.array([0.0, offset, 0.0])


def test_what_no_one_saw_is_hidden() -> None:
    assert faint_stretches(curve_with_holes((10, 14), (30, 30)), share=0.0, fps=30.0) == [(10, 14), (30, 30)]
    assert faint_stretches(curve_with_holes(), share=0.5, fps=30.0) == []


def test_what_is_seen_for_a_small_part_counts_as_hidden() -> None:
    curve = curve_with_holes((20, 24))
    curve.points[[18, 19, 25, 40]] = [30, 20, 24, 24]
    assert faint_stretches(curve, share=0.5, fps=30.0) == [(19, 25), (40, 40)]


@pytest.mark.parametrize(("segment", "source"), [([0, 0], INTRA), ([0, 1], INTER)])
def test_a_joined_pair_fills_its_gap_and_says_why(segment: list[int], source: int) -> None:
    found = completion([seen(0, 19, 0.1), seen(30, 59, 0.1)], curve_with_holes((20, 29)), segment)
    np.testing.assert_array_equal(found.frame, np.arange(20, 30))
    np.testing.assert_array_equal(found.trajectory, 0)
    np.testing.assert_array_equal(found.source, source)
    np.testing.assert_allclose(found.position, PATH[20:30] + np.array([0.0, 0.1, 0.0]), atol=1e-9)
    assert (found.confidence > 0.8).all()
    np.testing.assert_array_equal(np.concatenate(found.joins), [0, 1])


def test_a_point_without_a_partner_follows_the_motion_through_the_hole() -> None:
    found = completion([seen(0, 17, 0.3), seen(31, 59, -0.3)], curve_with_holes((20, 29)))
    for trajectory, frames, offset in ((0, np.arange(18, 30), 0.3), (1, np.arange(20, 31), -0.3)):
        rows = found.trajectory == trajectory
        np.testing.assert_array_equal(np.sort(found.frame[rows]), frames)
        expected = PATH[found.frame[rows]] + np.array([0.0, offset, 0.0])
        np.testing.assert_allclose(found.position[rows], expected, atol=1e-9)
    assert len(found.joins[0]) == 0


def test_the_paper_leaves_it_unfilled() -> None:
    found = completion([seen(0, 19, 0.3)], curve_with_holes((20, 29)), complete_unmatched=False)
    assert len(found.frame) == 0


def test_who_vanished_long_before_the_hole_is_not_continued() -> None:
    assert len(completion([seen(0, 5)], curve_with_holes((30, 39)), border_seconds=0.5).frame) == 0


@pytest.mark.parametrize("gap", [1, 3, 8, 20])
@pytest.mark.parametrize("end", [14, 17, 19, 22])
def test_no_point_is_twice_in_a_frame_however_near_the_holes(gap: int, end: int) -> None:
    curve = curve_with_holes((20, 24), (25 + gap, 29 + gap))
    paths = [seen(0, end, 0.1), seen(22, 25 + gap, 0.5), seen(26 + gap, 59, -0.4), seen(30 + gap, 59, 0.3)]
    found = completion(paths, curve)
    own = {(number, first + step) for number, (first, path) in enumerate(paths) for step in range(len(path))}
    rows = list(zip(found.trajectory.tolist(), found.frame.tolist(), strict=True))
    assert len(set(rows)) == len(rows)
    assert not own & set(rows)
