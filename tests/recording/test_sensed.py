"""Depth images in memory become a recording, and what cannot be depth is refused in one sentence."""

from pathlib import Path

import numpy as np
import pytest
from worlds import small_camera

from recording.errors import InputError
from recording.sensed import depth_recording
from recording.store import load_recording, save_recording

CAMERA = small_camera(5, 4)
GENERATOR = np.random.default_rng(1)
DEPTHS = [GENERATOR.uniform(1.0, 3.0, (4, 5)) for _ in range(3)]


def test_depths_camera_and_frame_rate_are_as_they_were_given() -> None:
    recording = depth_recording(DEPTHS, camera=CAMERA, fps=15.0, name="mine", timestamps=(0.0, 0.1, 0.3))
    np.testing.assert_allclose([frame.depth for frame in recording.frames], DEPTHS, rtol=1e-6)
    assert (recording.fps, recording.metadata.name, recording.metadata.timestamps) == (15.0, "mine", (0.0, 0.1, 0.3))
    np.testing.assert_array_equal(
        recording.camera.world_points(recording.frames[0].depth)[..., 2], recording.frames[0].depth
    )


@pytest.mark.parametrize("missing", [0.0, np.nan, np.inf])
def test_what_is_no_return_is_nan(missing: float) -> None:
    depth = DEPTHS[0].copy()
    depth[1, 2] = missing
    seen = depth_recording([depth], camera=CAMERA, fps=30.0).frames[0].seen
    assert not seen[1, 2]
    assert seen.sum() == seen.size - 1


def test_it_is_the_same_after_a_round_trip_over_the_disk(tmp_path: Path) -> None:
    recording = depth_recording(DEPTHS, camera=CAMERA, fps=30.0)
    save_recording(recording, tmp_path / "mine")
    assert load_recording(tmp_path / "mine").digest() == recording.digest()


@pytest.mark.parametrize(
    ("depths", "fps", "sentence"),
    [
        ([], 30.0, "expected depth images, got none"),
        ([np.ones((4, 5), np.uint16)], 30.0, "depth image 0: expected metres as floating-point numbers, got uint16"),
        ([DEPTHS[0], np.ones((5, 4))], 30.0, r"depth image 1: expected 4 rows and 5 columns, .* got shape \(5, 4\)"),
        ([-DEPTHS[0]], 30.0, "depth image 0: expected metres before the camera, got -"),
        (DEPTHS, 0.0, "fps: expected a positive number"),
        (DEPTHS, np.nan, "fps: expected a positive number"),
    ],
)
def test_what_cannot_be_depth_is_refused(depths: list[np.ndarray], fps: float, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        depth_recording(depths, camera=CAMERA, fps=fps)
