"""The scenes in the manner of the paper's scans meet their rows of Table 1, at their own size and at twice it."""

import functools
from dataclasses import dataclass

import numpy as np
import pytest

from recording.recording import Recording
from recording.verify import verify
from recording.visibility import holes, longest_hole, visibility_of
from simulator.scene import load_scene
from simulator.simulate import prepared, simulate


@dataclass(frozen=True, kw_only=True)
class Row:
    """What Table 1 says of a scan; its points are a range over the frames."""

    frames: int
    points: tuple[int, int]
    people: int
    holes: int
    longest: int
    props: list[str]
    """What the people of ours carry."""


ROWS = {
    "scan1": Row(frames=16, points=(3000, 8000), people=2, holes=1, longest=3, props=["coat", "umbrella"]),
    "scan2": Row(frames=22, points=(2300, 5000), people=3, holes=1, longest=4, props=["coat"]),
    "scan3": Row(frames=20, points=(2300, 6500), people=3, holes=2, longest=4, props=["coat", "umbrella", "suitcase"]),
}
each_scan = pytest.mark.parametrize("name", ROWS)


@functools.cache
def recorded(name: str) -> Recording:
    return simulate(name)


@each_scan
def test_a_scan_has_the_frames_the_people_and_the_props_of_its_row(name: str) -> None:
    scene, row = load_scene(name), ROWS[name]
    assert (scene.frames, scene.fps, len(scene.people), scene.obstacles) == (row.frames, 15, row.people, ())
    assert [prop.kind for person in scene.people for prop in person.props] == row.props
    assert scene.sensor.model_dump() == {
        "preset": "structured_light",
        "sigma_m": 0.001,
        "hole_share": 0.01,
        "hole_px": 1.5,
        "nearest_m": 0.5,
        "farthest_m": 10.0,
        "seed": 0,
    }
    assert scene.paper is not None
    assert tuple(scene.paper.model_dump().values()) == (1, 0.01, 1, 20, 3)
    assert 1.2 <= scene.camera.position[2] <= 1.6


@each_scan
@pytest.mark.parametrize("scale", [1, 2])
def test_a_scan_has_the_holes_of_its_row_at_every_size(name: str, scale: int) -> None:
    visibility = visibility_of(recorded(name) if scale == 1 else simulate(name, size=f"{scale}x"))
    assert len(holes(visibility) or []) == ROWS[name].holes
    assert abs((longest_hole(visibility) or 0) - ROWS[name].longest) <= 2
    assert visibility.unoccluded is not None
    assert visibility.unoccluded.min() >= 100


@each_scan
def test_a_scan_has_the_points_of_its_row_in_every_frame(name: str) -> None:
    fewest, most = ROWS[name].points
    returns = visibility_of(recorded(name)).returns
    assert fewest <= returns.min() <= returns.max() <= most


@each_scan
def test_people_keep_clear_of_one_another_and_within_the_scanners_reach(name: str) -> None:
    assert prepared(name).clearance.people_m >= 1.0
    recording = recorded(name)
    for xray in recording.xray or ():
        for picture in xray.values():
            assert 2.0 < np.nanmin(picture) < np.nanmax(picture) < 7.0
            edge = [picture[0], picture[-1], picture[:, 0], picture[:, -1]]
            assert not np.isfinite(np.concatenate(edge)).any()


@each_scan
def test_a_scan_agrees_with_itself(name: str) -> None:
    report = verify(recorded(name))
    assert report.passes, report.text


@each_scan
def test_another_seed_is_another_day(name: str) -> None:
    clearance = load_scene(name).vary.clearance_m
    for seed in (1, 2, 1001):
        assert prepared(name, seed=seed).clearance.people_m >= clearance
