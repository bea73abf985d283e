"""Balls in hands: how an arm is held out for a ball, where the hand is, and how the ball comes there and leaves.

Body axes as in `simulator.body`: x forward, y to the left, z up.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from recording.metadata import CarriedRecord
from recording.truth import MeshSequence
from simulator.body import Body
from simulator.props import Coat
from simulator.things import Ball, Person

Hands = Mapping[tuple[str, str], Float[np.ndarray, "moment 3"]]
"""Where the hand of a person (name, side) is in each frame and, if need be, after the last; world axes, metres."""
GRAVITY = 9.81
"""Metres a second squared."""
_UPPER_ARM_BACK, _FOREARM_BEND, _PALM_TURN = 0.1, 1.45, np.pi / 2
"""Radians: the upper arm hangs, the forearm points ahead, the palm is turned up."""


def check_hands(people: Sequence[Person], balls: Sequence[Ball]) -> None:
    """Raise unless every ball that is held is held by one of the people, in a hand that is free for it."""
    by_name = {person.name: person for person in people if person.name is not None}
    every = [held for ball in balls for held in ball.held]
    for held in every:
        if held.by not in by_name:
            raise ValueError(f"expected 'by' to be the name of one of the people, got {held.by!r}")
        carrier = by_name[held.by]
        in_hands = [prop.side for prop in carrier.props if not isinstance(prop, Coat)]
        if carrier.motion is not None or held.side in in_hands:
            raise ValueError(f"expected the {held.side} hand of {held.by!r} to be free for the ball")
    for one, other in combinations(every, 2):
        alike = (one.by, one.side) == (other.by, other.side)
        if alike and max(one.span[0], other.span[0]) <= min(one.span[1], other.span[1]):
            raise ValueError(f"expected one ball at a time in the {one.side} hand of {one.by!r}, got two")


def held_sides(person: Person, balls: Sequence[Ball]) -> list[str]:
    """The hands in which the person holds a ball at some time."""
    return sorted({held.side for ball in balls for held in ball.held if held.by == person.name})


def held_out(side: str) -> dict[str, Float[np.ndarray, "3 3"]]:
    """The local rotations of the bones of an arm that is held out, palm up."""
    outward = 1.0 if side == "left" else -1.0
    angles = {
        "upper_arm": (0.0, _UPPER_ARM_BACK, 0.0),
        "forearm": (0.0, -_FOREARM_BEND, 0.0),
        "hand": (0.0, 0.0, outward * _PALM_TURN),
    }
    return {
        f"{bone}.{side[0].upper()}": Rotation.from_euler("xyz", about).as_matrix() for bone, about in angles.items()
    }


def hand_places(body: Body, mesh: MeshSequence, side: str) -> Float[np.ndarray, "frame 3"]:
    """The top of the hand's middle in each frame, world axes, metres; the mesh's first vertices are the bare body's."""
    weight = body.weights[:, body.bones.index(f"hand.{side[0].upper()}")]
    hand = mesh.vertices[:, np.flatnonzero(weight > 0.5)].astype(np.float64)
    middle = hand.mean(axis=1)
    height = hand[0, :, 2].max() - middle[0, 2]  # The same in all frames: the hand is stiff, and turns about z alone.
    return middle + np.array([0.0, 0.0, height])


def ball_places(
    ball: Ball, times: Float[np.ndarray, "frame"], hands: Hands, *, fps: float
) -> Float[np.ndarray, "frame 3"]:
    """The ball's centre at the times, world axes, metres; `hands` have so many entries a second.

    From place to place it goes straight or, if it is thrown, on a parabola; it rests before the first and after
    the last of them. While it is held it lies on the hand.
    """
    lying = [hands[held.by, held.side] + np.array([0.0, 0.0, ball.radius]) for held in ball.held]
    knots = list(zip(_passing_times(ball).tolist(), map(np.array, ball.waypoints), strict=True))
    for held, track in zip(ball.held, lying, strict=True):
        moments = [moment for moment in (held.begin, held.end) if moment is not None]
        knots += [(moment, _at(track, moment * fps)) for moment in moments]
    knots = knots or [(0.0, lying[0][0])]  # Held all the time.
    places = _between(sorted(knots, key=lambda knot: knot[0]), times, falling=ball.thrown)
    for held, track in zip(ball.held, lying, strict=True):
        during = (times >= held.span[0]) & (times <= held.span[1])
        places[during] = track[: len(times)][during]
    return places


def last_moment(balls: Sequence[Ball]) -> float:
    """The last time at which a ball is caught or let go, seconds after the first frame; 0 where none is."""
    moments = [moment for ball in balls for held in ball.held for moment in (held.begin, held.end)]
    return max((moment for moment in moments if moment is not None), default=0.0)


def carried_records(
    people: Sequence[Person], balls: Mapping[int, Ball], times: Float[np.ndarray, "frame"]
) -> tuple[CarriedRecord, ...]:
    """In which frames which ball, by id, lies in whose hand; people are numbered from 1."""
    ids = {person.name: number for number, person in enumerate(people, start=1)}
    records = []
    for objectid, ball in balls.items():
        for held in ball.held:
            during = np.flatnonzero((times >= held.span[0]) & (times <= held.span[1]))
            if len(during):
                first, stop = int(during[0]), int(during[-1]) + 1
                records.append(CarriedRecord(object=objectid, by=ids[held.by], first=first, stop=stop))
    return tuple(records)


def _passing_times(ball: Ball) -> Float[np.ndarray, "waypoint"]:
    """When each way-point is passed, seconds after the first frame."""
    if ball.times is not None or not ball.waypoints:
        return ball.start + np.array(ball.times or ())
    lengths = np.linalg.norm(np.diff(np.array(ball.waypoints), axis=0), axis=-1)
    return ball.start + np.concatenate([[0.0], np.cumsum(lengths)]) / (ball.speed or 1.0)


def _at(track: Float[np.ndarray, "moment 3"], frame: float) -> Float[np.ndarray, "3"]:
    """The track's place between frames, metres."""
    return np.array([np.interp(frame, np.arange(len(track)), axis) for axis in track.T])


def _between(
    knots: list[tuple[float, np.ndarray]], times: Float[np.ndarray, "frame"], *, falling: bool
) -> Float[np.ndarray, "frame 3"]:
    """The place at the times of what is at each knot at its time."""
    passed, places = np.array([time for time, _ in knots]), np.array([place for _, place in knots])
    found = np.stack([np.interp(times, passed, axis) for axis in places.T], axis=-1)
    for begin, end in pairwise(passed.tolist()) if falling else ():
        during = (times > begin) & (times < end)
        found[during, 2] += GRAVITY / 2 * (times[during] - begin) * (end - times[during])
    return found
