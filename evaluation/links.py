"""Whether segments were joined over the holes of the object that they belong to."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Bool

from evaluation.clustering import contingency, majority
from evaluation.observations import BACKGROUND, Observations
from evaluation.segmentation import episodes, motion_table, segment_table
from recording.motions import NOISE, Motions
from recording.visibility import Visibility, holes


def link_precision(motions: Motions, observations: Observations) -> float | None:
    """The share of links between segments that are right, in [0, 1]; None where there is no link.

    A link is right when both segments have most of their observed points on the same moving object. For a file
    that lists no links, those that its motions imply: a motion's segments in the order in which they begin, each
    with the next.
    """
    links = [(link.before, link.after) for link in motions.links] or _implied_links(observations)
    return float(right_links(observations, links).mean()) if links else None


def right_links(observations: Observations, links: Sequence[tuple[int, int]]) -> Bool[np.ndarray, "link"]:
    """Which links, from a segment to the next, are between segments of the same moving object."""
    owner = majority(segment_table(observations))
    right = [owner.get(before, BACKGROUND) == owner.get(after) != BACKGROUND for before, after in links]
    return np.array(right, bool)


def link_recall(observations: Observations, visibility: Visibility) -> float | None:
    """The share of holes that a motion bridges (`bridged_holes`), in [0, 1]; None without a hole or X-ray."""
    bridged = bridged_holes(observations, visibility)
    return float(bridged.mean()) if len(bridged) else None


def bridged_holes(observations: Observations, visibility: Visibility) -> Bool[np.ndarray, "hole"]:
    """Which holes a motion bridges, in the order of `recording.visibility.holes`; empty without X-ray.

    A hole is bridged when one motion holds most of the object's observed points both in the visible episode before
    the hole and in the one after it, and has most of its own points on that object. An episode without a point in a
    motion is not reached. So neither splitting segments nor leaving them out makes this number better.
    """
    numbers, found = episodes(visibility), holes(visibility)
    if not found or numbers is None:
        return np.zeros(0, bool)
    owner = majority(motion_table(observations))
    bridged = []
    for hole in found:
        episode = numbers[visibility.ids.index(hole.objectid)]
        before, after = (
            _leader(observations, hole.objectid, episode == episode[at]) for at in (hole.first - 1, hole.stop)
        )
        bridged.append(before is not None and before == after and owner[before] == hole.objectid)
    return np.array(bridged, bool)


def _leader(observations: Observations, objectid: int, frames: np.ndarray) -> int | None:
    """The motion with most of the object's observed points in the frames; None where there is none."""
    rows = (observations.objectid == objectid) & frames[observations.frame] & (observations.motion != NOISE)
    return majority(contingency(observations.objectid[rows], observations.motion[rows])).get(objectid)


def _implied_links(observations: Observations) -> list[tuple[int, int]]:
    """Each motion's segments in the order of their first frames, each with the next."""
    kept = (observations.motion != NOISE) & (observations.segment != NOISE)
    motion, segment, frame = (
        values[kept] for values in (observations.motion, observations.segment, observations.frame)
    )
    order = np.lexsort((segment, frame, motion))
    links = []
    for wanted in np.unique(motion):
        begun = dict.fromkeys(segment[order][motion[order] == wanted].tolist())  # Keeps the order of first frames.
        links += list(pairwise(begun))
    return links
