"""What counts neither for nor against a solver: points of objects that move in parts, not as a whole."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool

from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording

IGNORED_KINDS = ("juggler",)
"""Objects of these kinds stand, and count as standing; but their arms move, and no answer about these is wrong."""

MOTION_OF_ARMS = 0.9
"""A motion with this share of its observed points on ignored objects is theirs: the few others are strays at edges."""


def ignored_ids(recording: Recording) -> tuple[int, ...]:
    """The ids of the objects whose points are ignored; none where no object is known."""
    return tuple(entry.id for entry in recording.metadata.objects or () if entry.kind in IGNORED_KINDS)


def counted(recording: Recording, motions: Motions) -> Motions:
    """The motions without what is ignored; the same ones where the recording has no ignored object.

    Left out are: observed rows whose pixel shows an ignored object; the whole of a motion that has nearly all of its
    observed rows on such objects (`MOTION_OF_ARMS`); the completed rows of trajectories of which no observed row is
    left; links to a segment of which none is left. A motion that mixes arms and balls stays with its balls' points.
    """
    ids = ignored_ids(recording)
    if not ids:
        return motions
    on_ignored = _on_objects(recording, motions, ids)
    arms = [
        motion for motion in motions.motion_ids if _of_arms(on_ignored, motions.observed & (motions.motion == motion))
    ]
    left = ~on_ignored & ~np.isin(motions.motion, arms)
    left &= np.isin(motions.trajectory, motions.trajectory[left & motions.observed])
    rows = motions.rows(left)
    segments = set(rows.segment[rows.observed].tolist())
    return replace(
        rows,
        representatives=tuple(entry for entry in motions.representatives if entry.motion not in arms),
        links=tuple(link for link in motions.links if {link.before, link.after} <= segments),
    )


def _on_objects(recording: Recording, motions: Motions, ids: tuple[int, ...]) -> Bool[np.ndarray, "observation"]:
    """Which observed rows fall into a pixel that shows one of the objects."""
    found = np.zeros(len(motions), bool)
    observed = np.flatnonzero(motions.observed)
    frames = np.unique(motions.frame[observed]).tolist()
    for number in tracked(frames, "ignored points", total=len(frames)):
        labels = recording.frames[number].labels
        if labels is not None:
            rows = observed[motions.frame[observed] == number]
            column, row = np.floor(motions.column_row[rows]).astype(np.int64).T
            found[rows] = np.isin(labels.objectid[row, column], ids)
    return found


def _of_arms(marked: Bool[np.ndarray, "row"], among: Bool[np.ndarray, "row"]) -> bool:
    return bool(marked[among].sum() > MOTION_OF_ARMS * among.sum())
