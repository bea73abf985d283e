"""How abruptly a motion changes."""

import numpy as np
import pytest
from made import body, line, person, rows_of, trajectories_of

from algorithm.path import path
from algorithm.restlessness import restless_path, shown_restlessness

FPS = 30.0
CALM = 0.05


def shown(paths: list[tuple[int, np.ndarray]]) -> float:
    return shown_restlessness(rows_of(trajectories_of(paths), np.zeros(len(paths), int)), fps=FPS)


def carried(offsets: list[tuple[int, np.ndarray]], way: np.ndarray) -> list[tuple[int, np.ndarray]]:
    return [(first, places + way) for first, places in offsets]


def walk(frames: int = 90) -> list[tuple[int, np.ndarray]]:
    """A person who bobs by 2 cm and sways by 1.5 cm as people do."""
    phase = 2 * np.pi * np.arange(frames) / 16
    way = line((0, 0, 0), (0.04, 0, 0), frames) + np.stack(
        [0 * phase, 0.015 * np.sin(phase / 2), 0.02 * np.sin(phase)], 1
    )
    return carried(person(0, (0, 0, 0), (0, 0, 0), frames, count=40), way)


def juggled(frames: int = 90) -> list[tuple[int, np.ndarray]]:
    """A ball thrown up at 3 m/s, caught, carried through the hand in 0.2 s, and thrown again."""
    time = np.arange(frames) / FPS
    flight, hand = 2 * 3.0 / 9.81, 0.2
    since = time % (flight + hand)
    in_hand = np.clip((since - flight) / hand, 0, 1)
    up = np.where(since < flight, 3.0 * since - 4.905 * since**2, -0.2 * np.sin(np.pi * in_hand))
    way = np.stack([0.15 * np.cos(np.pi * in_hand), 0 * time, up], axis=1)
    return carried(body(0, (0, 0, 0), (0, 0, 0), frames, half=(0.04, 0.04, 0.04), count=12), way)


def test_a_walker_is_far_calmer_than_a_juggled_ball() -> None:
    assert 0 < shown(walk()) < 0.1 * shown(juggled())


def test_a_straight_path_is_not_restless() -> None:
    assert shown(person(0, (0, 0, 0), (0.04, 0.01, 0), 60, count=40)) == pytest.approx(0, abs=1e-3)


def test_what_is_seen_for_a_moment_tells_nothing() -> None:
    assert np.isnan(shown(person(0, (0, 0, 0), (0.04, 0, 0), 5, count=40)))
    glimpses = [glimpse for first in (0, 20, 40) for glimpse in person(first, (0, 0, 0), (0.04, 0, 0), 6, count=40)]
    assert np.isnan(shown(glimpses))


def test_a_turned_world_is_as_restless() -> None:
    about_the_vertical = np.eye(3)
    about_the_vertical[:2, :2] = [[0.6, -0.8], [0.8, 0.6]]
    turned = [(first, places @ about_the_vertical.T) for first, places in juggled()]
    assert shown(turned) == pytest.approx(shown(juggled()), rel=0.01)


def test_a_walkers_path_is_calm_and_a_balls_follows_its_catches() -> None:
    walker = rows_of(trajectories_of(person(0, (0, 0, 0), (0.04, 0, 0), 60, count=40)), [0] * 40)
    calm = path(walker, fps=FPS, restlessness=CALM)
    np.testing.assert_allclose(restless_path(walker, fps=FPS, calmest=CALM).position, calm.position, atol=1e-9)
    ball = rows_of(trajectories_of(juggled()), [0] * 12)
    followed, stiff = restless_path(ball, fps=FPS, calmest=CALM), path(ball, fps=FPS, restlessness=CALM)
    missed, missed_stiffly = (np.abs(curve.position - ball.centre).max() for curve in (followed, stiff))
    assert missed < 0.5 * missed_stiffly
