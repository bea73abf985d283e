"""Another sensor on the same recording: to the byte what simulating with it gives, without casting pictures again."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from recording.errors import InputError
from recording.recording import Recording, stripped
from recording.store import load_recording
from recording.verify import verify
from simulator.resense import resense, write_resensed
from simulator.sensor import PRESETS
from simulator.simulate import prepared, simulate, write_simulation

SIZE = (96, 72)


def files(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def noisy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scene as a sensor sees it that is none of those asked for."""
    folder = tmp_path_factory.mktemp("noisy") / "wall"
    write_simulation(prepared("wall", seed=2, size=SIZE, frames=2, sensor="structured_light"), folder)
    return folder


@pytest.fixture(scope="module")
def exact() -> Recording:
    return simulate("wall", size=SIZE, frames=2)


@pytest.mark.parametrize("preset", PRESETS)
def test_it_is_to_the_byte_the_simulation_with_that_sensor(preset: str, noisy: Path, tmp_path: Path) -> None:
    write_simulation(prepared("wall", seed=2, size=SIZE, frames=2, sensor=preset), tmp_path / "simulated")
    write_resensed(load_recording(noisy), preset, tmp_path / "sensed")
    assert files(tmp_path / "sensed") == files(tmp_path / "simulated")


def test_in_memory_it_is_the_same(exact: Recording) -> None:
    again, simulated = resense(exact, "kinect1"), simulate("wall", size=SIZE, frames=2, sensor="kinect1")
    assert again.metadata == simulated.metadata
    np.testing.assert_array_equal(again.frames[1].depth, simulated.frames[1].depth)
    assert verify(again).passes


def test_another_seed_is_another_draw(exact: Recording) -> None:
    one, other = (resense(exact, "tof", seed=seed) for seed in (1, 2))
    assert not np.array_equal(one.frames[0].depth, other.frames[0].depth, equal_nan=True)
    assert one.metadata.sensor is not None
    assert one.metadata.sensor["seed"] == 1


def test_without_truth_only_a_sensor_with_rays_of_its_own_is_refused(exact: Recording) -> None:
    untrue = replace(exact, truth=None)
    assert resense(untrue, "structured_light").metadata.sensor is not None
    with pytest.raises(InputError, match=r"meshes \(truth\.npz\) are missing"):
        resense(untrue, "kinect1")


def test_a_real_recording_is_refused(exact: Recording) -> None:
    with pytest.raises(InputError, match=r"expected exact depth \(Z\.clean\)"):
        resense(stripped(exact), "tof")


def test_an_unknown_sensor_is_refused(exact: Recording) -> None:
    with pytest.raises(InputError, match="unknown sensor 'kinect': did you mean 'kinect1'"):
        resense(exact, "kinect")
