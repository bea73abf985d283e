"""A small recording with its truth, and workers."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from recording.cluster import Client, cluster
from simulator.simulate import prepared, write_simulation

SCENE = """
name = "small"
frames = 14
fps = 15
[camera]
width = 64
height = 48
position = [0, -4, 1.2]
look_at = [0, 0, 1]
horizontal_fov_deg = 60
[[people]]
body = "man"
waypoints = [[-1.2, 0], [1.2, 0]]
speed = 1.4
[[obstacles]]
shape = "box"
size = [0.5, 0.1, 2.4]
position = [0, -1.0, 0]
"""


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Somebody passes behind a pillar."""
    path = tmp_path_factory.mktemp("scenes") / "small.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def small(scene: Path) -> Path:
    """Its recording."""
    place = scene.parent / "small"
    write_simulation(prepared(scene, seed=1), place, backend="scalar")
    return place


@pytest.fixture(scope="session")
def client() -> Iterator[Client]:
    with cluster(workers=2) as own:
        yield own
