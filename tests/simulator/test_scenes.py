"""The walking scenes of Table 1 meet their rows, measured from the recording alone, at their size and at twice it."""

import functools
from dataclasses import dataclass

import numpy as np
import pytest

from recording.recording import Recording
from recording.visibility import Visibility, holes, longest_hole, visibility_of
from simulator.scene import load_scene
from simulator.simulate import prepared, simulate
from simulator.stage import walkers_centres


@dataclass(frozen=True, kw_only=True)
class Row:
    """What Table 1 of the paper says of a scene."""

    frames: int
    points: int
    people: int
    obstacles: int
    holes: range
    """The numbers of holes that meet the row."""
    longest: int
    """Frames."""
    eps: tuple[float, ...]


ROWS = {
    "9men": Row(
        frames=100, points=2000, people=9, obstacles=0, holes=range(25, 99), longest=10, eps=(0.5, 0.1, 10, 5, 7)
    ),
    "house": Row(
        frames=30, points=3500, people=2, obstacles=1, holes=range(2, 3), longest=8, eps=(0.5, 0.1, 10, 20, 10)
    ),
    "forest": Row(
        frames=110, points=3100, people=1, obstacles=4, holes=range(4, 5), longest=7, eps=(0.5, 0.1, 10, 20, 3)
    ),
    "4men": Row(
        frames=100, points=800, people=4, obstacles=0, holes=range(11, 12), longest=5, eps=(0.2, 0.1, 5, 5, 10)
    ),
}
each_scene = pytest.mark.parametrize("name", ROWS)
each_size = pytest.mark.parametrize("scale", [1, 2])


@dataclass(frozen=True, kw_only=True)
class Seen:
    """What a recording shows, without its pictures: few of them fit in memory together."""

    visibility: Visibility
    cut: int
    """Pictures of somebody alone that touch the picture's edge."""


@functools.cache
def seen(name: str, scale: int) -> Seen:
    recording = simulate(name, size=f"{scale}x")
    return Seen(visibility=visibility_of(recording), cut=cut_pictures(recording))


def cut_pictures(recording: Recording) -> int:
    alone = [depth for xray in recording.xray or () for depth in xray.values()]
    return sum(
        bool(np.isfinite(np.concatenate([depth[0], depth[-1], depth[:, 0], depth[:, -1]])).any()) for depth in alone
    )


@each_scene
@each_size
def test_a_scene_meets_its_row(name: str, scale: int) -> None:
    row, visibility = ROWS[name], seen(name, scale).visibility
    assert len(visibility.returns) == row.frames
    assert len(visibility.ids) == row.people
    assert len(holes(visibility) or ()) in row.holes
    assert abs((longest_hole(visibility) or 0) - row.longest) <= 2
    assert visibility.points_per_frame / scale**2 == pytest.approx(row.points, rel=0.15)


@each_scene
def test_a_scene_has_what_its_row_counts_and_the_papers_settings(name: str) -> None:
    row, scene = ROWS[name], load_scene(name)
    assert len(scene.obstacles) == row.obstacles
    assert scene.paper is not None
    assert tuple(scene.paper.model_dump().values()) == row.eps


@each_scene
def test_everybody_is_whole_and_large_enough(name: str) -> None:
    alone = seen(name, 1)
    assert alone.visibility.unoccluded is not None
    assert alone.visibility.unoccluded.min() >= 100
    assert alone.cut == 0


@each_scene
def test_nobody_goes_through_anybody_or_anything(name: str) -> None:
    clearance = prepared(name).clearance
    assert clearance.people_m >= 0.6
    assert clearance.obstacles_m >= 0.3


@each_scene
def test_everybody_walks_all_the_time(name: str) -> None:
    scene = load_scene(name)
    for person, centres in zip(scene.people, walkers_centres(scene), strict=True):
        assert 0.6 <= (person.speed or 0.0) <= 1.8
        speed = np.linalg.norm(np.diff(centres, axis=0), axis=1) * scene.fps
        assert speed.min() > 0.9 * (person.speed or 0.0)  # A chord of a curve is shorter than the curve.
        assert person.start < -0.5  # Under way in the first frame on any day.


def test_the_walk_through_the_forest_winds_and_each_tree_hides_once() -> None:
    scene = load_scene("forest")
    (centres,) = walkers_centres(scene)
    ahead = np.diff(centres, axis=0)
    heading_deg = np.degrees(np.arctan2(ahead[:, 1], ahead[:, 0]))
    assert heading_deg.max() > 40
    assert heading_deg.min() < -40
    towards_left = np.diff(heading_deg) > 0
    assert np.sum(towards_left[1:] != towards_left[:-1]) >= 3
    eye = np.array(scene.camera.position[:2])
    trees = np.array([bearing(np.array(tree.position[:2]) - eye) for tree in scene.obstacles])
    passed = holes(seen("forest", 1).visibility) or []
    hiding = [int(np.argmin(np.abs(trees - bearing(centres[(hole.first + hole.stop) // 2] - eye)))) for hole in passed]
    assert hiding == [0, 1, 2, 3]


def bearing(towards: np.ndarray) -> float:
    """The angle on the ground from straight ahead of the camera, radians; positive to the right."""
    return float(np.arctan2(towards[0], towards[1]))
