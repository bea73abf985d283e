"""Standing feet: what slides is measured, what walks is not blamed."""

import numpy as np
import pytest

from recording.feet import foot_sink_m, foot_slide_m
from recording.truth import MeshSequence


def feet(*tracks: list[tuple[float, float]]) -> MeshSequence:
    """A body of one vertex a foot, each at (x, z) in every frame, and a head."""
    places = [[(x, 0.0, z) for x, z in track] for track in tracks]
    head = [(0.0, 0.0, 1.7)] * len(tracks[0])
    vertices = np.array([*places, head], np.float32).transpose(1, 0, 2)
    return MeshSequence(faces=np.array([[0, 1, 1]], np.int32), vertices=vertices)


def test_a_walk_with_planted_feet_does_not_slide() -> None:
    left = [(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.4, 0.08), (0.8, 0.0)]
    right = [(-0.4, 0.002), (0.0, 0.1), (0.4, 0.0), (0.4, 0.0), (0.4, 0.0)]
    assert foot_slide_m(feet(left, right)) == 0.0


def test_the_way_from_where_a_foot_came_down_counts() -> None:
    slow = [(0.01 * number, 0.0) for number in range(6)]
    assert foot_slide_m(feet(slow)) == pytest.approx(0.05, abs=1e-6)
    back = [(0.0, 0.0), (0.03, 0.0), (0.0, 0.0)]
    assert foot_slide_m(feet(back)) == pytest.approx(0.03, abs=1e-6)


def test_a_foot_that_was_lifted_begins_anew() -> None:
    stepping = [(0.0, 0.0), (0.0, 0.0), (0.2, 0.1), (0.4, 0.0), (0.41, 0.0)]
    standing = [(0.1, 0.0)] * 5
    assert foot_slide_m(feet(stepping, standing)) == pytest.approx(0.01, abs=1e-6)


def test_a_foot_that_swings_low_over_the_ground_does_not_stand() -> None:
    standing = [(0.1, 0.0)] * 4
    swinging = [(0.2 * number, 0.008) for number in range(4)]
    assert foot_slide_m(feet(standing, swinging)) == 0.0


def test_nothing_slides_in_the_air() -> None:
    assert foot_slide_m(feet([(0.5 * number, 0.3) for number in range(4)])) == 0.0


def test_the_deepest_point_of_any_frame_counts() -> None:
    assert foot_sink_m(feet([(0.0, 0.0), (0.0, -0.03), (0.0, 0.01)])) == pytest.approx(0.03)
    assert foot_sink_m(feet([(0.0, 0.2), (0.0, 0.1)])) == 0.0
