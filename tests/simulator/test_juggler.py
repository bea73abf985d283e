"""The juggler: hands that hold the balls, elbows that bend, feet that stand."""

from typing import Any

import numpy as np
import pytest

from recording.checks import validated
from recording.errors import InputError
from simulator.body import SIDES, Body, body_names, load_body
from simulator.juggler import Act, juggling_act, juggling_of
from simulator.juggling_scene import Juggler
from simulator.siteswap import IN_THE_AIR

TIMES = np.arange(0, 1.5, 1 / 60)
THREE: dict[str, Any] = {"body": "man", "siteswap": [3], "beat_s": 0.28, "dwell_s": 0.32}
FIVE: dict[str, Any] = {"body": "man", "siteswap": [5], "beat_s": 0.19, "dwell_s": 0.25}
BODY_AXES = {"facing_deg": 0.0}
"""Facing along x at the origin, a juggler's axes are the world's."""


def juggler_of(given: dict[str, Any], **changes: Any) -> Juggler:
    return validated(Juggler, given | changes, source="test")


def weight(body: Body, bone: str) -> np.ndarray:
    return body.weights[:, body.bones.index(bone)]


def gaps(act: Act, body: Body, hand: int, ball: np.ndarray, moment: np.ndarray, radius: float) -> np.ndarray:
    """How far the hand's skin is from the ball at the moments; below 0 it is inside."""
    palm = weight(body, f"hand.{SIDES[hand]}") > 0.5
    faces = act.mesh.faces[palm[act.mesh.faces].all(axis=1)]
    skin = act.mesh.vertices[moment][:, faces]
    skin = np.concatenate([skin.reshape(len(moment), -1, 3), skin.mean(axis=2)], axis=1)
    return np.linalg.norm(skin - act.balls[ball, moment][:, None], axis=-1).min(axis=1) - radius


@pytest.mark.parametrize("name", body_names())
@pytest.mark.parametrize("pattern", [THREE, FIVE, THREE | {"siteswap": [4, 4, 1], "dwell_s": 0.2}])
def test_a_held_ball_lies_in_the_hand(name: str, pattern: dict[str, Any]) -> None:
    juggler = juggler_of(pattern, body=name)
    body = load_body(name)
    act = juggling_act(juggler, TIMES)
    holders = juggling_of(juggler, body).holders(TIMES)
    for hand in (0, 1):
        ball, moment = np.nonzero(holders == hand)
        gap = gaps(act, body, hand, ball, moment, juggler.ball_radius)
        assert gap.max() < 0.02
        assert gap.min() > -0.005
    assert (holders == IN_THE_AIR).any()


@pytest.mark.parametrize("radius", [0.035, 0.06])
def test_hands_fit_balls_of_any_size(radius: float) -> None:
    juggler = juggler_of(THREE, ball_radius=radius)
    body = load_body("man")
    act = juggling_act(juggler, TIMES)
    ball, moment = np.nonzero(juggling_of(juggler, body).holders(TIMES) == 0)
    gap = gaps(act, body, 0, ball, moment, radius)
    assert gap.max() < 0.02
    assert gap.min() > -0.005


@pytest.mark.parametrize("name", body_names())
def test_elbows_hang_behind_and_below_and_outside(name: str) -> None:
    body = load_body(name)
    act = juggling_act(juggler_of(FIVE, body=name, **BODY_AXES), TIMES)
    for side, outwards in zip(SIDES, (1.0, -1.0), strict=True):
        shoulder = body.joint(f"upper_arm.{side}")
        at_elbow = np.minimum(weight(body, f"upper_arm.{side}"), weight(body, f"forearm.{side}")) > 0.3
        elbow = act.mesh.vertices[:, at_elbow].mean(axis=1)
        at_wrist = np.minimum(weight(body, f"hand.{side}"), weight(body, f"forearm.{side}")) > 0.3
        wrist = act.mesh.vertices[:, at_wrist].mean(axis=1)
        assert (elbow[:, 2] < shoulder[2] - 0.1).all()
        assert (elbow[:, 0] < (shoulder[0] + wrist[:, 0]) / 2).all()
        assert (outwards * elbow[:, 1] > outwards * shoulder[1] - 0.02).all()


def test_all_but_the_arms_stands_still() -> None:
    body = load_body("man")
    act = juggling_act(juggler_of(THREE), TIMES)
    arms = sum(weight(body, f"{bone}.{side}") for bone in ("upper_arm", "forearm", "hand") for side in SIDES)
    still = act.mesh.vertices[:, arms == 0]
    assert still.shape[1] > 800
    assert np.ptp(still, axis=0).max() == 0.0
    assert np.abs(act.mesh.vertices[..., 2].min(axis=1)).max() < 0.005
    assert np.ptp(act.mesh.vertices[:, arms == 1], axis=0).max() > 0.1


def test_the_juggler_stands_where_told_and_looks_where_told() -> None:
    plain = juggling_act(juggler_of(THREE, **BODY_AXES), TIMES)
    turned = juggling_act(juggler_of(THREE, facing_deg=90.0, position=[2.0, 1.0]), TIMES)
    x, y, z = np.moveaxis(plain.balls, -1, 0)
    np.testing.assert_allclose(turned.balls, np.stack([2.0 - y, 1.0 + x, z], axis=-1), atol=1e-12)
    x, y, z = np.moveaxis(plain.mesh.vertices, -1, 0)
    np.testing.assert_allclose(turned.mesh.vertices, np.stack([2.0 - y, 1.0 + x, z], axis=-1), atol=1e-6)


def test_hands_rise_where_arms_would_be_too_short_for_the_scoop() -> None:
    body = load_body("man")
    slow = juggler_of(FIVE, beat_s=0.34, dwell_s=0.6)
    usual = juggling_of(juggler_of(FIVE), body).throw_spots[0, 2]
    assert juggling_of(slow, body).throw_spots[0, 2] > usual + 0.02
    juggling_act(slow, TIMES)


def test_hands_that_are_out_of_reach_are_refused() -> None:
    with pytest.raises(InputError, match=r"the left wrist goes .* m from its shoulder"):
        juggling_act(juggler_of(THREE, reach=0.9), TIMES)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"siteswap": [5, 4, 3]}, "siteswap: expected one ball at a time"),
        ({"siteswap": [3, 2]}, "siteswap: expected throws whose mean"),
        ({"siteswap": []}, "siteswap: "),
        ({"dwell_s": 0.56}, "'dwell_s' below 0.56"),
        ({"siteswap": [4, 4, 1]}, "'dwell_s' below 0.28"),
        ({"body": "mna"}, "did you mean 'man'"),
        ({"ball_radius": 0}, "ball_radius: "),
        ({"beat": 0.2}, "did you mean 'beat_s'"),
    ],
)
def test_what_no_juggler_can_do_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        juggler_of(THREE, **changes)
