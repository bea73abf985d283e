"""Scene files: what is allowed, what is not, and what the user is told."""

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recording.checks import validated
from recording.errors import InputError
from simulator.scene import CameraSpot, Scene, load_scene, scene_names

MINIMAL: dict[str, Any] = {
    "name": "small",
    "frames": 5,
    "fps": 30,
    "camera": {"position": [0, -4, 1.5], "look_at": [0, 0, 1]},
    "obstacles": [{"shape": "box", "size": [1, 0.1, 2], "position": [0, 0, 0]}],
}
PERSON = {"body": "man", "waypoints": [[-1, 0], [1, 0]], "speed": 1.2}


def scene_of(**changes: Any) -> Scene:
    return validated(Scene, MINIMAL | changes, source="test")


def test_every_scene_that_comes_with_the_program_loads_and_bears_its_files_name() -> None:
    assert "wall" in scene_names()
    for name in scene_names():
        assert load_scene(name).name == name


def test_a_scene_survives_json() -> None:
    scene = load_scene("wall")
    assert Scene.model_validate(scene.model_dump(mode="json")) == scene


def test_a_path_is_read_as_a_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        'name = "mine"\nframes = 3\nfps = 10\ncamera = {position = [0, -4, 1], look_at = [0, 0, 1]}\n'
        '[[obstacles]]\nshape = "cone"\nradius = 1\nheight = 2\nposition = [0, 0, 0]\n'
    )
    assert load_scene(path) == load_scene(str(path))
    assert load_scene(path).obstacles[0].shape == "cone"


def test_an_unknown_scene_names_the_nearest() -> None:
    with pytest.raises(InputError, match="'wal': did you mean 'wall'"):
        load_scene("wal")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.toml: expected a readable TOML file"):
        load_scene(tmp_path / "none.toml")


def test_the_field_of_view_is_the_angle_between_the_pictures_edges() -> None:
    camera = CameraSpot(width=100, height=50, position=(0, -4, 1), look_at=(0, 0, 1), horizontal_fov_deg=90).as_camera()
    left, right = camera.world_from_pixel(np.array([[0.0, 25.0], [100.0, 25.0]]), np.array([4.0, 4.0]))
    np.testing.assert_allclose([left, right], [[-4, 0, 1], [4, 0, 1]], atol=1e-12)


def test_the_examples_in_the_documentation_are_scenes() -> None:
    text = (Path(__file__).parents[2] / "docs" / "scenes.md").read_text(encoding="utf-8")
    examples = re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)
    least, most = (validated(Scene, tomllib.loads(example), source="docs/scenes.md") for example in examples)
    assert not least.obstacles
    assert {obstacle.shape for obstacle in most.obstacles} == {"box", "cylinder", "cone"}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"frame": 3}, "unknown key 'frame', did you mean 'frames'"),
        ({"camera": MINIMAL["camera"] | {"fov": 3}}, "unknown key 'camera.fov'"),
        ({"people": [PERSON | {"waypoint": 1}]}, "'people.0.waypoint', did you mean 'waypoints'"),
        ({"frames": 0}, "frames: input should be greater than 0, got 0"),
        ({"frames": 2.5}, "frames: input should be a valid integer"),
        ({"fps": float("nan")}, "fps: "),
        ({"name": "../up"}, "name: "),
        (
            {"camera": MINIMAL["camera"] | {"horizontal_fov_deg": 180}},
            "horizontal_fov_deg: .* less than or equal to 179",
        ),
        ({"camera": MINIMAL["camera"] | {"look_at": [0, -4, 1.5]}}, "expected 'look_at' to be another point"),
        ({"camera": {"look_at": [0, 0, 0]}}, "key 'camera.position' is missing"),
        ({"people": [PERSON | {"body": "mann"}]}, "people.0.body: expected a body's name, did you mean 'man'"),
        ({"people": [PERSON | {"waypoints": [[0, 0]]}]}, "people.0.waypoints: .* at least 2"),
        ({"people": [PERSON | {"waypoints": [[0, 0], [0, 0]]}]}, "way-points that differ"),
        ({"people": [PERSON | {"times": [0, 1]}]}, "either 'speed' or 'times', not both"),
        ({"people": [PERSON | {"speed": None}]}, "either 'speed' or 'times'"),
        ({"people": [PERSON | {"speed": 9}]}, "people.0.speed: .* less than or equal to 2.5"),
        ({"people": [PERSON | {"speed": None, "times": [0, 0.1]}]}, "20.0 m/s: people walk at 2.5"),
        ({"people": [PERSON | {"speed": None, "times": [0]}]}, "for each of the 2 way-points, not 1"),
        ({"people": [PERSON | {"speed": None, "times": [1, 1]}]}, "times' that grow"),
        ({"people": [PERSON | {"name": "a"}, PERSON | {"name": "a"}]}, "two are called 'a'"),
        (
            {"balls": [{"radius": 0, "waypoints": [[0, 0, 1], [1, 0, 1]], "speed": 1}]},
            "balls.0.radius: .* greater than 0",
        ),
        ({"obstacles": [{"shape": "bux", "position": [0, 0, 0]}]}, "obstacles.0.shape: .* 'box', 'cylinder' or 'cone'"),
        ({"obstacles": [{"shape": "box", "radius": 1, "position": [0, 0, 0]}]}, "expected a box to have 'size'"),
        ({"obstacles": []}, "expected at least one of 'people', 'jugglers', 'balls' and 'obstacles'"),
        ({"vary": {"speed_share": 1}}, "vary.speed_share: .* less than 1"),
        ({"vary": {"sideway": 1}}, "unknown key 'vary.sideway', did you mean 'sideways_m'"),
        (
            {"sensor": {"preset": "kinect"}},
            "sensor.preset: input should be 'ideal' or 'kinect1' or 'tof' or 'structured_light' or 'stereo', got "
            "'kinect'",
        ),
        ({"paper": {"eps1": 1}}, "key 'paper.eps2' is missing"),
    ],
)
def test_what_is_impossible_is_refused_by_name(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as refused:
        scene_of(**changes)
    assert str(refused.value).startswith("test: ")
    assert "\n" not in str(refused.value)
