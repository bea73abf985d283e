"""The video of a solved recording: as many pictures as frames, MP4 or GIF, or nothing at all."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from known import FRAMES, crossing, perfect
from PIL import Image

from evaluation.figures.stages import Solved
from evaluation.report.video import pictures_of, write_video
from recording.errors import InputError


@pytest.fixture(scope="module")
def case() -> Solved:
    recording = crossing()
    return Solved(recording=recording, motions=perfect(recording))


def test_an_mp4_has_a_picture_a_frame_at_the_recordings_speed(case: Solved, tmp_path: Path) -> None:
    write_video(case, tmp_path / "out.mp4")
    video = cv2.VideoCapture(str(tmp_path / "out.mp4"))
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == FRAMES
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(case.recording.fps)
    pictures = [video.read()[1] for _ in range(FRAMES)]
    video.release()
    assert pictures[0].shape == (720, 1280, 3)
    assert np.abs(pictures[0].astype(int) - pictures[-1]).mean() > 0.5


def test_a_gif_has_a_picture_a_frame_and_repeats(case: Solved, tmp_path: Path) -> None:
    write_video(case, tmp_path / "out.gif")
    with Image.open(tmp_path / "out.gif") as image:
        assert (image.n_frames, image.size) == (FRAMES, (640, 360))
        assert image.info["loop"] == 0
        assert image.info["duration"] == 30


def test_the_bar_of_time_grows(case: Solved) -> None:
    blue = [
        int(((picture[650:700, :, 2] > 150) & (picture[650:700, :, 0] < 60)).sum()) for picture in pictures_of(case)
    ]
    assert blue == sorted(blue)
    assert blue[0] < blue[-1]


def test_another_ending_is_refused_and_nothing_is_left(case: Solved, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.mp4 or \.gif"):
        write_video(case, tmp_path / "out.avi")
    (tmp_path / "out.gif").write_bytes(b"")
    with pytest.raises(InputError, match="exists already"):
        write_video(case, tmp_path / "out.gif")
    assert [path.name for path in tmp_path.iterdir()] == ["out.gif"]
