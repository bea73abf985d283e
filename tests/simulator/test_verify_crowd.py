"""`verify` on people who come too near to one another, or go through a wall."""

from typing import Any

import pytest

from recording.recording import Recording
from recording.verify import Check, verify
from simulator.scene import Scene
from simulator.simulate import simulate

PEOPLE = ("people apart", "clear of obstacles", "inside obstacles")


def passing(apart_m: float, wall_m: float) -> Recording:
    """Two men who pass each other so far apart, the one of them so far from a wall; no matter how near."""
    scene = {
        "name": "passing",
        "frames": 16,
        "fps": 10,
        "stress_test": True,
        "camera": {"width": 32, "height": 24, "position": [0, -5, 1.5], "look_at": [0, 0, 1]},
        "people": [
            {"body": "man", "waypoints": [[-1, 0], [1, 0]], "speed": 1.3},
            {"body": "man", "waypoints": [[1, apart_m], [-1, apart_m]], "speed": 1.3},
        ],
        "obstacles": [{"shape": "box", "size": [1, 0.5, 2], "position": [0, -0.25 - wall_m, 0]}],
    }
    return simulate(Scene.model_validate(scene))


def serious(recording: Recording) -> Recording:
    """The recording as if its scene were no stress test."""
    scene: dict[str, Any] = (recording.metadata.scene or {}) | {"stress_test": False}
    metadata = recording.metadata.model_copy(update={"scene": scene})
    return Recording(metadata=metadata, frames=recording.frames, truth=recording.truth, xray=recording.xray)


def crowd_checks(recording: Recording) -> dict[str, Check]:
    return {check.name: check for check in verify(recording).checks if check.name in PEOPLE}


def test_people_with_room_pass() -> None:
    checks = crowd_checks(serious(passing(0.9, 0.6)))
    assert tuple(checks) == PEOPLE
    assert [check.largest for check in checks.values()] == [0, 0, 0]
    assert all(check.passes for check in checks.values())


def test_a_stress_test_is_not_asked() -> None:
    assert crowd_checks(passing(0.4, 0.1)) == {}


def test_what_is_missing_between_people_and_to_a_wall_is_metres() -> None:
    checks = crowd_checks(serious(passing(0.35, 0.1)))
    assert checks["people apart"].largest == pytest.approx(0.6 - 0.35, abs=0.1)
    assert checks["clear of obstacles"].largest == pytest.approx(0.3 - 0.1, abs=0.05)
    assert 0 < checks["inside obstacles"].largest < 0.3
    assert not any(check.passes for check in checks.values())


def test_who_goes_through_a_wall_is_as_deep_in_it_as_the_wall_is_wide() -> None:
    checks = crowd_checks(serious(passing(0.9, -0.25)))
    assert checks["clear of obstacles"].largest == pytest.approx(0.3)
    assert checks["inside obstacles"].largest == pytest.approx(0.25, abs=0.02)
