"""A camera and depths that every importer must give back."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from importing.calibration import Calibration
from importing.source import Wanted
from importing.write import Imported, Treatment, import_recording
from recording.errors import InputError
from recording.recording import Recording
from recording.store import load_recording

HEIGHT, WIDTH, FRAMES = 6, 8, 4
KNOWN = Calibration(fx=300.0, fy=310.0, cx=3.5, cy=2.0, fps=15.0)
TIMES = (100.0, 100.1, 100.2, 100.3)


def depth_mm(frames: int = FRAMES) -> np.ndarray:
    """Depths in millimetres (frame, row, column), with some pixels that have none."""
    depth = np.random.default_rng(1).integers(500, 60000, (frames, HEIGHT, WIDTH), np.uint16)
    depth[:, 1, 2] = 0
    return depth


def depth_m(millimetres: np.ndarray) -> np.ndarray:
    """What a recording should have of them."""
    return np.where(millimetres > 0, millimetres / 1000, np.nan).astype(np.float32)


def imported(source: Path, target: Path, *, known: Calibration = KNOWN, **wanted: Any) -> Recording:
    """The recording of a source."""
    import_recording(source, target, wanted=Wanted(known=known, **wanted))
    return load_recording(target)


def treated(source: Path, target: Path, treatment: Treatment, *, known: Calibration = KNOWN) -> Imported:
    """What importing with a treatment says."""
    return import_recording(source, target, wanted=Wanted(known=known), treatment=treatment)


def refusal(source: Path, target: Path, *, known: Calibration = KNOWN, **wanted: Any) -> str:
    """The one line that refuses a source, of which nothing is left."""
    with pytest.raises(InputError) as refused:
        imported(source, target, known=known, **wanted)
    assert not target.exists()
    assert not [path for path in target.parent.iterdir() if path.name.startswith(".")]
    assert "\n" not in str(refused.value)
    return str(refused.value)


def assert_depths(recording: Recording, expected: np.ndarray) -> None:
    """Every frame has the depths, metres, NaN where there is none."""
    assert recording.metadata.frames == len(expected)
    for frame, depth in zip(recording.frames, expected, strict=True):
        assert frame.depth.dtype == np.float32
        np.testing.assert_allclose(frame.depth, depth, rtol=2e-7)
