"""A small recording with its truth, and workers."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from small_scenes import box, small_scene, walker

from recording.cluster import Client, cluster
from simulator.simulate import prepared, write_simulation

SCENE = small_scene(walker(begin_m=-1.2, end_m=1.2), box(width_m=0.5, height_m=2.4, before_m=1), frames=14)


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
