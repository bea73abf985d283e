"""The rows of Table 1 that the juggling scenes stand for, measured from their recordings."""

import pytest

from recording.visibility import holes, longest_hole, visibility_of
from simulator.scene import load_scene
from simulator.simulate import simulate

ROWS = {"juggler3": (3, 5700, 5, 5), "juggler5": (5, 7000, 7, 12)}
"""Balls, Pts, Occ, Max Occ."""


@pytest.mark.parametrize("size", ["1x", "2x"])
@pytest.mark.parametrize("name", ROWS)
def test_a_juggling_scene_meets_its_row(name: str, size: str) -> None:
    balls, points, occlusions, longest = ROWS[name]
    recording = simulate(name, size=size)
    found = visibility_of(recording)
    objects = recording.metadata.objects or ()
    assert recording.metadata.frames == 110
    assert len(found.ids) == balls
    assert [entry.kind for entry in objects if not entry.moving] == ["juggler"]
    assert len(holes(found) or []) == occlusions
    assert longest_hole(found) == pytest.approx(longest, abs=2)
    assert found.unoccluded is not None
    assert found.unoccluded.min() > 50
    if size == "1x":
        assert found.points_per_frame == pytest.approx(points, rel=0.15)


@pytest.mark.parametrize("name", ROWS)
def test_a_juggling_scene_brings_the_papers_thresholds(name: str) -> None:
    paper = load_scene(name).paper
    assert paper is not None
    eps1 = {"juggler3": 0.2, "juggler5": 0.5}[name]
    assert paper.model_dump() == {"eps1": eps1, "eps2": 0.1, "eps3": 5.0, "eps4": 5.0, "eps5": 10.0}
