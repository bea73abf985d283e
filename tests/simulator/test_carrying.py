"""Balls that are thrown, caught, carried and let go."""

from typing import Any

import numpy as np
import pytest

from recording.checks import validated
from recording.errors import InputError
from recording.metadata import CarriedRecord
from simulator.body import load_body
from simulator.carrying import GRAVITY, ball_places, hand_places
from simulator.scene import Scene, load_scene
from simulator.simulate import prepared
from simulator.stage import actors, frame_times
from simulator.things import Ball

WALK: dict[str, Any] = {"name": "Ann", "body": "woman", "waypoints": [[-2, 0], [2, 0]], "speed": 1.2}
BALL: dict[str, Any] = {"radius": 0.1, "thrown": True, "waypoints": [[2, 0, 1]], "times": [0.2]}
SMALL: dict[str, Any] = {
    "name": "small",
    "frames": 30,
    "fps": 20,
    "camera": {"position": [0, -4, 1.5], "look_at": [0, 0, 1]},
    "people": [WALK],
}


def scene_of(ball: dict[str, Any], *held: dict[str, Any], **changes: Any) -> Scene:
    return validated(Scene, SMALL | {"balls": [ball | {"held": list(held)}]} | changes, source="test")


def places_of(scene: Scene) -> np.ndarray:
    """The ball's centre in each frame."""
    return next(actor.mesh.vertices.mean(axis=1) for actor in actors(scene) if actor.record.kind == "ball")


def hand_of(scene: Scene, side: str) -> np.ndarray:
    return hand_places(load_body(scene.people[0].body), actors(scene)[0].mesh, side)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_caught_ball_lies_on_the_hand_from_then_on(side: str) -> None:
    scene = scene_of(BALL, {"by": "Ann", "side": side, "begin": 0.9})
    ball, hand = places_of(scene), hand_of(scene, side)
    in_hand = frame_times(scene) >= 0.9
    np.testing.assert_allclose(ball[in_hand], hand[in_hand] + [0, 0, 0.1], atol=1e-4)
    assert np.linalg.norm(np.diff(ball, axis=0), axis=1)[in_hand[:-1]].max() < 0.1
    assert np.linalg.norm(ball - hand, axis=1)[~in_hand].min() > 0.15


def test_a_thrown_ball_falls_as_gravity_has_it() -> None:
    scene = scene_of(BALL, {"by": "Ann", "begin": 0.9})
    times, ball = frame_times(scene), places_of(scene).astype(np.float64)
    flying = ball[(times > 0.2) & (times < 0.9)]
    np.testing.assert_allclose(np.diff(flying[:, 2], n=2) * 20**2, -GRAVITY, atol=0.01)
    np.testing.assert_allclose(np.diff(flying[:, :2], n=2), 0, atol=1e-5)
    np.testing.assert_allclose(ball[times <= 0.2], [[2, 0, 1]] * 5, atol=1e-6)


def test_a_ball_let_go_flies_to_its_way_point_and_lies_there() -> None:
    scene = scene_of(
        {"radius": 0.1, "thrown": True, "waypoints": [[1, 1, 0.1]], "times": [1.0]}, {"by": "Ann", "end": 0.5}
    )
    times, ball, hand = frame_times(scene), places_of(scene), hand_of(scene, "right")
    np.testing.assert_allclose(ball[times <= 0.5], hand[times <= 0.5] + [0, 0, 0.1], atol=1e-4)
    np.testing.assert_allclose(ball[times >= 1.0], [[1, 1, 0.1]] * 10, atol=1e-6)


def test_the_arm_is_held_out_and_the_hand_is_before_the_body() -> None:
    scene = scene_of(BALL, {"by": "Ann", "begin": 0.9})
    body, hand = actors(scene)[0].mesh.vertices, hand_of(scene, "right")
    ahead = hand[:, 0] - body[..., 0].mean(axis=1)
    assert (ahead > 0.1).all()
    assert np.ptp(ahead) < 0.2
    assert (np.abs(hand[:, 2] - 0.6 * np.ptp(body[0, :, 2])) < 0.2).all()


def test_a_recording_cut_short_shows_the_same_flight() -> None:
    scene = scene_of(BALL, {"by": "Ann", "begin": 0.9})
    for frames in (1, 10):
        short = scene.model_copy(update={"frames": frames})
        np.testing.assert_array_equal(places_of(short), places_of(scene)[:frames])


def test_the_metadata_say_who_carries_what_and_when() -> None:
    caught = scene_of(BALL, {"by": "Ann", "begin": 0.9})
    assert prepared(caught).metadata.carried == (CarriedRecord(object=2, by=1, first=18, stop=30),)
    thrown = scene_of({"radius": 0.1}, {"by": "Ann", "end": 0.5}, {"by": "Ann", "side": "left", "begin": 0.9})
    assert prepared(thrown).metadata.carried == (
        CarriedRecord(object=2, by=1, first=0, stop=11),
        CarriedRecord(object=2, by=1, first=18, stop=30),
    )
    assert prepared(thrown, frames=15).metadata.carried == (CarriedRecord(object=2, by=1, first=0, stop=11),)
    assert prepared(thrown).stage.moving.keys() == {1, 2}


def test_a_scene_without_such_balls_is_written_as_before() -> None:
    scene = prepared("wall")
    assert scene.metadata.carried is None
    plain = Ball.model_validate({"radius": 0.1, "waypoints": [[0, 0, 1], [0, 0, 2]], "speed": 1})
    assert plain.model_dump().keys() == {"name", "radius", "waypoints", "speed", "times", "start"}
    assert "together" not in load_scene("wall").model_dump()["vary"]


def test_a_ball_that_nobody_throws_goes_straight() -> None:
    ball = Ball.model_validate(
        {"radius": 0.1, "waypoints": [[0, 0, 1], [1, 0, 2], [1, 0, 4]], "speed": 2, "start": 0.5}
    )
    length = np.sqrt(2)
    found = ball_places(ball, np.array([0.0, 0.5, 0.5 + length / 4, 0.5 + length / 2 + 0.5, 9.0]), {}, fps=1.0)
    np.testing.assert_allclose(found, [[0, 0, 1], [0, 0, 1], [0.5, 0, 1.5], [1, 0, 3], [1, 0, 4]], atol=1e-12)


REFUSED: dict[str, tuple[dict[str, Any], list[dict[str, Any]], str]] = {
    "a stranger's hand": (BALL, [{"by": "Bob", "begin": 0.9}], "name of one of the people, got 'Bob'"),
    "a speed": (
        {"radius": 0.1, "waypoints": [[0, 0, 1], [1, 0, 1]], "speed": 1},
        [{"by": "Ann", "begin": 3}],
        "'times' in place of 'speed'",
    ),
    "elsewhere while it is held": (BALL, [{"by": "Ann", "begin": 0.1}], "passed before it is caught"),
    "let go before it is caught": (BALL, [{"by": "Ann", "begin": 0.9, "end": 0.8}], "'begin' before its 'end'"),
    "in two hands": (
        BALL,
        [{"by": "Ann", "begin": 0.9}, {"by": "Ann", "side": "left", "begin": 1.0}],
        "follow one another",
    ),
    "nowhere": ({"radius": 0.1}, [], "at least 2 way-points"),
    "without times": ({"radius": 0.1, "waypoints": [[0, 0, 1]]}, [{"by": "Ann"}], "either 'speed' or 'times'"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_what_cannot_be_is_refused(kind: str) -> None:
    ball, held, message = REFUSED[kind]
    with pytest.raises(InputError, match=message):
        scene_of(ball, *held)


def test_a_hand_holds_one_thing() -> None:
    umbrella = WALK | {"props": [{"kind": "umbrella", "side": "right"}]}
    with pytest.raises(InputError, match="right hand of 'Ann' to be free"):
        scene_of(BALL, {"by": "Ann", "begin": 0.9}, people=[umbrella])
    scene_of(BALL, {"by": "Ann", "begin": 0.9, "side": "left"}, people=[umbrella])
    balls = [{"radius": 0.1, "held": [{"by": "Ann", "begin": begin}]} for begin in (0.1, 0.5)]
    with pytest.raises(InputError, match="one ball at a time in the right hand of 'Ann'"):
        validated(Scene, SMALL | {"balls": balls}, source="test")
