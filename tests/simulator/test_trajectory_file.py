"""Trajectory files: every way in which data sets write them, smooth walks from them, and errors that name the line."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from recording.errors import InputError
from simulator.path import path_through
from simulator.scene import load_scene
from simulator.simulate import prepared
from simulator.trajectory_file import Trajectory, recorded_walk

FPS = 25
FRAMES = np.arange(100, 200)
SCENE = """
name = "recorded"
frames = 8
fps = 10
camera = {{width = 48, height = 36, position = [0, -5, 1.5], look_at = [0, 0, 1]}}
[[people]]
body = "man"
trajectory = {{{trajectory}}}
"""


def place_at(frame: np.ndarray) -> np.ndarray:
    """A curve walked at about 1.3 m/s, metres."""
    time = (frame - FRAMES[0]) / FPS
    return np.stack([-2 + 1.2 * time, 0.5 + 0.4 * np.sin(time)], axis=-1)


def lines(write: Callable[[int, float, float], str], frames: np.ndarray = FRAMES, scale: float = 1.0) -> str:
    places = scale * place_at(frames)
    return "".join(write(frame, x, y) + "\n" for frame, (x, y) in zip(frames.tolist(), places.tolist(), strict=True))


def plain(frame: int, x: float, y: float) -> str:
    return f"3 {frame} {x:.5f} {y:.5f}"


def walk_error(folder: Path, **reading: object) -> float:
    """The farthest that the walk made from the file is from the curve, metres."""
    reading = {"file": "walks.txt", "id": 3, "fps": FPS} | reading
    waypoints, times = recorded_walk(Trajectory.model_validate(reading), folder)
    time = np.linspace(0, (len(FRAMES) - 1) / FPS, 500)
    path = path_through(waypoints, times=times)
    return float(np.linalg.norm(path.positions(time) - place_at(FRAMES[0] + time * FPS), axis=1).max())


@pytest.mark.parametrize(
    ("text", "reading"),
    [
        (lines(plain), {}),
        (lines(lambda f, x, y: f"3\t{f}\t{x}\t{y}\t1.76"), {}),
        ("id,frame,x,y,z\n" + lines(lambda f, x, y: f"3,{f},{x},{y},0"), {}),
        ("frame;y;x;id\n" + lines(lambda f, x, y: f"{f};{y};{x};3"), {}),
        (
            "# framerate: 25\n#id frame x/cm y/cm z/cm\n" + lines(lambda f, x, y: f"3 {f} {x} {y} 176", scale=100),
            {"unit": "cm"},
        ),
        ("person;time;east;north\n" + lines(lambda f, x, y: f"3;{f};{x};{y}"), {}),
        ("id frame x/m y/m\n" + lines(lambda f, x, y: f"3.0 {f}.0 {x} {y} # seen"), {}),
        ("\n".join(reversed(lines(plain).splitlines())), {}),
        (lines(plain, frames=np.delete(FRAMES, np.s_[40:47])), {}),
        (lines(plain) + lines(lambda f, x, y: f"4 {f} {-x} {y}"), {}),
        (lines(plain) + "4 60 0 0\n4 61 0 0\n", {"first_frame": 100}),
    ],
    ids=[
        "plain",
        "tabs and z",
        "commas and header",
        "columns by name",
        "centimetres",
        "other names",
        "units",
        "unsorted",
        "gap",
        "two",
        "first",
    ],
)
def test_a_file_becomes_the_walk_that_it_tells(tmp_path: Path, text: str, reading: dict[str, object]) -> None:
    (tmp_path / "walks.txt").write_text(text)
    assert walk_error(tmp_path, **reading) < 0.005


@pytest.mark.parametrize("fps", [2.5, 8, 60])
def test_any_frame_rate_gives_the_same_walk(tmp_path: Path, fps: float) -> None:
    frames = np.arange(int(4 * fps))
    time = frames / fps
    rows = np.stack([-2 + 1.2 * time, 0.5 + 0.4 * np.sin(time)], axis=-1)
    text = "".join(f"3 {frame} {x} {y}\n" for frame, (x, y) in zip(frames.tolist(), rows.tolist(), strict=True))
    (tmp_path / "walks.txt").write_text(text)
    waypoints, times = recorded_walk(Trajectory(file="walks.txt", id=3, fps=fps), tmp_path)
    reached = np.linspace(0, time[-1], 200)
    truth = np.stack([-2 + 1.2 * reached, 0.5 + 0.4 * np.sin(reached)], axis=-1)
    walked = path_through(waypoints, times=times).positions(reached)
    assert np.linalg.norm(walked - truth, axis=1).max() < 0.01


def test_small_noise_is_smoothed(tmp_path: Path) -> None:
    generator = np.random.default_rng(5)
    noisy = place_at(FRAMES) + generator.normal(scale=0.02, size=(len(FRAMES), 2))
    rows = zip(FRAMES.tolist(), noisy.tolist(), strict=True)
    (tmp_path / "walks.txt").write_text("".join(f"3 {frame} {x} {y}\n" for frame, (x, y) in rows))
    assert walk_error(tmp_path) < 0.03
    waypoints, times = recorded_walk(Trajectory(file="walks.txt", id=3, fps=FPS), tmp_path)
    velocity = np.gradient(path_through(waypoints, times=times).positions(np.arange(0.2, 3.8, 0.01)), 0.01, axis=0)
    assert np.linalg.norm(velocity, axis=1).max() < 1.6


def test_the_ground_is_turned_then_shifted(tmp_path: Path) -> None:
    (tmp_path / "walks.txt").write_text("7 0 0 0\n7 10 1 0\n")
    reading = Trajectory(file="walks.txt", id=7, fps=10, turn_deg=90, shift=(5, 1))
    waypoints, times = recorded_walk(reading, tmp_path)
    assert (waypoints[0], waypoints[-1]) == ((5.0, 1.0), (5.0, 2.0))
    assert (times[0], times[-1]) == (0.0, 1.0)


def test_a_scene_drives_a_body_by_a_file_beside_it_and_then_stands_for_itself(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "walks.txt").write_text(lines(plain))
    (tmp_path / "mine.toml").write_text(SCENE.format(trajectory='file = "data/walks.txt", id = 3, fps = 25'))
    simulation = prepared(tmp_path / "mine.toml")
    body = simulation.truth[1].vertices.mean(axis=1)
    centre = place_at(FRAMES[0] + np.arange(8) / 10 * FPS)
    assert np.linalg.norm(body[:, :2] - centre, axis=1).max() < 0.15
    again = prepared(type(simulation.scene).model_validate(simulation.metadata.scene))
    np.testing.assert_array_equal(again.truth[1].vertices, simulation.truth[1].vertices)
    assert prepared(tmp_path / "mine.toml", seed=4).scene != simulation.scene


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("3 0 1 1\n3 1 1\n", r"walks\.txt, line 2: expected numbers 'id frame x y \[z\]', got '3 1 1'"),
        ("id frame x y\n3 0 one 1\n", "line 2: expected numbers"),
        ("# comment\n3 0 1 1\n\n3 1 nan 1\n", "line 4: expected finite numbers"),
        ("3 0 1 1\n3 1 inf 1\n", "line 2: expected finite"),
        ("3 0 1 1\n4 0 1 1\n3 0 2 2\n", "line 3: expected every frame of id 3 once, got 0 again"),
        ("3 0 1 1\n4 0 1 1\n", "two rows at least of id 3, got 1; its ids: 3, 4"),
        ("# nothing\n", "expected lines 'id frame x y', got none"),
    ],
)
def test_what_cannot_be_read_is_named_by_file_and_line(tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / "walks.txt").write_text(text)
    with pytest.raises(InputError, match=sentence):
        recorded_walk(Trajectory(file="walks.txt", id=3, fps=FPS), tmp_path)


@pytest.mark.parametrize("file", ["../walks.txt", "/etc/passwd", "data/../../walks.txt", "link.txt"])
def test_a_path_out_of_the_scenes_folder_is_refused(tmp_path: Path, file: str) -> None:
    (tmp_path / "walks.txt").write_text(lines(plain))
    folder = tmp_path / "scenes"
    (folder / "data").mkdir(parents=True)
    (folder / "link.txt").symlink_to(tmp_path / "walks.txt")
    with pytest.raises(InputError, match="expected one in the scene's folder"):
        recorded_walk(Trajectory(file=file, id=3, fps=FPS), folder)


@pytest.mark.parametrize(
    ("trajectory", "sentence"),
    [
        ('file = "none.txt", id = 3, fps = 25', r"none\.txt: expected a readable text file"),
        ('file = "walks.txt", id = 3', "people.0.trajectory: key 'fps' is missing"),
        ('file = "walks.txt", id = 3, fps = 25, unit = "mm"', "unit: input should be 'm' or 'cm'"),
        ('file = "walks.txt", id = 3, fps = 25}\nspeed = 1 #', "in place of 'speed', got both"),
        ('file = "walks.txt", id = 3, fps = 90', "people walk at 2.5 m/s at most"),
        ('file = "walks.txt", id = 3, fps = 25, first_frame = 200', "a first_frame from 100 to 199, .* got 200"),
        ('file = "walks.txt", id = 3, fps = 25, first_frame = 99', "a first_frame from 100 to 199, .* got 99"),
    ],
)
def test_what_is_impossible_in_a_scene_is_refused(tmp_path: Path, trajectory: str, sentence: str) -> None:
    (tmp_path / "walks.txt").write_text(lines(plain))
    (tmp_path / "mine.toml").write_text(SCENE.format(trajectory=trajectory))
    with pytest.raises(InputError, match=sentence) as refused:
        load_scene(tmp_path / "mine.toml")
    assert "\n" not in str(refused.value)
