"""What stands and moves on a scene: every object with its number, its name and its mesh in every frame."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from recording.metadata import ObjectRecord
from recording.truth import MeshSequence
from simulator import shapes
from simulator.body import load_body
from simulator.carrying import ball_places, hand_places, held_out, held_sides, last_moment
from simulator.dressing import dressed, holding
from simulator.juggler import juggling_act
from simulator.path import Path, path_through
from simulator.person import walking_person
from simulator.retarget import ground_track, performing_person
from simulator.scene import Scene
from simulator.things import Obstacle, Person

_MOVING_KINDS = ("person", "ball")
"""What moves as a whole; a juggler's arms move, but the juggler stands."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Actor:
    """One object of a scene."""

    record: ObjectRecord
    """As it stands in `recording.json`."""
    mesh: MeshSequence
    """World axes, metres; one frame where it stands still."""


def actors(scene: Scene) -> tuple[Actor, ...]:
    """Everything on the scene, numbered from 1, each in the scene's order.

    People come first, then each juggler with the juggled balls, then other balls, then obstacles.
    """
    unnamed: Counter[str] = Counter()
    cast = []
    for number, (given_name, kind, mesh) in enumerate(_meshes(scene), start=1):
        unnamed[kind] += 1
        name = given_name or f"{kind} {unnamed[kind]}"
        record = ObjectRecord(id=number, name=name, kind=kind, moving=kind in _MOVING_KINDS)
        cast.append(Actor(record=record, mesh=mesh))
    return tuple(cast)


def frame_times(scene: Scene) -> Float[np.ndarray, "frame"]:
    """When each picture is taken, seconds after the first."""
    return np.arange(scene.frames) / scene.fps


def walkers_centres(scene: Scene) -> list[Float[np.ndarray, "frame 2"]]:
    """Where the centre of each person, and of each juggler, stands on the ground in each frame, metres."""
    times = frame_times(scene)
    standing = [np.tile(juggler.position, (scene.frames, 1)) for juggler in scene.jugglers]
    return [*(_ground_track(person, times) for person in scene.people), *standing]


def _meshes(scene: Scene) -> Iterator[tuple[str | None, str, MeshSequence]]:
    """Everything's name if it has one, kind and mesh."""
    times = frame_times(scene)
    hands: dict[tuple[str, str], np.ndarray] = {}
    for person in scene.people:
        sides = held_sides(person, scene.balls)
        acted = _person(person, _until_let_go(scene) if sides else times, sides)
        for side in sides:
            hands[person.name or "", side] = hand_places(load_body(person.body), acted, side)
        yield person.name, "person", MeshSequence(faces=acted.faces, vertices=acted.vertices[: len(times)])
    for juggler in scene.jugglers:
        act = juggling_act(juggler, times)
        yield juggler.name, "juggler", act.mesh
        for places in act.balls:
            yield None, "ball", shapes.moved(shapes.ball(juggler.ball_radius), places)
    for ball in scene.balls:
        yield ball.name, "ball", shapes.moved(shapes.ball(ball.radius), ball_places(ball, times, hands, fps=scene.fps))
    for obstacle in scene.obstacles:
        yield obstacle.name, obstacle.shape, _solid(obstacle)


def _until_let_go(scene: Scene) -> Float[np.ndarray, "moment"]:
    """The times of the frames, and of those after them until no ball is caught or let go any more, seconds.

    So a ball in the air goes the same way in a recording that is cut short before somebody catches it.
    """
    frames = max(scene.frames, math.ceil(last_moment(scene.balls) * scene.fps) + 1)
    return np.arange(frames) / scene.fps


def _person(person: Person, times: Float[np.ndarray, "frame"], sides: Sequence[str]) -> MeshSequence:
    """The person at the times; the arms of the sides are held out for balls."""
    body = load_body(person.body)
    held = holding(body, person.props)
    for side in sides:
        held |= held_out(side)
    clothed = dressed(body, person.props)
    if person.motion is not None:
        return performing_person(clothed, person.motion, times, holding=held)
    return walking_person(clothed, _walk(person), times, phase=person.phase, holding=held).mesh


def _ground_track(person: Person, times: Float[np.ndarray, "frame"]) -> Float[np.ndarray, "frame 2"]:
    if person.motion is not None:
        return ground_track(load_body(person.body), person.motion, times)
    return _walk(person).positions(times)


def _walk(person: Person) -> Path:
    return path_through(person.waypoints, speed=person.speed, times=person.times, start=person.start)


def _solid(obstacle: Obstacle) -> MeshSequence:
    yaw = np.radians(obstacle.yaw_deg).item()
    if obstacle.size is not None:
        return shapes.box(obstacle.size, obstacle.position, yaw=yaw)
    solid = shapes.cylinder if obstacle.shape == "cylinder" else shapes.cone
    return solid(obstacle.radius or 0.0, obstacle.height or 0.0, obstacle.position, yaw=yaw)
