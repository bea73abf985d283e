"""Somebody who juggles: a body that stands, and arms that bring the hands to the balls."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from recording.errors import InputError
from recording.truth import MeshSequence
from simulator.body import SIDES, Body, load_body, posed
from simulator.juggling_scene import Juggler
from simulator.limb import Directions, Rotations, across, middle_joint, turns
from simulator.siteswap import Juggling

_BELOW_SHOULDER, _REACH, _THROW_WIDTH, _CATCH_WIDTH = 0.25, 0.6, 0.4, 1.05
"""Where hands throw and catch if nothing else is said, in lengths of the arm to the wrist."""
_STRETCHED = 0.98
"""Of the arm's length: hands that nobody tells otherwise stay as near to the shoulders."""
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
    arm = sum(_arm_lengths(body, "L"))
    reach = juggler.reach or _REACH * arm
    throw = juggler.throw_width or _THROW_WIDTH * arm
    catch = juggler.catch_width or _CATCH_WIDTH * arm
    level = Juggling(
        pattern=juggler.siteswap,
        beat_s=juggler.beat_s,
        dwell_s=juggler.dwell_s,
        phase=juggler.phase,
        throw_spots=np.array([[reach, throw / 2, 0.0], [reach, -throw / 2, 0.0]]),
        catch_spots=np.array([[reach, catch / 2, 0.0], [reach, -catch / 2, 0.0]]),
    )
    height = np.array([0.0, 0.0, juggler.hand_height or _easy_height(level, body, juggler.ball_radius)])
    return replace(level, throw_spots=level.throw_spots + height, catch_spots=level.catch_spots + height)


def _easy_height(level: Juggling, body: Body, radius: float) -> float:
    """How high the spots of a pattern at height 0 are to be lifted, metres.

    That is a little below the shoulders, or higher where the arms would not reach the bottom of a scoop else.
    """
    cycle = np.linspace(0.0, 2 * len(level.pattern) * level.beat_s, 200 * len(level.pattern))
    heights = []
    for side, balls in zip(SIDES, level.hand_places(cycle), strict=True):
        arm = sum(_arm_lengths(body, side))
        shoulder = body.joint(f"upper_arm.{side}")
        wrist = _wrists(body, side, balls, radius)
        aside = np.linalg.norm(wrist[:, :2] - shoulder[:2], axis=1)
        below = np.sqrt(np.maximum((_STRETCHED * arm) ** 2 - aside**2, 0.0))
        heights += [shoulder[2] - _BELOW_SHOULDER * arm, float((shoulder[2] - below - wrist[:, 2]).max())]
    return float(max(heights))


def ball_in_hand(body: Body, side: str, radius: float) -> Float[np.ndarray, "3"]:
    """From the wrist to the centre of a ball that lies in the palm of the body at rest, body axes, metres.

    The ball has come straight out of the palm until nothing of the hand is inside it.
    """
    mirror = _mirror(side)
    weight = body.weights[:, body.bones.index(f"hand.{side}")]
    faces = body.faces[(weight[body.faces] > 0.5).all(axis=1)]
    corners = body.vertices[faces].astype(np.float64) - body.joint(f"hand.{side}")
    skin = np.concatenate(
        [corners.reshape(-1, 3), corners.mean(axis=1), (corners + np.roll(corners, 1, 1)).reshape(-1, 3) / 2]
    )
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
    hand = np.repeat(_palm_up(side)[None], moments, axis=0)
    wrist = _wrists(body, side, balls, radius)
    rest = {bone: body.joint(f"{bone}.{side}") for bone in ("upper_arm", "forearm", "hand")}
    lengths = _arm_lengths(body, side)
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


def _palm_up(side: str) -> Float[np.ndarray, "3 3"]:
    """The rotation of a hand that hangs down to one whose palm is up and whose fingers point forward and inward."""
    mirror = _mirror(side)
    ahead = np.array([[np.cos(_TURNED_IN), mirror[1] * np.sin(_TURNED_IN), 0.0]])
    up = np.array([[0.0, 0.0, 1.0]])
    return np.asarray(turns((mirror * _OUT_OF_PALM, mirror * _FINGERS), (up, ahead))[0])


def _wrists(body: Body, side: str, balls: Directions, radius: float) -> Directions:
    """Where the wrist is so that the ball lies in the palm."""
    return np.asarray(balls - _palm_up(side) @ ball_in_hand(body, side, radius))


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


def _arm_lengths(body: Body, side: str) -> tuple[float, float]:
    shoulder, elbow, wrist = (body.joint(f"{bone}.{side}") for bone in ("upper_arm", "forearm", "hand"))
    return float(np.linalg.norm(elbow - shoulder)), float(np.linalg.norm(wrist - elbow))
