"""Points that pass by, for the tests of the baselines."""

import numpy as np

from evaluation.detections import MovingPoints


def seen_at(*tracks: np.ndarray) -> list[MovingPoints]:
    """A patch of points round each track's place (frame, 3) in every frame; none where the place is NaN."""
    patch = np.stack(np.meshgrid(*[np.arange(-8, 9) * 0.025] * 3), axis=-1).reshape(-1, 3)
    frames = []
    for places in zip(*tracks, strict=True):
        there = [place + patch for place in places if np.isfinite(place).all()]
        points = np.concatenate([np.zeros((0, 3)), *there])
        frames.append(MovingPoints(position=points, column_row=points[:, :2]))
    return frames


def straight(start: tuple[float, float, float], step: tuple[float, float, float], frames: int) -> np.ndarray:
    """A track that goes the same step each frame."""
    return np.array(start) + np.arange(frames)[:, None] * np.array(step)
