"""The path of a motion: exact where it is seen, the smoothest where it is not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made import line, person, rows_of, trajectories_of

from algorithm.path import evidence, full_area, path, smoothest

FPS = 30.0
CALM = 0.05


def test_a_steady_motion_is_followed_exactly() -> None:
    made = trajectories_of(person(3, (0, 0, 1), (0.04, 0.01, 0), 30))
    curve = path(rows_of(made, [0] * 200), fps=FPS, restlessness=CALM)
    centre = np.array([made.position[made.frame == frame].mean(axis=0) for frame in range(3, 33)])
    assert (curve.first, curve.last) == (3, 32)
    np.testing.assert_allclose(curve.position, centre, atol=2e-4)
    assert (curve.points == 200).all()


def test_a_hole_is_crossed_straight_by_who_walks_straight() -> None:
    before, after = person(0, (0, 0, 1), (0.04, 0, 0), 30), person(50, (2.0, 0, 1), (0.04, 0, 0), 30)
    curve = path(rows_of(trajectories_of(before + after), [0] * 400), fps=FPS, restlessness=CALM)
    np.testing.assert_allclose(np.diff(curve.position[25:60, 0]), 0.04, atol=1e-3)
    assert (curve.points[30:50] == 0).all()


def test_a_thrown_ball_goes_on_along_its_parabola() -> None:
    time = np.arange(60) / FPS
    flight = np.stack([2 * time, 0 * time, 5 * time - 4.905 * time**2], axis=1)
    offsets = np.random.default_rng(1).normal(size=(20, 3)) * 0.03
    parts = [(first, flight[first:last] + offset) for first, last in ((0, 25), (35, 60)) for offset in offsets]
    curve = path(rows_of(trajectories_of(parts), [0] * 40), fps=FPS, restlessness=10.0)
    miss = curve.position - flight - offsets.mean(axis=0)
    assert np.abs(miss[25:35]).max() < 0.03


def test_a_sliver_does_not_draw_the_path_to_itself() -> None:
    paths = person(0, (0, 0, 1), (0.04, 0, 0), 60, count=100)
    left = sorted(range(100), key=lambda number: -paths[number][1][0, 0])
    for number in left[:90]:  # All but its trailing edge is hidden from frame 40 on.
        paths[number] = (0, paths[number][1][:40])
    curve = path(rows_of(trajectories_of(paths), [0] * 100), fps=FPS, restlessness=CALM)
    np.testing.assert_allclose(np.diff(curve.position[:, 0]), 0.04, atol=4e-3)


def test_one_frame_and_two_frames_have_a_path() -> None:
    for frames in (1, 2):
        curve = path(
            rows_of(trajectories_of(person(0, (0, 0, 1), (0.1, 0, 0), frames)), [0] * 200), fps=FPS, restlessness=CALM
        )
        assert len(curve.position) == frames


@given(seed=st.integers(0, 100))
def test_no_other_path_misses_less(seed: int) -> None:
    generator = np.random.default_rng(seed)
    paths = [
        (int(generator.integers(0, 6)), line((0, 0, 0), (0.1, 0, 0), 5) + generator.normal(size=(5, 3)))
        for _ in range(4)
    ]
    rows = rows_of(trajectories_of(paths), [0] * 4)
    known = evidence(rows, full_area=full_area(rows), fps=FPS)
    place, missed = smoothest(known, fps=FPS, restlessness=1.0)

    def misses(other: np.ndarray) -> float:
        step = np.diff(other, axis=0) - known.step[:-1]
        total = np.sum(known.centre_weight * (other - known.centre) ** 2)
        total += np.sum(known.step_weight[:-1, None] * step**2)
        return float(total + np.sum(FPS**3 * np.diff(other, 2, axis=0) ** 2))

    assert missed == pytest.approx(misses(place))
    for _ in range(5):
        assert misses(place + 1e-3 * generator.normal(size=place.shape)) >= missed


def test_time_reversed_the_path_is_the_same() -> None:
    paths = person(0, (0, 0, 1), (0.04, 0, 0), 20) + person(30, (1.3, 0.2, 1), (0.04, 0.01, 0), 20)
    last = 49
    turned = [(last - (first + len(places) - 1), places[::-1]) for first, places in paths]
    curves = [path(rows_of(trajectories_of(made), [0] * 400), fps=FPS, restlessness=CALM) for made in (paths, turned)]
    np.testing.assert_allclose(curves[0].position, curves[1].position[::-1], atol=5e-3)
