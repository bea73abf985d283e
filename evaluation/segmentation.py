"""Which points, segments and motions lie on which object."""

import numpy as np
from jaxtyping import Int64

from evaluation.clustering import FOUND_FROM, Contingency, assigned, contingency
from evaluation.observations import BACKGROUND, Observations
from recording.motions import NOISE
from recording.visibility import Visibility, holes


def coverage(observations: Observations, visibility: Visibility) -> float | None:
    """The share of all observed points of moving objects that lie on a kept trajectory and in a motion, in [0, 1].

    An observed point is a pixel with a return and a moving object's label; it is covered when an observed row
    with a motion falls into the pixel, be it one row or several. What is called noise is lost here.
    """
    total = int(visibility.seen.sum())
    counted = (observations.motion != NOISE) & (observations.objectid != BACKGROUND) & observations.returned
    return len(np.unique(observations.pixel[counted])) / total if total else None


def trajectory_table(observations: Observations) -> Contingency:
    """Trajectories against objects; its purity is the share of rows that carry their trajectory's main object."""
    return contingency(observations.trajectory, observations.objectid)


def motion_table(observations: Observations) -> Contingency:
    """Motions against objects; noise is left out, for it is coverage's business."""
    kept = observations.motion != NOISE
    return contingency(observations.motion[kept], observations.objectid[kept])


def segment_table(observations: Observations) -> Contingency:
    """Segments, as they are before completion, against objects; what lies in no segment is left out."""
    kept = observations.segment != NOISE
    return contingency(observations.segment[kept], observations.objectid[kept])


def segment_episode_table(observations: Observations, visibility: Visibility) -> Contingency | None:
    """Segments against the objects' visible episodes, the best that can be had before completion; None without X-ray.

    The background is one episode.
    """
    numbers = episodes(visibility)
    if numbers is None:
        return None
    moving = np.flatnonzero((observations.segment != NOISE) & (observations.objectid != BACKGROUND))
    label = np.zeros(len(observations.frame), np.int64)
    if len(moving):
        number = np.searchsorted(visibility.ids, observations.objectid[moving])
        count = int(numbers.max()) + 1
        label[moving] = 1 + number * count + numbers[number, observations.frame[moving]]
    kept = observations.segment != NOISE
    return contingency(observations.segment[kept], label[kept])


def episodes(visibility: Visibility) -> Int64[np.ndarray, "object frame"] | None:
    """The number of the visible episode that each object is in, from 0; None without X-ray.

    An episode ends at each hole; what is still seen in a hole's first half belongs to the episode before, in its
    second half to the one after.
    """
    found = holes(visibility)
    if found is None:
        return None
    numbers = np.zeros(visibility.seen.shape, np.int64)
    for hole in found:
        numbers[visibility.ids.index(hole.objectid), (hole.first + hole.stop) // 2 :] += 1
    return numbers


def motions_of_objects(observations: Observations, visibility: Visibility) -> dict[int, tuple[int, float]]:
    """Object -> (motion, F): motions assigned to objects one to one, with the largest sum of F (Hungarian).

    F = 2 n_om / (n_o + n_m) on the observed points of the trajectories: those of the object, noise among them, and
    those of the motion, the background's among them. An object that shares no point with a motion has no entry.
    """
    table = contingency(observations.motion, observations.objectid)
    motions = [motion for motion in np.unique(observations.motion).tolist() if motion != NOISE]
    return assigned(table, motions, list(visibility.ids))


def found(motion_of: dict[int, tuple[int, float]]) -> int:
    """The number of objects whose motion has F >= 0.75."""
    return sum(score >= FOUND_FROM for _, score in motion_of.values())
