"""Sensors: the noise is what its model says, labels and exact depth stay, and the same seed gives the same bytes."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from recording.camera import Camera
from recording.checks import validated
from recording.errors import InputError
from recording.frame import Frame, Reason
from recording.verify import verify
from simulator.scene import Scene
from simulator.sensed import Sensed
from simulator.sensor import Ideal, sensed_frame
from simulator.simulate import prepared, simulate, write_simulation
from simulator.structured_light import StructuredLight
from simulator.view import View

CAMERA = Camera(width=160, height=120, fx=140.0, fy=140.0, cx=80.0, cy=60.0, world_from_camera=np.eye(4))
VIEW = View(camera=CAMERA)
SCENE = {
    "name": "noisy",
    "frames": 5,
    "fps": 15,
    "camera": {"width": 48, "height": 36, "position": [0, -4, 1.4], "look_at": [0, 0, 1]},
    "people": [{"body": "woman", "waypoints": [[-1, 0.5], [1, 0.5]], "speed": 1.2, "start": -0.5}],
    "obstacles": [
        {"shape": "box", "size": [0.2, 0.1, 0.3], "position": [0.1, -3.7, 1.2]},
        {"shape": "box", "size": [9, 0.1, 9], "position": [0, 9, 0]},
    ],
    "sensor": {"preset": "structured_light"},
}


def flat(depth: float = 3.0) -> Frame:
    """A wall across the picture, with a hole in it."""
    exact = np.full((CAMERA.height, CAMERA.width), depth, np.float32)
    exact[:10, :10] = np.nan
    return Frame(depth=exact, clean_depth=exact, reason=np.isnan(exact).astype(np.uint32))


def errors(sensor: StructuredLight, frames: int, depth: float = 3.0) -> np.ndarray:
    """The noise of some frames, a row a frame, metres."""
    exact = flat(depth)
    sensed = [sensed_frame(exact, VIEW, sensor, number=number) for number in range(frames)]
    return np.stack([(frame.depth - exact.depth)[exact.seen].astype(np.float64) for frame in sensed])


@pytest.mark.parametrize("depth", [0.6, 3.0, 9.9])
def test_the_noise_has_the_scanners_sigma_at_every_distance_and_no_bias(depth: float) -> None:
    noise = errors(StructuredLight(preset="structured_light", hole_share=0), 6, depth)
    assert noise.std() == pytest.approx(0.001, rel=0.05)
    assert abs(noise.mean()) < 4 * 0.001 / np.sqrt(noise.size)
    beyond = np.mean(np.abs(noise) > 0.00196)
    assert beyond == pytest.approx(0.05, abs=0.005)  # As of a Gaussian.


def test_the_noise_of_one_frame_says_nothing_of_the_next_nor_a_pixel_of_its_neighbour() -> None:
    noise = errors(StructuredLight(preset="structured_light", hole_share=0), 6)
    for before, after in pairwise(noise):
        assert abs(np.corrcoef(before, after)[0, 1]) < 0.03
    assert abs(np.corrcoef(noise[:, 1:].ravel(), noise[:, :-1].ravel())[0, 1]) < 0.02


def test_another_seed_is_another_draw_and_the_same_seed_the_same() -> None:
    one, again, other = (
        errors(StructuredLight(preset="structured_light", seed=seed, hole_share=0), 1) for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(one, again)
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.03


def test_the_noise_of_the_first_frame_is_not_what_the_scene_was_drawn_with() -> None:
    class Draws(StructuredLight):
        def sensed(self, exact: Frame, view: View, generator: np.random.Generator) -> Sensed:
            drawn = generator.uniform(1, 2, exact.depth.shape).astype(np.float32)
            return Sensed(depth=drawn, reason=np.zeros(drawn.shape, np.uint32))

    of_the_scene = np.random.default_rng(7).uniform(1, 2, (CAMERA.height, CAMERA.width)).astype(np.float32)
    drawn = sensed_frame(flat(), VIEW, Draws(preset="structured_light", seed=7), number=0).depth
    assert abs(np.corrcoef(drawn.ravel(), of_the_scene.ravel())[0, 1]) < 0.03


@pytest.mark.parametrize("depth", [0.4, 10.5])
def test_what_is_out_of_range_does_not_return_and_says_so(depth: float) -> None:
    exact = flat(depth)
    frame = sensed_frame(exact, VIEW, StructuredLight(preset="structured_light", hole_share=0), number=0)
    assert not frame.seen.any()
    assert frame.reason is not None
    np.testing.assert_array_equal(frame.reason, np.where(exact.seen, Reason.OUT_OF_RANGE, 1))
    np.testing.assert_array_equal(frame.clean_depth, exact.depth)


def test_the_ideal_sensor_gives_the_frame_itself() -> None:
    exact = flat()
    assert sensed_frame(exact, VIEW, Ideal(), number=3) is exact


def test_a_noisy_recording_keeps_its_truth() -> None:
    noisy, exact = simulate(Scene.model_validate(SCENE)), simulate(Scene.model_validate(SCENE), sensor="ideal")
    assert verify(noisy).passes, verify(noisy).text
    parameters = {"sigma_m": 0.001, "hole_share": 0.01, "hole_px": 1.5, "nearest_m": 0.5, "farthest_m": 10.0, "seed": 0}
    assert noisy.metadata.sensor == {"preset": "structured_light"} | parameters
    for sensed, clean in zip(noisy.frames, exact.frames, strict=True):
        np.testing.assert_array_equal(sensed.clean_depth, clean.depth)
        np.testing.assert_array_equal(sensed.labels.objectid, clean.labels.objectid)
        error = (sensed.depth - clean.depth)[sensed.seen]
        assert 0 < np.abs(error).max() < 0.006
        assert np.mean(sensed.reason == Reason.OUT_OF_RANGE) > 0.3  # The near box and the far wall.


def test_workers_and_a_cut_change_no_byte(tmp_path: Path) -> None:
    scene = Scene.model_validate(SCENE)
    for workers in (1, 2):
        write_simulation(prepared(scene, seed=3), tmp_path / str(workers), workers=workers)
    write_simulation(prepared(scene, seed=3, frames=2), tmp_path / "cut")
    for number in range(5):
        one, two = ((tmp_path / name / "frames" / f"{number:06d}.exr").read_bytes() for name in ("1", "2"))
        assert one == two
        if number < 2:
            assert one == (tmp_path / "cut" / "frames" / f"{number:06d}.exr").read_bytes()


def test_a_seed_varies_the_noise_and_the_resolved_scene_repeats_it() -> None:
    box = {"shape": "box", "size": [1, 1, 1], "position": [0, 0, 0]}
    still = Scene.model_validate(SCENE | {"people": [], "obstacles": [box]})
    plain, other = simulate(still), simulate(still, seed=5)
    assert not np.array_equal(plain.frames[0].depth, other.frames[0].depth, equal_nan=True)
    again = simulate(Scene.model_validate(other.metadata.scene))
    np.testing.assert_array_equal(again.frames[0].depth, other.frames[0].depth)
    assert simulate(still, seed=5, sensor="structured_light").metadata.sensor == other.metadata.sensor


@pytest.mark.parametrize(
    ("sensor", "sentence"),
    [
        ({"preset": "structured_light", "sigm_m": 0.1}, "unknown key 'sensor.sigm_m', did you mean 'sigma_m'"),
        ({"preset": "structured_light", "sigma_m": -0.1}, "sensor.sigma_m: .* greater than or equal to 0"),
        ({"preset": "structured_light", "nearest_m": 11}, "sensor: expected 'nearest_m' below 'farthest_m'"),
        ({"preset": "ideal", "sigma_m": 0.1}, "unknown key 'sensor.sigma_m'"),
        ({}, "key 'sensor.preset' is missing"),
    ],
)
def test_an_impossible_sensor_is_refused_by_name(sensor: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        validated(Scene, SCENE | {"sensor": sensor}, source="test")


def test_an_unknown_preset_asked_for_by_name_is_refused() -> None:
    with pytest.raises(
        InputError,
        match=r"sensor\.preset: input should be 'ideal' or 'kinect1' or 'tof' or .*'stereo', got 'kinect'",
    ):
        prepared(Scene.model_validate(SCENE), sensor="kinect")
