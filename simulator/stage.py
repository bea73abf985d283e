"""What stands and moves on a scene: every object with its number, its name and its mesh in every frame."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from recording.metadata import ObjectRecord
from recording.truth import MeshSequence
from simulator import shapes
from simulator.body import load_body
from simulator.dressing import dressed, holding
from simulator.juggler import juggling_act
from simulator.path import Path, path_through
from simulator.person import walking_person
from simulator.retarget import ground_track, performing_person
from simulator.scene import Scene
from simulator.things import Ball, Obstacle, Person

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
    for person in scene.people:
        yield person.name, "person", _person(person, times)
    for juggler in scene.jugglers:
        act = juggling_act(juggler, times)
        yield juggler.name, "juggler", act.mesh
        for places in act.balls:
            yield None, "ball", shapes.moved(shapes.ball(juggler.ball_radius), places)
    for ball in scene.balls:
        yield ball.name, "ball", shapes.moved(shapes.ball(ball.radius), _flight(ball, times))
    for obstacle in scene.obstacles:
        yield obstacle.name, obstacle.shape, _solid(obstacle)


def _person(person: Person, times: Float[np.ndarray, "frame"]) -> MeshSequence:
    body = load_body(person.body)
    held = holding(body, person.props)
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


def _flight(ball: Ball, times: Float[np.ndarray, "frame"]) -> Float[np.ndarray, "frame 3"]:
    """The centre of the ball at the times: straight from way-point to way-point, at rest before and after."""
    places = np.array(ball.waypoints)
    passed = ball.start + _passing_times(places, ball.speed, ball.times)
    return np.stack([np.interp(times, passed, axis) for axis in places.T], axis=-1)


def _passing_times(
    places: Float[np.ndarray, "waypoint 3"], speed: float | None, times: Sequence[float] | None
) -> Float[np.ndarray, "waypoint"]:
    """When each way-point is passed, seconds after the first."""
    if times is not None:
        return np.array(times)
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=-1)
    return np.concatenate([[0.0], np.cumsum(lengths)]) / (speed or 1.0)


def _solid(obstacle: Obstacle) -> MeshSequence:
    yaw = np.radians(obstacle.yaw_deg).item()
    if obstacle.size is not None:
        return shapes.box(obstacle.size, obstacle.position, yaw=yaw)
    solid = shapes.cylinder if obstacle.shape == "cylinder" else shapes.cone
    return solid(obstacle.radius or 0.0, obstacle.height or 0.0, obstacle.position, yaw=yaw)
