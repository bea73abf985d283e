"""Recorded crowds: windows, turns and people that suit a scene, scenes that stand for themselves, errors in a line."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recording.errors import InputError
from simulator.casting import Surroundings
from simulator.crowds import Crowds
from simulator.recorded_crowd import RecordedCrowd, crowd_in, crowd_tracks, recorded_walks
from simulator.scene import CameraSpot, Scene, load_scene
from simulator.simulate import prepared
from simulator.social_force import social_force_walks
from simulator.stage import walkers_centres
from simulator.things import Obstacle
from simulator.tracks import STEP_S
from simulator.walk_record import RUN_OUT_S

FPS = 16
SCENE = """
name = "recorded"
frames = 30
fps = 10
camera = {{width = 64, height = 48, position = [0, -6, 1.6], look_at = [0, 0, 1]}}
{more}
[crowd]
file = "walks.txt"
{crowd}
"""
READING = "fps = 16\nunit = 'cm'"
CAMERA = CameraSpot(width=64, height=48, position=(0, -6, 1.6), look_at=(0, 0, 1)).as_camera()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of 24 people, eight at a time, who cross a place far from the origin, in centimetres."""
    folder = tmp_path_factory.mktemp("crowd")
    angle = np.arange(8) * 2 * np.pi / 8 + np.array([[0.1], [0.5], [0.8]])
    starts = 4.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    goals = -starts[:, np.roll(np.arange(8), 1)]
    speeds = np.tile(np.linspace(1.0, 1.5, 8), (3, 1))
    crowds = Crowds(starts=starts, goals=goals, speeds=speeds, discs=np.zeros((3, 0, 3)))
    walks = 100 * (social_force_walks(crowds, seconds=6.0, step_s=1 / FPS) + np.array([31.0, -17.0]))
    with (folder / "walks.txt").open("w") as file:
        file.write("id frame x/cm y/cm z/cm\n")
        for (crowd, person, moment), x in np.ndenumerate(walks[..., 0]):
            y = walks[crowd, person, moment, 1]
            file.write(f"{8 * crowd + person} {1000 + 100 * crowd + moment} {x:.1f} {y:.1f} 170\n")
    return folder


def around(**more: Any) -> Surroundings:
    return replace(Surroundings(camera=CAMERA, seconds=3.0), **more)


def crowd(**more: object) -> RecordedCrowd:
    return RecordedCrowd.model_validate({"file": "walks.txt", "fps": FPS, "unit": "cm"} | more)


def nearest_m(walks: np.ndarray) -> float:
    during = walks[:, : round(3.0 / STEP_S) + 1]
    return float(min(np.linalg.norm(a - b, axis=-1).min() for a, b in combinations(during, 2)))


@pytest.mark.parametrize("seed", [None, 1, 2, 3])
def test_people_are_as_many_as_wanted_in_view_and_apart(folder: Path, seed: int | None) -> None:
    wanted = crowd(people=[3, 5])
    generator = None if seed is None else np.random.default_rng(seed)
    walks = recorded_walks(wanted, crowd_tracks(crowd_in(folder, wanted)), around(), generator=generator)
    assert 3 <= len(walks) <= 5
    assert walks.shape[1] == round((3.0 + RUN_OUT_S) / STEP_S) + 1
    assert nearest_m(walks) >= 0.6
    chest = np.concatenate([walks, np.full((*walks.shape[:2], 1), 1.2)], axis=-1)
    assert CAMERA.contains(CAMERA.pixel_from_world(chest)[0]).any(axis=1).all()


def test_the_same_generator_chooses_the_same_and_others_choose_otherwise(folder: Path) -> None:
    wanted = crowd(people=[2, 4])
    tracks = crowd_tracks(crowd_in(folder, wanted))
    drawn = [recorded_walks(wanted, tracks, around(), generator=np.random.default_rng(seed)) for seed in (1, 1, 2, 3)]
    np.testing.assert_array_equal(drawn[0], drawn[1])
    assert any(other.shape != drawn[0].shape or not np.array_equal(other, drawn[0]) for other in drawn[2:])


def test_what_is_given_is_not_chosen(folder: Path) -> None:
    given = crowd(first_frame=1100, shift=[-31.0, 17.0], turn_deg=0.0, people=[8, 8])
    tracks = crowd_tracks(crowd_in(folder, given))
    walks = recorded_walks(given, tracks, around())
    own = [track for track in tracks.tracks if track.begin_s == pytest.approx(100 / FPS)]
    times = 100 / FPS + STEP_S * np.arange(walks.shape[1])
    np.testing.assert_allclose(walks, [track.at(times) - (31.0, -17.0) for track in own], atol=1e-9)
    turned = recorded_walks(crowd(first_frame=1100, shift=[17.0, 31.0], turn_deg=-90, people=[1, 8]), tracks, around())
    assert min(np.linalg.norm(walks[..., ::-1] * (1, -1) - one, axis=(1, 2)).min() for one in turned) < 1e-6


def test_obstacles_and_a_low_camera_are_kept_clear_of(folder: Path) -> None:
    pillar = Obstacle(shape="cylinder", radius=0.6, height=2.2, position=(0.0, 0.0, 0.0))
    wanted = crowd(people=[2, 8])
    walks = recorded_walks(wanted, crowd_tracks(crowd_in(folder, wanted)), around(obstacles=(pillar,), obstacles_m=0.4))
    during = walks[:, : round(3.0 / STEP_S) + 1]
    assert np.linalg.norm(during, axis=-1).min() >= 1.0
    assert np.linalg.norm(during - (0.0, -6.0), axis=-1).min() >= 1.0


def test_a_scene_takes_its_people_from_a_file_and_then_stands_for_itself(folder: Path) -> None:
    (folder / "mine.toml").write_text(
        SCENE.format(more="", crowd=READING + "\npeople = [3, 6]\nbodies = ['woman', 'man']")
    )
    scene = load_scene(folder / "mine.toml")
    assert 3 <= len(scene.people) <= 6
    assert [person.body for person in scene.people[:3]] == ["woman", "man", "woman"]
    assert len({person.phase for person in scene.people}) == len(scene.people)
    simulation = prepared(scene)
    assert simulation.clearance.people_m >= 0.6
    assert "crowd" not in simulation.metadata.model_dump()["scene"]
    again = prepared(Scene.model_validate(simulation.metadata.scene))
    np.testing.assert_array_equal(again.truth[1].vertices, simulation.truth[1].vertices)
    speeds = np.linalg.norm(np.diff(walkers_centres(scene), axis=1), axis=-1) * scene.fps
    assert speeds[:, -5:].min() > 0.3  # Nobody stops because the scene ends.


@pytest.mark.parametrize(
    ("more", "given", "sentence"),
    [
        ("", READING + "\npeople = [20, 30]", r"walks\.txt: expected 2\.9 s with at least 20 people .* got 1?[0-9]:"),
        ("", "fps = 16", r"walks\.txt: expected .* or check fps and unit"),
        ("vary = {clearance_m = 4.0}", READING + "\npeople = [6, 8]", "who keep 4 m from one another"),
        ("", READING + "\nfirst_frame = 2000", r"expected a first_frame from 1000 to 1296, the file's own, got 2000"),
        ("", READING + "\nfirst_frame = 10", "expected a first_frame from 1000"),
        ("", READING + "\npeople = [5, 3]", r"expected 'people' to be .at least, at most., got .5, 3."),
        ("", READING + "\nbodies = []", "bodies"),
        ("", READING + "\nbodies = ['womn']", "'woman'"),
        ("", "unit = 'cm'", "crowd: key 'fps' is missing"),
        ("", READING + "\nfrist_frame = 3", "unknown key 'frist_frame'.*first_frame"),
        ("people = []", READING, "expected it in place of 'people', got both"),
    ],
)
def test_what_is_impossible_is_refused_in_one_line(folder: Path, more: str, given: str, sentence: str) -> None:
    (folder / "wrong.toml").write_text(SCENE.format(more=more, crowd=given))
    with pytest.raises(InputError, match=sentence) as refused:
        load_scene(folder / "wrong.toml")
    assert "\n" not in str(refused.value)


def test_a_file_outside_the_folder_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="expected one in the scene's folder"):
        crowd_in(folder, crowd(file="../walks.txt"))
