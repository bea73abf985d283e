"""A TUM RGB-D sequence keeps its times, its gaps and its place, if the camera rests."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from imports import HEIGHT, KNOWN, TIMES, WIDTH, assert_depths, depth_m, depth_mm, imported, refusal, treated

from importing.write import Treatment
from recording.store import load_recording

CAMERA = KNOWN.model_copy(update={"fps": None})


@pytest.fixture
def sequence(tmp_path: Path) -> Path:
    """Four images in the data set's own unit, as their names and `depth.txt` tell the time."""
    folder = tmp_path / "rgbd_dataset_freiburg2_test"
    (folder / "depth").mkdir(parents=True)
    lines = ["# depth maps", "# file: 'test.bag'", "# timestamp filename"]
    for stamp, image in zip(TIMES, depth_mm(), strict=True):
        name = f"depth/{stamp:.6f}.png"
        cv2.imwrite(str(folder / name), image)
        lines.append(f"{stamp:.6f} {name}")
    listed(folder, lines)
    return folder


def listed(folder: Path, lines: list[str]) -> None:
    (folder / "depth.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


def lines_of(folder: Path) -> list[str]:
    return (folder / "depth.txt").read_text(encoding="utf-8").splitlines()


def moving(folder: Path, step_m: float, *, start: float = 99.0) -> None:
    poses = [f"{start + 0.1 * n:.4f} {step_m * n:.4f} 2.0 1.5 -0.5 0.5 -0.5 0.5" for n in range(30)]
    (folder / "groundtruth.txt").write_text("# timestamp tx ty tz qx qy qz qw\n" + "\n".join(poses), encoding="utf-8")


def test_a_sequence_keeps_times_and_its_own_scale(sequence: Path, tmp_path: Path) -> None:
    recording = imported(sequence, tmp_path / "rec", known=CAMERA)
    assert_depths(recording, depth_m(depth_mm()) / 5)  # 5,000 a metre in place of 1,000.
    assert recording.fps == 10.0
    assert recording.metadata.timestamps == TIMES


def test_a_dropped_frame_is_empty(sequence: Path, tmp_path: Path) -> None:
    lines = lines_of(sequence)
    listed(sequence, [line for line in lines if "100.100000" not in line])
    recording = imported(sequence, tmp_path / "rec", known=CAMERA.model_copy(update={"fps": 10.0}))
    expected = depth_m(depth_mm()) / 5
    expected[1] = np.nan
    assert_depths(recording, expected)
    assert recording.metadata.timestamps == pytest.approx(TIMES)
    made = treated(sequence, tmp_path / "short", Treatment(dropped="skip"), known=CAMERA)
    assert made.metadata.frames == load_recording(tmp_path / "short").metadata.frames == 3


def test_empty_frames_have_masks_too(sequence: Path, tmp_path: Path) -> None:
    listed(sequence, [line for line in lines_of(sequence) if "100.100000" not in line])
    for number in range(3):
        cv2.imwrite(str(sequence / f"mask_{number}.png"), np.full((HEIGHT, WIDTH), 5, np.uint8))
    known = CAMERA.model_copy(update={"fps": 10.0})
    frames = imported(sequence, tmp_path / "rec", known=known, masks="mask_*.png").frames
    assert [int(frame.labels.objectid.max()) for frame in frames if frame.labels] == [5, 0, 5, 5]


def test_a_camera_at_rest_has_its_place(sequence: Path, tmp_path: Path) -> None:
    moving(sequence, 0.0001)
    camera = imported(sequence, tmp_path / "rec", known=CAMERA).camera
    np.testing.assert_allclose(camera.position, [0.00115, 2.0, 1.5], atol=1e-9)
    np.testing.assert_allclose(camera.world_from_camera[:3, 2], [1, 0, 0], atol=1e-9)


def test_a_camera_that_moves_is_refused(sequence: Path, tmp_path: Path) -> None:
    moving(sequence, 0.05)
    message = refusal(sequence, tmp_path / "rec", known=CAMERA)
    assert "groundtruth.txt: expected a camera at rest, got one that leaves its mean place by 0.075 m" in message


def test_how_it_moved_before_and_after_does_not_matter(sequence: Path, tmp_path: Path) -> None:
    moving(sequence, 0.05, start=200.0)
    np.testing.assert_array_equal(
        imported(sequence, tmp_path / "rec", known=CAMERA).camera.world_from_camera, np.eye(4)
    )


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("100.4 depth/none.png", "none.png is missing: line 8 of"),
        ("100.4 ../../etc/passwd", "expected files within the folder, got '../../etc/passwd' in line 8"),
        ("100.4", "expected a time and a file name, got '100.4' in line 8"),
        ("soon depth/100.000000.png", "expected a time and a file name, got 'soon depth/100.000000.png' in line 8"),
        ("100.3 depth/100.000000.png", "expected time stamps that grow, got 100.3 after 100.3 at frame 4"),
    ],
)
def test_a_wrong_line_is_named(sequence: Path, tmp_path: Path, line: str, expected: str) -> None:
    listed(sequence, [*lines_of(sequence), line])
    assert expected in refusal(sequence, tmp_path / "rec", known=CAMERA)


def test_an_empty_list_and_a_damaged_groundtruth_are_refused(sequence: Path, tmp_path: Path) -> None:
    (sequence / "groundtruth.txt").write_text("1 2 3\n", encoding="utf-8")
    assert "expected 'time x y z qx qy qz qw' in every line" in refusal(sequence, tmp_path / "rec", known=CAMERA)
    listed(sequence, ["# nothing"])
    assert "expected a line with a time and a file name for each image" in refusal(sequence, tmp_path / "rec")
