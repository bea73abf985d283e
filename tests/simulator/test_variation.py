"""Seeds vary people's walks within the stated ranges, and keep people clear of one another and of obstacles."""

from math import dist
from typing import Any

import numpy as np
import pytest

from recording.errors import InputError
from simulator.clearance import smallest_clearance
from simulator.scene import Scene, load_scene
from simulator.stage import walkers_centres
from simulator.things import Obstacle
from simulator.variation import varied

SEEDS = range(1, 41)


def scene_of(**changes: Any) -> Scene:
    return Scene.model_validate(load_scene("wall").model_dump() | changes)


def clearance_of(scene: Scene) -> tuple[float, float]:
    clearance = smallest_clearance(walkers_centres(scene), scene.obstacles)
    return clearance.people_m, clearance.obstacles_m


def test_seed_zero_is_the_scene_itself() -> None:
    scene = load_scene("wall")
    assert varied(scene, 0) is scene


def test_the_same_seed_is_the_same_day_and_another_one_another() -> None:
    scene = load_scene("wall")
    assert varied(scene, 3) == varied(scene, 3)
    assert varied(scene, 3) != varied(scene, 4)


def test_a_day_does_not_depend_on_the_pictures_size() -> None:
    large = scene_of(camera=load_scene("wall").camera.model_dump() | {"width": 640, "height": 480})
    assert varied(large, 5).people == varied(load_scene("wall"), 5).people


def test_everything_that_may_vary_varies_within_its_range() -> None:
    scene = load_scene("wall")
    drawn = [varied(scene, seed).people[0] for seed in SEEDS]
    first = scene.people[0]
    aside = np.array([person.waypoints[0][1] - first.waypoints[0][1] for person in drawn])
    share = np.array([(person.speed or 0) / (first.speed or 1) - 1 for person in drawn])
    later = np.array([person.start - first.start for person in drawn])
    for values, limit in ((aside, 0.3), (share, 0.15), (later, 0.3)):
        assert np.abs(values).max() <= limit + 1e-3
        assert np.ptp(values) > limit
    assert len({person.body for person in drawn}) == 4
    assert np.ptp([person.phase for person in drawn]) > 0.5
    assert all(varied(scene, seed).obstacles == scene.obstacles for seed in SEEDS)


def test_what_may_not_vary_stays() -> None:
    fixed = {"sideways_m": 0, "speed_share": 0, "start_s": 0, "phase": False, "bodies": False}
    scene = scene_of(vary=fixed)
    assert varied(scene, 7) == scene


def test_times_vary_as_speeds_do() -> None:
    walk = {"body": "man", "waypoints": [[-1, 2], [1, 2]], "times": [0, 2]}
    durations = [varied(scene_of(people=[walk]), seed).people[0].times for seed in SEEDS]
    factors = np.array([2 / times[1] for times in durations if times is not None])
    assert np.abs(factors - 1).max() <= 0.151
    assert np.ptp(factors) > 0.15


def test_together_everybody_changes_alike() -> None:
    opposite = [
        {"body": "man", "waypoints": [[-3, 1], [3, 1]], "speed": 1.2, "start": -1},
        {"body": "teen", "waypoints": [[3, 2], [-3, 2]], "speed": 1.4},
    ]
    scene = scene_of(people=opposite, vary={"together": True})
    for seed in SEEDS:
        one, other = varied(scene, seed).people
        assert one.waypoints[0][1] - 1 == pytest.approx(other.waypoints[0][1] - 2, abs=1e-3)
        assert (one.speed or 0) / 1.2 == pytest.approx((other.speed or 0) / 1.4, abs=1e-3)
        assert one.start + 1 == pytest.approx(other.start, abs=1e-3)
        assert (one.phase, one.body) == (other.phase, other.body)
    assert len({varied(scene, seed).people[0].body for seed in SEEDS}) == 4
    assert varied(scene, 3) == varied(scene, 3)


def test_nobody_varied_is_faster_than_people_walk() -> None:
    walk = {"body": "man", "waypoints": [[-1, 2], [1, 2]], "speed": 2.5}
    assert max(varied(scene_of(people=[walk]), seed).people[0].speed or 0 for seed in SEEDS) == 2.5


def test_people_keep_clear_on_every_day() -> None:
    scene = load_scene("wall")
    for seed in SEEDS:
        people_m, obstacles_m = clearance_of(varied(scene, seed))
        assert people_m >= 0.6
        assert obstacles_m >= 0.3


@pytest.mark.parametrize("name", ["9men", "house", "forest", "4men"])
def test_a_scene_of_table_1_has_its_days(name: str) -> None:
    scene = load_scene(name)
    aside = []
    for seed in (*range(1, 21), *range(1001, 1011)):
        day = varied(scene, seed)
        people_m, obstacles_m = clearance_of(day)
        assert people_m >= 0.6
        assert obstacles_m >= 0.3
        aside += [dist(a.waypoints[0], b.waypoints[0]) for a, b in zip(scene.people, day.people, strict=True)]
    assert max(aside) <= 0.3 + 1e-3
    assert np.mean(aside) > 0.1  # Of 0.15, were there nobody and nothing to keep clear of.


def test_a_scene_without_a_clear_day_is_refused() -> None:
    walk = {"body": "man", "waypoints": [[-2, 1], [2, 1]], "speed": 1.2}
    with pytest.raises(InputError, match=r"seed 1: in \d+ rounds people never kept 3.0 m"):
        varied(scene_of(people=[walk, walk], vary={"clearance_m": 3}), 1)


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(InputError, match="expected a seed of 0"):
        varied(load_scene("wall"), -1)


@pytest.mark.parametrize(
    ("obstacle", "distance_m"),
    [
        ({"shape": "box", "size": (2, 1, 1), "position": (0, 0, 0)}, 1.0),
        ({"shape": "box", "size": (2, 1, 1), "position": (0, 0, 0), "yaw_deg": 90}, 1.5),
        ({"shape": "box", "size": (4.2, 1, 1), "position": (0, 0, 0)}, 0.0),
        ({"shape": "cylinder", "radius": 0.5, "height": 1, "position": (0, 0, 0)}, 1.5),
        ({"shape": "cone", "radius": 0.5, "height": 1, "position": (2, 1, 0)}, 0.5),
        ({"shape": "box", "size": (9, 9, 1), "position": (0, 0, 2.2)}, np.inf),
    ],
)
def test_the_distance_from_an_obstacle_is_that_from_its_outline(obstacle: dict[str, Any], distance_m: float) -> None:
    centre = np.array([[2.0, 0.0], [3.0, 0.0]])
    clearance = smallest_clearance([centre], [Obstacle.model_validate(obstacle)])
    assert clearance.obstacles_m == pytest.approx(distance_m)
    assert clearance.people_m == np.inf


def test_people_are_as_near_as_in_the_frame_in_which_they_are_nearest() -> None:
    there = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    back = np.array([[2.0, 1.0], [1.0, 1.0], [0.0, 1.0]])
    assert smallest_clearance([there, back], []).people_m == pytest.approx(1.0)


def test_a_clearance_is_said_in_words() -> None:
    there, beside = np.array([[0.0, 0.0]]), np.array([[0.0, 1.5]])
    post = Obstacle(shape="cylinder", radius=0.5, height=1.0, position=(1.0, 0.0, 0.0))
    said = smallest_clearance([there, beside], [post]).sentence
    assert said == "at least 1.50 m between two people and 0.50 m between a person and an obstacle"
    assert smallest_clearance([there], []).sentence == "nobody near another"
