"""`recording.json` as a value."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from worlds import plane, recorded, small_camera, sphere

from recording.camera import looking_at
from recording.errors import InputError
from recording.metadata import CameraRecord, Metadata, ObjectRecord, camera_record, metadata_of
from recording.recording import Recording, stripped

metres = st.floats(-50, 50)


def test_a_camera_survives_its_record_exactly() -> None:
    camera = replace(small_camera(), cx=31.7, cy=1 / 3, world_from_camera=looking_at((1.0, 2.0, 3.0), (0.3, 0.1, 0.2)))
    again = metadata_of(camera, frames=2, fps=30.0).as_camera()
    for name in ("width", "height", "fx", "fy", "cx", "cy"):
        assert getattr(again, name) == getattr(camera, name)
    np.testing.assert_array_equal(again.world_from_camera, camera.world_from_camera)


@given(st.tuples(metres, metres, metres), st.tuples(metres, metres, metres), st.floats(1, 1e4), st.floats(0.1, 500))
def test_metadata_survive_json_exactly(position, target, focal: float, fps: float) -> None:
    if np.linalg.norm(np.subtract(target, position)) < 0.01:
        return
    camera = replace(small_camera(), fx=focal, world_from_camera=looking_at(position, target))
    metadata = metadata_of(camera, frames=7, fps=fps, name="ä", seed=3)
    assert Metadata.model_validate(json.loads(metadata.model_dump_json(exclude_none=True))) == metadata


@pytest.mark.parametrize("last", [[0, 0, 0, 2], [0, 0, 1, 1], [0.1, 0, 0, 1]])
def test_a_projective_matrix_is_no_camera_pose(last: list[float]) -> None:
    record = camera_record(small_camera()).model_dump()
    record["world_from_camera"] = [*np.eye(4)[:3].tolist(), last]
    with pytest.raises(ValidationError, match=r"\(0, 0, 0, 1\) as the last row"):
        CameraRecord.model_validate(record)


@pytest.mark.parametrize("rotation", [2 * np.eye(3), -np.eye(3), np.ones((3, 3)), np.diag([1.0, 1.0, 1.001])])
def test_scale_shear_and_mirroring_are_no_camera_pose(rotation: np.ndarray) -> None:
    record = camera_record(small_camera()).model_dump()
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    record["world_from_camera"] = matrix.tolist()
    with pytest.raises(ValidationError, match="expected a rotation"):
        CameraRecord.model_validate(record)


def test_an_object_id_comes_once() -> None:
    twin = {"id": 3, "name": "twin", "kind": "ball", "moving": True}
    with pytest.raises(InputError, match="every object id once"):
        metadata_of(small_camera(), frames=1, fps=30.0, objects=(twin, twin))


def test_zero_is_nobodys_id() -> None:
    with pytest.raises(ValidationError, match="greater than 0"):
        ObjectRecord(id=0, name="nobody", kind="none", moving=False)


@pytest.mark.parametrize(
    "known",
    [
        {"timestamps": (0.0, 0.5)},
        {"timestamps": (0.0, 0.5, 0.5)},
        {"timestamps": (1.0, 0.5, 2.0)},
        {"pixel_centre": 0.0},
    ],
)
def test_values_that_contradict_each_other_are_refused(known: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        metadata_of(small_camera(), frames=3, fps=30.0, **known)


@pytest.mark.parametrize(
    "carried",
    [
        {"object": 3, "by": 4, "first": 0, "stop": 2},
        {"object": 4, "by": 3, "first": 0, "stop": 2},
        {"object": 3, "by": 3, "first": 2, "stop": 2},
        {"object": 3, "by": 3, "first": -1, "stop": 2},
    ],
)
def test_what_is_carried_and_who_carries_it_are_objects_for_some_frames(carried: dict[str, int]) -> None:
    ball = {"id": 3, "name": "ball", "kind": "ball", "moving": True}
    with pytest.raises(InputError):
        metadata_of(small_camera(), frames=3, fps=30.0, objects=(ball,), carried=(carried,))


def world() -> Recording:
    return recorded([plane(lambda _: 4.0), sphere(lambda t: (0.1 * t, 0, 2), 0.3)], frames=3, moving=[False, True])


def test_the_moving_objects_are_known() -> None:
    assert world().moving_ids == (2,)
    assert world().fps == 30.0


def test_stripping_leaves_the_required_keys_and_the_depth() -> None:
    recording = world()
    bare = stripped(recording)
    required = {"format", "frames", "fps", "width", "height", "camera", "depth"}
    assert set(json.loads(bare.metadata.model_dump_json(exclude_none=True))) - {"pixel_centre"} == required
    assert bare.truth is None
    assert bare.xray is None
    assert bare.moving_ids == ()
    for one, other in zip(recording.frames, bare.frames, strict=True):
        np.testing.assert_array_equal(other.depth, one.depth)
        assert other.labels is None
        assert other.clean_depth is None
        assert other.reason is None
