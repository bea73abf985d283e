"""A small solved recording that the tests of the viewer share."""

from pathlib import Path

import pytest
from passing_by import SETTINGS, passing_by

from algorithm.staged import solve
from recording.cache import Cache
from recording.motions import Motions
from recording.recording import Recording


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """One person passes behind a wall."""
    return passing_by(tmp_path_factory.mktemp("scene"))


@pytest.fixture(scope="session")
def solved(scene: Recording, own_cache: Path) -> Motions:
    """The motions in it, whose stages are kept."""
    return solve(scene, SETTINGS, cache=Cache(folder=own_cache))
