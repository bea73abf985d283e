"""Seeds: the same scene on another day."""

import numpy as np

from recording.errors import InputError
from simulator.body import body_names
from simulator.clearance import crowded
from simulator.juggling_scene import Juggler
from simulator.motion_file import Motion
from simulator.path import FASTEST_WALK
from simulator.scene import Scene, Vary
from simulator.stage import walkers_centres
from simulator.things import Person

TRIES = 1000
"""Rounds of drawing anew those who come too near to somebody or something, before the search is given up."""
Waypoints = tuple[tuple[float, float], ...]
_DIGITS = 4  # A tenth of a millimetre: the resolved scene stays readable.


def varied(scene: Scene, seed: int) -> Scene:
    """The scene as it happens under the seed: 0 is the scene itself, another one varies people's walks and jugglers.

    Every walk and juggler is drawn anew, evenly within the ranges of the scene's `[vary]`; then those who come
    nearer to somebody or something than `[vary]` allows are drawn again, until nobody does. Where all change
    `together` there is one draw for all people. The same seed gives the same scene, whatever the picture's size.
    Way-points of balls that nobody juggles and obstacles stay as they are.
    """
    if seed < 0:
        raise InputError(f"expected a seed of 0 (the scene itself) or above, got {seed}")
    given: tuple[Person | Juggler, ...] = (*scene.people, *scene.jugglers)
    if seed == 0 or not given:
        return scene
    generator = np.random.default_rng(seed)
    vary, today, people = scene.vary, given, len(scene.people)
    again = [True] * len(given)
    for _ in range(TRIES):
        drawn = zip(given, today, again, strict=True)
        if vary.together:
            today = _varied_alike(given, vary, generator)
        else:
            today = tuple(_varied_anybody(one, vary, generator) if anew else kept for one, kept, anew in drawn)
        day = scene.model_copy(update={"people": today[:people], "jugglers": today[people:]})
        centres = walkers_centres(day)
        near = crowded(centres, day.obstacles, people_m=vary.clearance_m, obstacles_m=vary.obstacle_clearance_m)
        if not near.any():
            return day
        again = near.tolist()
    raise InputError(
        f"scene {scene.name!r}, seed {seed}: in {TRIES} rounds people never kept {scene.vary.clearance_m} m from one "
        f"another and {scene.vary.obstacle_clearance_m} m from obstacles: narrow the ranges of [vary], or lower these"
    )


def _varied_alike(
    given: tuple[Person | Juggler, ...], vary: Vary, generator: np.random.Generator
) -> tuple[Person | Juggler, ...]:
    """Everybody on another day, as one draw has it for all; people are shifted across the first one's path."""
    number = int(generator.integers(2**63))
    leader = given[0].waypoints if isinstance(given[0], Person) else ()
    return tuple(
        _varied_person(one, vary, np.random.default_rng(number), leader)
        if isinstance(one, Person)
        else _varied_juggler(one, vary, np.random.default_rng(number))
        for one in given
    )


def _varied_anybody(one: Person | Juggler, vary: Vary, generator: np.random.Generator) -> Person | Juggler:
    if isinstance(one, Person):
        return _varied_person(one, vary, generator)
    return _varied_juggler(one, vary, generator)


def _varied_person(person: Person, vary: Vary, generator: np.random.Generator, leader: Waypoints = ()) -> Person:
    """The person on another day; always draws the same amount of randomness, whatever may vary.

    The path is shifted across that of the leader, or across its own where there is none.
    """
    aside, faster, later = generator.uniform(-1.0, 1.0, size=3)
    phase = round(float(generator.uniform()), _DIGITS)
    body = str(generator.choice(body_names()))
    if person.motion is not None:
        moved = {"motion": _beside(person.motion, float(aside) * vary.sideways_m)}
        return person.model_copy(update=moved | ({"body": body} if vary.bodies else {}))
    factor = min(1.0 + float(faster) * vary.speed_share, FASTEST_WALK / max(person.top_speed, 1e-9))
    changes: dict[str, object] = {
        "waypoints": _shifted(person.waypoints, float(aside) * vary.sideways_m, leader or person.waypoints),
        "start": round(person.start + float(later) * vary.start_s, _DIGITS),
    }
    if person.speed is not None:
        changes["speed"] = round(person.speed * factor, _DIGITS)
    if person.times is not None:
        changes["times"] = tuple(round(time / factor, _DIGITS) for time in person.times)
    if vary.phase:
        changes["phase"] = phase
    if vary.bodies:
        changes["body"] = body
    return person.model_copy(update=changes)


def _varied_juggler(juggler: Juggler, vary: Vary, generator: np.random.Generator) -> Juggler:
    """The juggler on another day, left or right of where the scene has it, all throws slower or faster.

    Balls fly as gravity has it on every day: who juggles more slowly throws higher.
    """
    aside, faster = generator.uniform(-1.0, 1.0, size=2)
    phase = round(float(generator.uniform(0.0, 2 * sum(juggler.siteswap))), _DIGITS)
    body = str(generator.choice(body_names()))
    facing = np.radians(juggler.facing_deg)
    place = np.array(juggler.position) + aside * vary.sideways_m * np.array([-np.sin(facing), np.cos(facing)])
    factor = 1.0 + float(faster) * vary.speed_share
    changes: dict[str, object] = {
        "position": tuple(round(float(metres), _DIGITS) for metres in place),
        "beat_s": round(juggler.beat_s / factor, _DIGITS),
        "dwell_s": round(juggler.dwell_s / factor, _DIGITS),
    }
    if vary.phase:
        changes["phase"] = phase
    if vary.bodies:
        changes["body"] = body
    return juggler.model_copy(update=changes)


def _beside(motion: Motion, aside_m: float) -> Motion:
    """The motion performed to the left of where the scene has it, as seen by who performs it."""
    heading = np.radians(motion.heading_deg)
    place = np.array(motion.position) + aside_m * np.array([-np.sin(heading), np.cos(heading)])
    return motion.model_copy(update={"position": tuple(round(float(metres), _DIGITS) for metres in place)})


def _shifted(waypoints: Waypoints, aside_m: float, leader: Waypoints) -> Waypoints:
    """The way-points, all moved to the left of the direction of the leader's path.

    The direction is from its first to its last, or, where these are one, that of the first stretch; somebody
    who stands is taken to face along x.
    """
    places = np.array(leader)
    stretches = np.array([places[-1] - places[0], *np.diff(places, axis=0), (1.0, 0.0)])
    direction = stretches[np.argmax(stretches.any(axis=1))]
    left = np.array([-direction[1], direction[0]]) / np.hypot(*direction)
    moved = np.round(np.array(waypoints) + aside_m * left, _DIGITS)
    return tuple((float(x), float(y)) for x, y in moved)
