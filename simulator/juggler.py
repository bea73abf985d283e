"""Somebody who juggles: a body that stands, and arms that bring the hands to the balls."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from recording.errors import InputError
from recording.truth import MeshSequence
from simulator.body import SIDES, Body, load_body, posed
from simulator.juggling_scene import Juggler
from simulator.limb import Directions, Rotations, across, middle_joint, turns
from simulator.siteswap import Juggling

_HAND_HEIGHT, _REACH, _THROW_WIDTH, _CATCH_WIDTH = 0.68, 0.19, 0.12, 0.32
"""What a juggler does who is not told otherwise, in statures."""
_PALM_AT = np.array([0.02, 0.0, -0.085])
"""From the wrist to the middle of the palm of a hand that hangs down, metres."""
_OUT_OF_PALM = np.array([-0.1, 1.0, -0.15])
"""Where the palm of a right hand that hangs down faces, body axes; the left one's is its mirror image."""
_FINGERS = np.array([0.0, 0.1, -1.0])
"""Where its fingers point."""
_TURNED_IN = 0.35
"""How far the fingers of a juggling hand point inwards, radians."""
_ELBOW = np.array([-0.6, 0.35, -1.0])
"""Where a left elbow gives way: back, out and down."""
_HEAD_UP = 0.2
"""How far the head is thrown back to look at the balls, radians."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Act:
    """A juggler and the balls, in every frame; world axes, metres."""

    mesh: MeshSequence
    """The juggler."""
    balls: Float[np.ndarray, "ball frame 3"]
    """The balls' centres."""


def juggling_act(juggler: Juggler, times: Float[np.ndarray, "frame"]) -> Act:
    """The juggler and the balls at the times, seconds after the first frame.

    An InputError where the hands would have to go where the arms do not reach.
    """
    body = load_body(juggler.body)
    juggling = juggling_of(juggler, body)
    hands = juggling.hand_places(times)
    rotations = {"head": _about_y(np.full(len(times), -_HEAD_UP))}
    for side, places in zip(SIDES, hands, strict=True):
        rotations |= _arm(body, side, places, juggler.ball_radius)
    root = np.repeat(body.joint("pelvis")[None], len(times), axis=0)
    vertices = posed(body, rotations, root)
    return Act(
        mesh=MeshSequence(faces=body.faces, vertices=_in_place(juggler, vertices).astype(np.float32)),
        balls=_in_place(juggler, juggling.ball_places(times)),
    )


def juggling_of(juggler: Juggler, body: Body) -> Juggling:
    """The juggler's pattern in time and space, in the body's axes."""
    height, reach, throw, catch = (
        share * body.height if given is None else given
        for given, share in (
            (juggler.hand_height, _HAND_HEIGHT),
            (juggler.reach, _REACH),
            (juggler.throw_width, _THROW_WIDTH),
            (juggler.catch_width, _CATCH_WIDTH),
        )
    )
    return Juggling(
        pattern=juggler.siteswap,
        beat_s=juggler.beat_s,
        dwell_s=juggler.dwell_s,
        phase=juggler.phase,
        throw_spots=np.array([[reach, throw / 2, height], [reach, -throw / 2, height]]),
        catch_spots=np.array([[reach, catch / 2, height], [reach, -catch / 2, height]]),
    )


def ball_in_hand(body: Body, side: str, radius: float) -> Float[np.ndarray, "3"]:
    """From the wrist to the centre of a ball that lies in the palm of the body at rest, body axes, metres.

    The ball has come straight out of the palm until nothing of the hand is inside it.
    """
    mirror = _mirror(side)
    weight = body.weights[:, body.bones.index(f"hand.{side}")]
    faces = body.faces[(weight[body.faces] > 0.5).all(axis=1)]
    corners = body.vertices[faces].astype(np.float64) - body.joint(f"hand.{side}")
    skin = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1), (corners + np.roll(corners, 1, 1)).reshape(-1, 3) / 2])
    outward = mirror * _OUT_OF_PALM / np.linalg.norm(_OUT_OF_PALM)
    ways = np.arange(0.0, 0.3, 0.0005)[:, None]
    centres = mirror * _PALM_AT + ways * outward
    gap = np.linalg.norm(centres[:, None] - skin[None], axis=-1).min(axis=1) - radius
    return np.asarray(centres[np.flatnonzero(gap < 0)[-1] + 1])


def _arm(body: Body, side: str, balls: Directions, radius: float) -> dict[str, Rotations]:
    """The local rotations that bring the hand to its places: palm up, fingers forward, a ball lying in it."""
    mirror = _mirror(side)
    moments = len(balls)
    up = np.repeat([[0.0, 0.0, 1.0]], moments, axis=0)
    ahead = np.repeat([[np.cos(_TURNED_IN), mirror[1] * np.sin(_TURNED_IN), 0.0]], moments, axis=0)
    hand = turns((mirror * _OUT_OF_PALM, mirror * _FINGERS), (up, ahead))
    wrist = balls - hand @ ball_in_hand(body, side, radius)
    rest = {bone: body.joint(f"{bone}.{side}") for bone in ("upper_arm", "forearm", "hand")}
    lengths = _length(rest["forearm"] - rest["upper_arm"]), _length(rest["hand"] - rest["forearm"])
    shoulder = np.repeat(rest["upper_arm"][None], moments, axis=0)
    pole = np.repeat([_ELBOW * [1.0, -mirror[1], 1.0]], moments, axis=0)
    elbow = middle_joint(shoulder, wrist, lengths, towards=pole)
    _require_reach(elbow, side, float(np.linalg.norm(wrist - shoulder, axis=1).max()), sum(lengths))
    along_upper, along_fore = elbow - shoulder, wrist - elbow
    hinge = -mirror[1] * np.cross(along_upper, along_fore)
    inward = np.array([0.0, mirror[1], 0.0])
    upper = turns((rest["forearm"] - rest["upper_arm"], inward), (along_upper, hinge))
    # The palm faces the hinge's way when the forearm is not twisted, and up when it is: the forearm takes half.
    line = along_fore / np.linalg.norm(along_fore, axis=1, keepdims=True)
    fore = turns((rest["hand"] - rest["forearm"], inward), (along_fore, across(hinge, line) + across(up, line)))
    return {
        f"upper_arm.{side}": upper,
        f"forearm.{side}": np.swapaxes(upper, 1, 2) @ fore,
        f"hand.{side}": np.swapaxes(fore, 1, 2) @ hand,
    }


def _require_reach(elbow: Directions, side: str, farthest: float, length: float) -> None:
    if np.isnan(elbow).any():
        name = {"L": "left", "R": "right"}[side]
        raise InputError(
            f"expected a juggler whose arms reach the balls, but the {name} wrist goes {farthest:.2f} m from its "
            f"shoulder and the arm is {length:.2f} m long: change 'hand_height' or 'reach', or throw less high"
        )


def _in_place(juggler: Juggler, points: np.ndarray) -> Float[np.ndarray, "*shape 3"]:
    """Points of the body's axes where the juggler stands."""
    yaw = np.radians(juggler.facing_deg)
    cosine, sine = np.cos(yaw), np.sin(yaw)
    world_from_body = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(points @ world_from_body.T + [*juggler.position, 0.0])


def _mirror(side: str) -> Float[np.ndarray, "3"]:
    """What takes the right side's coordinates to the side's."""
    return np.array([1.0, 1.0 if side == "R" else -1.0, 1.0])


def _about_y(angle: Float[np.ndarray, "moment"]) -> Rotations:
    """Rotations about the lateral axis: positive takes forward down."""
    cosine, sine, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.moveaxis(np.array([[cosine, zero, sine], [zero, one, zero], [-sine, zero, cosine]]), -1, 0)


def _length(vector: np.ndarray) -> float:
    return float(np.linalg.norm(vector))
