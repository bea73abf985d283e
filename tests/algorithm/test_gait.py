"""Limbs that swing on while they are hidden."""

import numpy as np
import pytest
from made import line, random_rotation, trajectories_of

from algorithm.completion import Completion, completed
from algorithm.gait import found_gait
from algorithm.orbits import harmonics, moments_of
from algorithm.period import period_frames
from algorithm.representative import Curve
from algorithm.settings import Settings
from algorithm.trajectories import Trajectories

FPS = 30.0
FRAMES = 120
PERIOD = 31.0
HIDDEN = (52, 69)
POINTS = 150


def walker(frames: int = FRAMES) -> np.ndarray:
    """Points of a body with two legs and two arms that swing, and a trunk (point, frame, 3), metres."""
    generator = np.random.default_rng(0)
    phase = 2 * np.pi * np.arange(frames) / PERIOD
    height = generator.uniform(0.0, 1.7, POINTS)
    side = generator.choice([-1.0, 1.0], POINTS)
    limb = generator.uniform(size=POINTS) < 0.7
    reach = np.where(limb, 0.35 * np.abs(height - 0.9) / 0.9, 0.01) * np.where(height > 0.9, -1, 1)
    ahead = reach[:, None] * (side[:, None] * np.sin(phase) + 0.2 * np.sin(2 * phase + 1.0))
    up = 0.15 * np.abs(reach[:, None]) * (1 + np.cos(phase + np.where(side > 0, 0, np.pi)[:, None]))
    across = 0.15 * side + generator.normal(0, 0.04, POINTS)
    body = np.stack([ahead, np.broadcast_to(across[:, None], ahead.shape), height[:, None] + up], axis=2)
    return body + path(frames)


def path(frames: int = FRAMES) -> np.ndarray:
    return line([0, 3, 0], [0.045, 0, 0], frames)


def seen_pieces(truth: np.ndarray) -> tuple[Trajectories, np.ndarray]:
    """Trajectories of 10 to 30 frames outside the hole, and the point that each shows."""
    generator = np.random.default_rng(1)
    pieces, point = [], []
    for number, places in enumerate(truth):
        for first, last in ((0, HIDDEN[0] - 1), (HIDDEN[1] + 1, len(places) - 1)):
            begin = first
            while begin < last - 3:
                end = min(last, begin + int(generator.integers(10, 30)))
                pieces.append((begin, places[begin : end + 1]))
                point.append(number)
                begin = end + 1
    return trajectories_of(pieces), np.array(point)


def curve_of(position: np.ndarray, *, hidden: tuple[int, int] | None = HIDDEN) -> Curve:
    points = np.full(len(position), float(POINTS))
    if hidden is not None:
        points[hidden[0] : hidden[1] + 1] = 0
    return Curve(first=0, position=position, points=points)


def completion(made: Trajectories, curve: Curve, **changes: object) -> Completion:
    return completed(
        made,
        np.zeros(made.count, int),
        curve,
        settings=Settings.model_validate(changes),
        spacing_m=0.01,
        fps=FPS,
    )


def errors(found: Completion, truth: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Of the places in the hole."""
    error = np.linalg.norm(found.position - truth[point[found.trajectory], found.frame], axis=1)
    return error[(found.frame >= HIDDEN[0]) & (found.frame <= HIDDEN[1])]


def test_limbs_swing_on_through_a_hole() -> None:
    truth = walker()
    made, point = seen_pieces(truth)
    rigid = errors(completion(made, curve_of(path()), limb_swing=False), truth, point)
    swung = errors(completion(made, curve_of(path())), truth, point)
    assert swung.mean() < 0.4 * rigid.mean()
    assert swung.mean() < 0.05


def test_the_period_is_found() -> None:
    made, _ = seen_pieces(walker())
    gait = found_gait(made, curve_of(path()), fps=FPS, spacing_m=0.01)
    assert gait is not None
    assert gait.period_frames == pytest.approx(PERIOD, rel=0.03)


def test_a_path_that_drifts_hides_no_period() -> None:
    made, _ = seen_pieces(walker())
    off = path() + 0.05 * np.sin(np.arange(FRAMES) / 25)[:, None]
    place = made.position - off[made.frame]
    assert period_frames(made, place, fps=FPS) == pytest.approx(PERIOD, rel=0.05)


@pytest.mark.parametrize("turn", [0.0, 0.03])
def test_what_is_rigid_has_no_gait(turn: float) -> None:
    """Neither a box that slides, noise on it, nor a ball that spins evenly."""
    generator = np.random.default_rng(3)
    offset = generator.normal(0, 0.3, (POINTS, 3))
    angle = turn * np.arange(FRAMES)
    spin = np.stack([np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)], axis=1).reshape(-1, 2, 2)
    truth = path() + np.repeat(offset[:, None], FRAMES, axis=1)
    truth[:, :, :2] = path()[:, :2] + np.einsum("fij,pj->pfi", spin, offset[:, :2])
    truth += generator.normal(0, 0.004, truth.shape)
    made, _ = seen_pieces(truth)
    assert found_gait(made, curve_of(path()), fps=FPS, spacing_m=0.01) is None


def test_a_box_that_slides_is_completed_by_translation_exactly() -> None:
    offset = np.random.default_rng(3).normal(0, 0.3, (POINTS, 1, 3))
    truth = path() + offset
    made, point = seen_pieces(truth)
    assert errors(completion(made, curve_of(path())), truth, point).max() < 1e-9


def test_few_points_tell_nothing() -> None:
    made, _ = seen_pieces(walker()[:8])
    assert found_gait(made, curve_of(path()), fps=FPS, spacing_m=0.01) is None


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_moved_or_mirrored_world_gives_the_same(mirrored: bool) -> None:
    made, _ = seen_pieces(walker())
    turned = random_rotation(5, mirrored=mirrored)
    moved = Trajectories(
        trajectory=made.trajectory,
        frame=made.frame,
        position=made.position @ turned.T + np.array([1.0, -2.0, 0.5]),
        column_row=made.column_row,
    )
    here = completion(made, curve_of(path()))
    there = completion(moved, curve_of(path() @ turned.T + np.array([1.0, -2.0, 0.5])))
    np.testing.assert_array_equal(here.frame, there.frame)
    np.testing.assert_allclose(here.position @ turned.T + np.array([1.0, -2.0, 0.5]), there.position, atol=1e-5)


def test_time_may_run_backwards() -> None:
    truth = walker()
    made, point = seen_pieces(truth)
    order = np.lexsort((-made.frame, made.trajectory))
    reversed_ = Trajectories(
        trajectory=made.trajectory,
        frame=(FRAMES - 1 - made.frame)[order],
        position=made.position[order],
        column_row=made.column_row,
    )
    curve = curve_of(path())
    back = Curve(first=0, position=curve.position[::-1].copy(), points=curve.points[::-1].copy())
    forth = errors(completion(made, curve), truth, point)
    found = completion(reversed_, back)
    error = np.linalg.norm(found.position - truth[point[found.trajectory], FRAMES - 1 - found.frame], axis=1)
    inside = (found.frame >= FRAMES - 1 - HIDDEN[1]) & (found.frame <= FRAMES - 1 - HIDDEN[0])
    assert error[inside].mean() == pytest.approx(forth.mean(), rel=0.3, abs=0.01)


def test_the_order_of_trajectories_hardly_matters() -> None:
    truth = walker()
    made, point = seen_pieces(truth)
    shuffle = np.random.default_rng(7).permutation(made.count)
    mixed = trajectories_of(
        [(int(made.frame[made.first_row[n]]), made.position[made.trajectory == n]) for n in shuffle.tolist()]
    )
    one = errors(completion(made, curve_of(path())), truth, point)
    other = errors(completion(mixed, curve_of(path())), truth, point[shuffle])
    assert other.mean() == pytest.approx(one.mean(), rel=0.3, abs=0.01)


def test_moments_are_the_sums_that_they_say() -> None:
    made, _ = seen_pieces(walker()[:5])
    known = moments_of(made.position, made.frame, made.first_row, period_frames=PERIOD)
    for number in range(made.count):
        rows = made.trajectory == number
        basis = harmonics(made.frame[rows], period_frames=PERIOD)
        np.testing.assert_allclose(known.gram[number], basis.T @ basis, atol=1e-9)
        np.testing.assert_allclose(known.cross[number], basis.T @ made.position[rows], atol=1e-9)
        assert known.length[number] == rows.sum()
