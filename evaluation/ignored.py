"""What counts neither for nor against a solver: points that move in parts, or that two answers are right for.

A juggler's arms move, but the juggler stands. A ball in somebody's hand is one motion with who carries it, and still
the ball: from when it is caught until it is let go it is nobody's error, whatever a solver says of it.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Int64

from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import Visibility

IGNORED_KINDS = ("juggler",)
"""Objects of these kinds stand, and count as standing; but their arms move, and no answer about these is wrong."""

MOTION_OF_ARMS = 0.9
"""A motion with this share of its observed points on ignored objects is theirs: the few others are strays at edges."""


def ignored_ids(recording: Recording) -> tuple[int, ...]:
    """The ids of the objects whose points are ignored; none where no object is known."""
    return tuple(entry.id for entry in recording.metadata.objects or () if entry.kind in IGNORED_KINDS)


def counted(recording: Recording, motions: Motions) -> Motions:
    """The motions without what is ignored; the same ones where the recording has nothing of the kind.

    Left out are: observed rows whose pixel shows an ignored object, or one while it is carried; the whole of a motion
    that has nearly all of its observed rows on ignored objects (`MOTION_OF_ARMS`), or all of them on what is carried;
    the completed rows of trajectories of which no observed row is left; links to a segment, and events of a motion, of
    which none is left. A motion that mixes arms and balls stays with its balls' points.
    """
    ids, carried = ignored_ids(recording), recording.metadata.carried or ()
    if not ids and not carried:
        return motions
    objectid = _objects_behind(recording, motions)
    on_ignored, on_carried = np.isin(objectid, ids), np.zeros(len(motions), bool)
    for each in carried:
        during = (motions.frame >= each.first) & (motions.frame < each.stop)
        on_carried |= during & (objectid == each.object)
    arms = [
        motion for motion in motions.motion_ids if _of_arms(on_ignored, motions.observed & (motions.motion == motion))
    ]
    left = ~on_ignored & ~on_carried & ~np.isin(motions.motion, arms)
    left &= np.isin(motions.trajectory, motions.trajectory[left & motions.observed])
    rows = motions.rows(left)
    segments, kept = set(rows.segment[rows.observed].tolist()), set(rows.motion_ids)
    gone = set(motions.motion_ids) - kept
    return replace(
        rows,
        representatives=tuple(entry for entry in motions.representatives if entry.motion not in gone),
        links=tuple(link for link in motions.links if {link.before, link.after} <= segments),
        events=tuple(event for event in motions.events if not gone & set(event.motions)),
    )


def uncarried(visibility: Visibility, recording: Recording) -> Visibility:
    """The visibility with nothing of an object in the frames in which it is carried, as if it were out of view."""
    carried = [each for each in recording.metadata.carried or () if each.object in visibility.ids]
    if not carried:
        return visibility
    free = np.ones(visibility.seen.shape, bool)
    for each in carried:
        free[visibility.ids.index(each.object), each.first : each.stop] = False
    return replace(
        visibility,
        seen=np.where(free, visibility.seen, 0),
        unoccluded=None if visibility.unoccluded is None else np.where(free, visibility.unoccluded, 0),
        centre=None if visibility.centre is None else np.where(free[..., None], visibility.centre, np.nan),
    )


def _objects_behind(recording: Recording, motions: Motions) -> Int64[np.ndarray, "observation"]:
    """The object in the pixel that each observed row falls into; 0 where nothing is known, and of completed rows."""
    found = np.zeros(len(motions), np.int64)
    observed = np.flatnonzero(motions.observed)
    frames = np.unique(motions.frame[observed]).tolist()
    for number in tracked(frames, "ignored points", total=len(frames)):
        labels = recording.frames[number].labels
        if labels is not None:
            rows = observed[motions.frame[observed] == number]
            column, row = np.floor(motions.column_row[rows]).astype(np.int64).T
            found[rows] = labels.objectid[row, column]
    return found


def _of_arms(marked: Bool[np.ndarray, "row"], among: Bool[np.ndarray, "row"]) -> bool:
    return bool(marked[among].sum() > MOTION_OF_ARMS * among.sum())
