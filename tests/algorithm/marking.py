"""Segments that are marked by hand, for the tests of corrections."""

from dataclasses import replace

import numpy as np
from made import followed_of, trajectories_of

from algorithm.corrections import corrected
from algorithm.followed import Followed
from algorithm.settings import Settings
from recording.corrections import Anchor, Correction, CorrectionKind, Corrections

SETTINGS = Settings()


def pictured(paths: list[tuple[int, np.ndarray]]) -> Followed:
    """What the first steps would leave, with the places in the picture."""
    followed = followed_of(trajectories_of(paths))
    trajectories = followed.trajectories
    column_row = followed.camera.pixel_from_world(trajectories.position)[0]
    return replace(followed, trajectories=replace(trajectories, column_row=column_row))


def mark(followed: Followed, trajectory: int, along: float = 0.5) -> Anchor:
    """A point of a trajectory, some way along it."""
    rows = np.flatnonzero(followed.trajectories.trajectory == trajectory)
    row = int(rows[round(along * (len(rows) - 1))])
    column, line = followed.trajectories.column_row[row].tolist()
    return Anchor(frame=int(followed.trajectories.frame[row]), column=column, row=line)


def said(kind: CorrectionKind, one: Anchor, other: Anchor) -> Correction:
    """What is said of two marks."""
    return Correction(kind=kind, one=one, other=other)


def all_said(*every: Correction) -> Corrections:
    """All that is said."""
    return Corrections(recording_digest="", correction=every)


def mended(followed: Followed, segment: np.ndarray, *every: Correction) -> np.ndarray:
    """The segments after corrections."""
    return corrected(followed, segment, SETTINGS, all_said(*every)).segments
