"""Jugglers on a scene: what is recorded of them, and what another seed changes."""

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from recording.recording import Recording
from recording.verify import verify
from simulator.backend import find_backend
from simulator.juggler import juggling_act
from simulator.pictures import pictures
from simulator.scene import Scene, load_scene
from simulator.simulate import prepared, simulate
from simulator.stage import frame_times
from simulator.variation import varied

SMALL: dict[str, Any] = {
    "name": "small",
    "frames": 6,
    "fps": 20,
    "camera": {"width": 100, "height": 75, "position": [0, -3, 1.4], "look_at": [0, 0, 1]},
    "jugglers": [{"body": "teen", "siteswap": [3], "beat_s": 0.25, "dwell_s": 0.3}],
    "balls": [{"radius": 0.1, "waypoints": [[1, 0, 1], [1, 0, 2]], "speed": 1}],
    "obstacles": [{"shape": "box", "size": [0.2, 0.2, 1], "position": [-1, 0, 0]}],
}


@pytest.fixture(scope="module")
def recording() -> Recording:
    return simulate(Scene.model_validate(SMALL))


def test_the_juggler_counts_as_standing_and_each_ball_as_an_object(recording: Recording) -> None:
    objects = recording.metadata.objects or ()
    assert [(entry.name, entry.kind, entry.moving) for entry in objects] == [
        ("juggler 1", "juggler", False),
        ("ball 1", "ball", True),
        ("ball 2", "ball", True),
        ("ball 3", "ball", True),
        ("ball 4", "ball", True),
        ("box 1", "box", False),
    ]


def test_the_jugglers_arms_move_in_the_pictures_but_only_balls_have_an_x_ray(recording: Recording) -> None:
    labels = [frame.labels.objectid == 1 for frame in recording.frames if frame.labels is not None]
    assert any((labels[0] != later).any() for later in labels[1:])
    assert recording.xray is not None
    assert set(recording.xray[3]) == {2, 3, 4, 5}
    assert recording.truth is not None
    assert len(recording.truth[1].vertices) == 6


def test_a_recording_of_a_juggler_passes_its_own_check(recording: Recording) -> None:
    report = verify(recording)
    assert report.passes, report.text


def test_a_share_of_the_frames_shows_the_juggler_as_in_these_frames(recording: Recording) -> None:
    stage = prepared(Scene.model_validate(SMALL)).stage.every(3, begin=1)
    for number, (frame, _) in zip((1, 4), pictures(stage, find_backend("auto")), strict=True):
        np.testing.assert_array_equal(frame.depth, recording.frames[number].depth)


@pytest.mark.parametrize("name", ["juggler3", "juggler5"])
@pytest.mark.parametrize("seed", [*range(1, 21), *range(1001, 1011)])
def test_on_another_day_balls_keep_apart_and_hands_reach_them(name: str, seed: int) -> None:
    given = load_scene(name)
    day = varied(given, seed)
    juggler, usual = day.jugglers[0], given.jugglers[0]
    act = juggling_act(juggler, np.arange(0, 3, 0.005))
    nearest = min(np.linalg.norm(a - b, axis=-1).min() for a, b in combinations(act.balls, 2))
    assert nearest > 2 * juggler.ball_radius
    assert np.linalg.norm(np.subtract(juggler.position, usual.position)) <= 0.3 + 1e-4
    assert 1 / 1.15 - 1e-3 <= juggler.beat_s / usual.beat_s <= 1 / 0.85 + 1e-3
    assert juggler.dwell_s / juggler.beat_s == pytest.approx(usual.dwell_s / usual.beat_s, rel=0.01)


def test_seeds_differ_and_repeat() -> None:
    given = load_scene("juggler3")
    assert varied(given, 0) == given
    assert varied(given, 3) == varied(given, 3) != varied(given, 4)
    days = [varied(given, seed).jugglers[0] for seed in range(1, 21)]
    assert len({day.body for day in days}) == 4
    assert np.ptp([day.phase for day in days]) > 3


@pytest.mark.parametrize("name", ["juggler3", "juggler5"])
def test_no_ball_leaves_the_picture_on_any_day(name: str) -> None:
    given = load_scene(name)
    for seed in (0, *range(1, 11), 1001, 1002, 1003):
        day = varied(given, seed)
        act = juggling_act(day.jugglers[0], frame_times(day))
        camera = day.camera.as_camera()
        column_row, _ = camera.pixel_from_world(act.balls)
        assert camera.contains(column_row).all()
