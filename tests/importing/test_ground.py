"""The ground goes, also when the sensor shifts whole frames by 6 cm; who walks on it stays."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imports import treated
from worlds import box, small_camera

from importing.calibration import Calibration
from importing.ground import ground_of
from importing.source import DepthSource
from importing.write import Treatment
from recording.camera import Camera, looking_at, pixel_grid
from recording.errors import InputError
from recording.frame import Frame
from recording.store import load_recording

FRAMES = 12
HIGH = replace(small_camera(), world_from_camera=looking_at((0.0, 0.0, 3.0), (0.0, 4.0, 0.0)))
CEILING = replace(small_camera(), world_from_camera=looking_at((0.0, 0.0, 3.3), (0.0, 0.0, 0.0)))


def world(camera: Camera, *, wobble_m: float, wall: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Depth (frame, row, column) of a floor at z = 0 and a box that slides over it, and where the box is."""
    rays = camera.camera_from_pixel(pixel_grid(camera.height, camera.width), np.ones((camera.height, camera.width)))
    generator = np.random.default_rng(3)
    down = rays @ camera.world_from_camera[2, :3]
    floor = np.where(down < -1e-3, -camera.position[2] / np.minimum(down, -1e-3), np.inf)
    if wall:
        floor = np.minimum(floor, 2.7 / np.maximum(rays @ camera.world_from_camera[1, :3], 1e-3))
    camera_from_world = np.linalg.inv(camera.world_from_camera)
    depths, boxes = [], []
    for number in range(FRAMES):
        middle = camera_from_world @ [-1 + 0.2 * number, 0.3 if camera is CEILING else 3.0, 0.8, 1]
        thing = box(lambda _, at=middle[:3]: at, (0.3, 0.3, 0.3))(rays, number)
        depth = (
            np.minimum(floor, thing)
            + generator.uniform(-wobble_m, wobble_m)
            + generator.normal(0, 0.005, rays.shape[:2])
        )
        depths.append(np.where(depth < 12, depth, np.nan).astype(np.float32))
        boxes.append(thing < floor)
    return np.stack(depths), np.stack(boxes)


def source_of(depths: np.ndarray) -> DepthSource:
    frames = [Frame(depth=depth) for depth in depths]
    return DepthSource(kind="test", height=60, width=80, count=len(frames), frames=lambda: iter(frames))


@pytest.mark.parametrize("camera", [HIGH, CEILING])
@pytest.mark.parametrize("wobble_m", [0.0, 0.06])
def test_the_floor_goes_and_the_box_stays(camera: Camera, wobble_m: float) -> None:
    depths, boxes = world(camera, wobble_m=wobble_m)
    ground = ground_of(source_of(depths), camera, up_is_known=False)
    assert ground.distance_m == pytest.approx(camera.position[2], abs=0.05)
    for depth, thing in zip(depths, boxes, strict=True):
        left = np.isfinite(depth) & ~ground.covers(depth)
        assert left[thing].mean() > 0.97
        assert left[~thing].mean() < 0.01


def test_where_up_is_known_a_larger_wall_is_no_ground() -> None:
    depths, _ = world(HIGH, wobble_m=0.0, wall=True)
    assert ground_of(source_of(depths), HIGH, up_is_known=True).distance_m == pytest.approx(3.0, abs=0.1)
    assert ground_of(source_of(depths), HIGH, up_is_known=False).distance_m == pytest.approx(2.7, abs=0.1)


def test_what_lies_below_the_ground_goes_too_and_nothing_stays_nothing() -> None:
    depths, _ = world(CEILING, wobble_m=0.0)
    ground = ground_of(source_of(depths), CEILING, up_is_known=False)
    image = np.full((60, 80), 3.9, np.float32)
    assert ground.covers(image).all()
    assert not ground.covers(np.full((60, 80), np.nan, np.float32)).any()
    assert not ground.covers(np.full((60, 80), 2.0, np.float32)).any()


def test_no_plane_or_no_return_is_refused() -> None:
    noise = np.random.default_rng(0).uniform(1, 9, (60, 80)).astype(np.float32)
    with pytest.raises(InputError, match="expected a plane with a tenth of the returns"):
        ground_of(source_of(np.stack([noise] * 3)), HIGH, up_is_known=False)
    with pytest.raises(InputError, match="expected at least 50 returns to find it in, got 0"):
        ground_of(source_of(np.full((3, 60, 80), np.nan, np.float32)), HIGH, up_is_known=False)


def test_the_ground_is_left_out_on_import(tmp_path: Path) -> None:
    depths, boxes = world(CEILING, wobble_m=0.06)
    np.save(tmp_path / "depth.npy", depths)
    known = Calibration(fx=80.0, fy=80.0, cx=40.0, cy=30.0, pixel_centre=0.5, fps=10.0)
    treated(tmp_path / "depth.npy", tmp_path / "rec", Treatment(remove_ground=True), known=known)
    recording = load_recording(tmp_path / "rec")
    (removed,) = recording.metadata.removed or ()
    assert removed.what == "ground"
    assert removed.distance_m == pytest.approx(3.3, abs=0.05)
    assert removed.share == pytest.approx(1 - boxes.sum() / np.isfinite(depths).sum(), abs=0.02)
    for frame, thing in zip(recording.frames, boxes, strict=True):
        assert (frame.seen == thing).mean() > 0.98
