"""From a scene to a recording: whole, exact, repeatable, the same from both backends; and the wall's row of Table 1."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recording.errors import InputError
from recording.recording import Recording, stripped
from recording.store import load_recording
from recording.verify import verify
from simulator.scene import Scene, load_scene
from simulator.simulate import picture_size, prepared, simulate, write_simulation

HIDDEN_SHARE = 0.2
SMALL: dict[str, Any] = {
    "name": "small",
    "frames": 5,
    "fps": 10,
    "camera": {"width": 48, "height": 36, "position": [0, -4, 1.5], "look_at": [0, 0, 1]},
    "people": [{"body": "woman", "waypoints": [[-1, 0.5], [1, 0.5]], "speed": 1.4, "start": -0.3}],
    "balls": [{"radius": 0.3, "waypoints": [[1, 0, 1], [0.5, 0, 1.4]], "times": [0, 0.4]}],
    "obstacles": [{"name": "post", "shape": "cylinder", "radius": 0.2, "height": 1.5, "position": [-0.3, -0.8, 0]}],
}


@pytest.fixture(scope="module")
def small() -> Scene:
    return Scene.model_validate(SMALL)


@pytest.fixture(scope="module")
def recording(small: Scene) -> Recording:
    return simulate(small)


def test_a_recording_says_what_it_shows(recording: Recording) -> None:
    objects = recording.metadata.objects or ()
    assert [(entry.id, entry.name, entry.kind, entry.moving) for entry in objects] == [
        (1, "person 1", "person", True),
        (2, "ball 1", "ball", True),
        (3, "post", "cylinder", False),
    ]
    labels = [frame.labels for frame in recording.frames]
    assert {int(value) for one in labels if one is not None for value in np.unique(one.objectid)} == {0, 1, 2, 3}
    assert recording.metadata.sensor == {"preset": "ideal"}
    assert recording.metadata.seed == 0


def test_a_recording_passes_its_own_check(recording: Recording) -> None:
    report = verify(recording)
    assert report.passes, report


def test_the_ideal_sensor_changes_nothing(recording: Recording) -> None:
    for frame in recording.frames:
        assert frame.clean_depth is not None
        assert frame.reason is not None
        np.testing.assert_array_equal(frame.depth, frame.clean_depth)
        np.testing.assert_array_equal(frame.reason == 0, frame.seen)


def test_the_resolved_scene_alone_makes_the_same_recording(recording: Recording) -> None:
    day = simulate(Scene.model_validate(SMALL), seed=4)
    again = simulate(Scene.model_validate(day.metadata.scene))
    assert again.digest() == day.digest() != recording.digest()
    assert again.metadata.scene_digest == day.metadata.scene_digest != recording.metadata.scene_digest


def test_written_frames_are_the_same_bytes_each_time(small: Scene, tmp_path: Path) -> None:
    for folder in ("a", "b"):
        write_simulation(prepared(small, seed=1), tmp_path / folder)
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.*"))
    assert len(files) == 12  # Five frames, five X-rays, recording.json, truth.npz.
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_what_is_written_is_what_is_simulated(recording: Recording, small: Scene, tmp_path: Path) -> None:
    write_simulation(prepared(small), tmp_path / "small")
    stored = load_recording(tmp_path / "small")
    assert stored.metadata == recording.metadata
    assert stored.digest() == recording.digest()
    assert verify(stored) == verify(recording)


def test_the_lines_in_the_documentation_read_a_frame(small: Scene, tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "recording.md").read_text(encoding="utf-8")
    lines = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    write_simulation(prepared(small), tmp_path / "small")
    ran = subprocess.run(
        [sys.executable, "-c", "".join(lines)], cwd=tmp_path / "small", capture_output=True, text=True, check=True
    )
    assert float(ran.stdout.split(":")[1]) < 1e-4


def test_a_stripped_copy_has_the_same_digest(recording: Recording) -> None:
    bare = stripped(recording)
    assert bare.digest() == recording.digest()
    assert bare.metadata.objects is None
    assert bare.frames[0].labels is None


def test_both_backends_tell_the_same(small: Scene, recording: Recording) -> None:
    scalar = simulate(small, backend="scalar")
    for one, other in zip(recording.frames, scalar.frames, strict=True):
        assert one.labels is not None
        assert other.labels is not None
        differ = (one.labels.objectid != other.labels.objectid) | (one.labels.face != other.labels.face)
        assert differ.mean() < 0.001
        np.testing.assert_array_equal(one.depth[~differ], other.depth[~differ])


def test_the_x_ray_shows_what_is_hidden(recording: Recording) -> None:
    assert recording.xray is not None
    hidden = 0
    for frame, xray in zip(recording.frames, recording.xray, strict=True):
        assert set(xray) == {1, 2}
        assert frame.labels is not None
        behind = np.isfinite(xray[1]) & (frame.labels.objectid > 1)
        assert np.all(xray[1][behind] > frame.depth[behind])
        hidden += int(behind.sum())
    assert hidden > 50


def test_another_size_is_the_same_view(small: Scene, recording: Recording) -> None:
    large = simulate(small, size=(3 * 48, 3 * 36))
    for one, other in zip(recording.frames, large.frames, strict=True):
        np.testing.assert_allclose(other.depth[1::3, 1::3], one.depth, rtol=1e-5)


def test_fewer_frames_are_the_first_ones(small: Scene) -> None:
    short, whole = simulate(small, seed=2, frames=2), simulate(small, seed=2)
    assert short.metadata.frames == 2
    for one, other in zip(short.frames, whole.frames[:2], strict=True):
        np.testing.assert_array_equal(one.depth, other.depth)


def test_a_single_frame_is_a_recording(small: Scene) -> None:
    one = simulate(small, frames=1)
    assert verify(one).passes
    assert one.moving_ids == (1, 2)


def test_picture_sizes_are_read() -> None:
    assert picture_size("640x480", (48, 36)) == (640, 480)
    assert picture_size("2x", (48, 36)) == (96, 72)
    for wrong in ("640", "x", "0x480", "1.5x", "-2x"):
        with pytest.raises(InputError, match="expected a picture size such as 640x480 or 2x"):
            picture_size(wrong, (48, 36))


@pytest.mark.parametrize(
    ("wish", "sentence"),
    [
        ({"frames": 0}, "frames: input should be greater than 0"),
        ({"size": (0, 5)}, "camera.width: input should be greater than or equal to 1"),
        ({"sensor": "kinect"}, "sensor.preset: input should be 'ideal'"),
    ],
)
def test_impossible_wishes_are_refused(small: Scene, wish: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        prepared(small, **wish)


def seen_and_whole(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Seen and unoccluded pixels of each moving object in each frame: (object, frame)."""
    assert recording.xray is not None
    counts = [
        [(np.sum(frame.labels.objectid == one), np.isfinite(xray[one]).sum()) for one in recording.moving_ids]
        for frame, xray in zip(recording.frames, recording.xray, strict=True)
        if frame.labels is not None
    ]
    seen, whole = np.array(counts).transpose(2, 1, 0)
    return seen, whole


def hole_lengths(hidden: np.ndarray) -> list[int]:
    """Lengths of the maximal runs of hidden frames that begin and end inside the recording."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], hidden, [False]]).astype(int)))
    runs = edges.reshape(-1, 2)
    return [int(end - begin) for begin, end in runs if begin > 0 and end < len(hidden)]


@pytest.mark.parametrize("scale", [1, 2])
def test_the_wall_meets_its_row_of_table_1(scale: int) -> None:
    wall = load_scene("wall")
    recording = simulate(wall, size=(scale * wall.camera.width, scale * wall.camera.height))
    seen, whole = seen_and_whole(recording)
    holes = [length for one in seen < HIDDEN_SHARE * whole for length in hole_lengths(one)]
    assert recording.metadata.frames == 100
    assert len(holes) == 2
    assert abs(max(holes) - 35) <= 2
    points = np.mean([frame.seen.sum() for frame in recording.frames]) / scale**2
    assert points == pytest.approx(4800, rel=0.15)


def test_nobody_in_the_wall_is_cut_by_the_pictures_edge_or_crowded() -> None:
    simulation = prepared("wall")
    assert simulation.clearance.people_m > 0.6
    assert simulation.clearance.obstacles_m > 0.3
    recording = simulate("wall")
    assert recording.xray is not None
    for xray in recording.xray:
        for depth in xray.values():
            border = np.concatenate([depth[0], depth[-1], depth[:, 0], depth[:, -1]])
            assert np.isnan(border).all()
            assert np.isfinite(depth).sum() > 100


def test_people_who_walk_through_each_other_are_refused_unless_it_is_a_stress_test(tmp_path: Path) -> None:
    text = """
name = "clash"
frames = 30
fps = 15
[camera]
position = [0, -4, 1.5]
look_at = [0, 0, 1]
[[people]]
body = "man"
waypoints = [[-1, 0], [1, 0]]
speed = 1.0
[[people]]
body = "woman"
waypoints = [[1, 0], [-1, 0]]
speed = 1.0
"""
    place = tmp_path / "clash.toml"
    place.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"clash.*expected 0\.6 m between the centres of people.*got at least 0\.0"):
        prepared(place)
    place.write_text("stress_test = true\n" + text, encoding="utf-8")
    assert prepared(place).clearance.people_m < 0.1
