"""Seeds: the same scene on another day."""

import numpy as np

from recording.errors import InputError
from simulator.body import body_names
from simulator.clearance import smallest_clearance
from simulator.path import FASTEST_WALK
from simulator.scene import Scene, Vary
from simulator.stage import walkers_centres
from simulator.things import Person

TRIES = 5000
"""Draws before the search for one in which everybody keeps clear is given up."""
_DIGITS = 4  # A tenth of a millimetre: the resolved scene stays readable.


def varied(scene: Scene, seed: int) -> Scene:
    """The scene as it happens under the seed: 0 is the scene itself, another one varies people's walks.

    Every walk is drawn anew, evenly within the ranges of the scene's `[vary]`, until nobody comes nearer to
    somebody or something than `[vary]` allows. The same seed gives the same scene, whatever the picture's
    size. Balls and obstacles stay as they are.
    """
    if seed < 0:
        raise InputError(f"expected a seed of 0 (the scene itself) or above, got {seed}")
    if seed == 0 or not scene.people:
        return scene
    generator = np.random.default_rng(seed)
    for _ in range(TRIES):
        people = tuple(_varied_person(person, scene.vary, generator) for person in scene.people)
        day = scene.model_copy(update={"people": people})
        clearance = smallest_clearance(walkers_centres(day), day.obstacles)
        keep_off_people = clearance.people_m >= scene.vary.clearance_m
        if keep_off_people and clearance.obstacles_m >= scene.vary.obstacle_clearance_m:
            return day
    raise InputError(
        f"scene {scene.name!r}, seed {seed}: in {TRIES} draws people never kept {scene.vary.clearance_m} m from one "
        f"another and {scene.vary.obstacle_clearance_m} m from obstacles: narrow the ranges of [vary], or lower these"
    )


def _varied_person(person: Person, vary: Vary, generator: np.random.Generator) -> Person:
    """The person on another day; always draws the same amount of randomness, whatever may vary."""
    aside, faster, later = generator.uniform(-1.0, 1.0, size=3)
    phase = round(float(generator.uniform()), _DIGITS)
    body = str(generator.choice(body_names()))
    factor = min(1.0 + float(faster) * vary.speed_share, FASTEST_WALK / max(person.top_speed, 1e-9))
    changes: dict[str, object] = {
        "waypoints": _shifted(person.waypoints, float(aside) * vary.sideways_m),
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


def _shifted(waypoints: tuple[tuple[float, float], ...], aside_m: float) -> tuple[tuple[float, float], ...]:
    """The way-points, all moved to the left of the path's direction.

    The direction is from the first to the last, or, where these are one, that of the first stretch; somebody
    who stands is taken to face along x.
    """
    places = np.array(waypoints)
    stretches = np.array([places[-1] - places[0], *np.diff(places, axis=0), (1.0, 0.0)])
    direction = stretches[np.argmax(stretches.any(axis=1))]
    left = np.array([-direction[1], direction[0]]) / np.hypot(*direction)
    moved = np.round(places + aside_m * left, _DIGITS)
    return tuple((float(x), float(y)) for x, y in moved)
