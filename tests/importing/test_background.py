"""What stands still behind everything goes, also where it is mostly hidden; who stands before it for long stays."""

from pathlib import Path

import numpy as np
import pytest
from imports import KNOWN, treated
from worlds import box, small_camera

from importing.background import Background, background_of
from importing.calibration import Calibration
from importing.source import DepthSource
from importing.write import Treatment
from recording.camera import pixel_grid
from recording.errors import InputError
from recording.frame import Frame
from recording.store import load_recording

FRAMES, WALL_M = 40, 4.0
CAMERA = small_camera()
RAYS = CAMERA.camera_from_pixel(pixel_grid(CAMERA.height, CAMERA.width), np.ones((CAMERA.height, CAMERA.width)))


def world(*, wobble_m: float = 0.0, noise_m: float = 0.005, stands: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A wall with a hole, a pillar, and a box that passes, or stands in the middle for a share of the time first.

    Depths (frame, row, column), and where the box is.
    """
    generator = np.random.default_rng(5)
    wall = np.minimum(np.full(RAYS.shape[:2], WALL_M), box(lambda _: np.array([1.0, 0, 3]), (0.2, 2, 0.2))(RAYS, 0))
    wall[5:15, 5:15] = np.inf
    depths, boxes = [], []
    for number in range(FRAMES):
        walked = max(0.0, number / FRAMES - stands) / (1 - stands)
        thing = box(lambda _, x=1.6 * walked - (0 if stands else 0.8): np.array([x, 0, 2.0]), (0.3, 0.6, 0.3))(RAYS, 0)
        depth = np.minimum(wall, thing) + generator.uniform(-wobble_m, wobble_m)
        depth += generator.normal(0, noise_m, depth.shape)
        depths.append(np.where(np.isfinite(depth), depth, np.nan).astype(np.float32))
        boxes.append(thing < wall)
    return np.stack(depths), np.stack(boxes)


def found_in(depths: np.ndarray) -> Background:
    frames = [Frame(depth=depth) for depth in depths]
    height, width = depths.shape[1:]
    source = DepthSource(kind="test", height=height, width=width, count=len(frames), frames=lambda: iter(frames))
    return background_of(source)


def shares(depths: np.ndarray, boxes: np.ndarray) -> tuple[float, float]:
    """How much is left of the box in its worst frame, and of all else."""
    found = found_in(depths)
    left = np.stack([np.isfinite(depth) & ~found.covers(depth) for depth in depths])
    seen = np.isfinite(depths)
    worst = min(float(now[thing].mean()) for now, thing in zip(left, boxes & seen, strict=True) if thing.any())
    return worst, float(left[~boxes & seen].mean())


@pytest.mark.parametrize("wobble_m", [0.0, 0.06])
@pytest.mark.parametrize("noise_m", [0.002, 0.03])
def test_what_stands_still_goes_and_who_passes_stays(wobble_m: float, noise_m: float) -> None:
    kept, left = shares(*world(wobble_m=wobble_m, noise_m=noise_m))
    assert kept > 0.97
    assert left < 0.005


@pytest.mark.parametrize("stands", [0.5, 0.8])
def test_who_stands_for_most_of_the_time_stays_too(stands: float) -> None:
    kept, left = shares(*world(stands=stands, wobble_m=0.06))
    assert kept > 0.97
    assert left < 0.005


def test_rounded_depths_have_noise_too() -> None:
    depths, boxes = world(noise_m=0.02)
    kept, left = shares((400 / np.round(400 / depths)).astype(np.float32), boxes)  # Steps of 4 cm at 4 m.
    assert kept > 0.97
    assert left < 0.005


def test_who_passes_before_nothing_is_no_background() -> None:
    depths, boxes = world()
    found = found_in(np.where(boxes | (np.arange(CAMERA.width) < 10), depths, np.float32(np.nan)))
    assert not np.isfinite(found.depth[:, 20:]).any()


def test_edges_that_flicker_go() -> None:
    depths, boxes = world()
    column = np.indices(depths.shape)[2]
    depths[(column == 60) & (np.random.default_rng(1).random(depths.shape) < 0.5)] = 3.0
    depths[(column > 60) & ~boxes] = 3.0
    kept, left = shares(depths, boxes)
    assert left < 0.005
    assert kept > 0.97


def test_too_few_frames_and_nothing_that_stands_are_refused() -> None:
    depths, boxes = world()
    with pytest.raises(InputError, match="expected at least 10 frames to tell what stands still, got 9"):
        found_in(depths[:9])
    with pytest.raises(InputError, match="expected something that stands still, found nothing"):
        found_in(np.where(boxes, depths, np.float32(np.nan)))


def test_frames_beyond_the_sample_are_not_held(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importing.background._FRAMES", 12)
    depths, boxes = world()
    kept, left = shares(depths, boxes)
    assert kept > 0.97
    assert left < 0.005


def test_the_background_is_left_out_on_import_and_that_is_written_down(tmp_path: Path) -> None:
    depths, boxes = world(wobble_m=0.06)
    np.save(tmp_path / "depth.npy", depths)
    known = Calibration(fx=80.0, fy=80.0, cx=40.0, cy=30.0, pixel_centre=0.5, fps=10.0)
    treated(tmp_path / "depth.npy", tmp_path / "rec", Treatment(remove_background=True), known=known)
    recording = load_recording(tmp_path / "rec")
    (removed,) = recording.metadata.removed or ()
    assert (removed.what, removed.distance_m) == ("background", None)
    assert removed.share == pytest.approx(1 - boxes.sum() / np.isfinite(depths).sum(), abs=0.01)
    for frame, thing in zip(recording.frames, boxes, strict=True):
        assert (frame.seen == thing).mean() > 0.98


def test_ground_and_background_are_told_apart(tmp_path: Path) -> None:
    depths, _ = world()
    np.save(tmp_path / "depth.npy", depths)
    both = Treatment(remove_ground=True, remove_background=True)
    made = treated(tmp_path / "depth.npy", tmp_path / "rec", both, known=KNOWN)
    ground, background = made.metadata.removed or ()
    assert (ground.what, background.what) == ("ground", "background")
    assert 0.5 < ground.share < 1 - background.share
    assert 0.01 < background.share < 0.2


def test_a_recording_with_all_its_returns_says_nothing_of_it(tmp_path: Path) -> None:
    np.save(tmp_path / "depth.npy", world()[0][:2])
    treated(tmp_path / "depth.npy", tmp_path / "rec", Treatment(), known=KNOWN)
    assert "removed" not in (tmp_path / "rec" / "recording.json").read_text(encoding="utf-8")
