"""Stages that know the truth, to take the place of the algorithm's own: so the error falls apart by stage."""

from itertools import pairwise

import numpy as np
from jaxtyping import Int

from algorithm.given import Given, Segments
from algorithm.scene_flow import PixelFlow
from algorithm.trajectories import Trajectories
from evaluation.observations import BACKGROUND
from evaluation.segmentation import episodes
from recording.correspondence import places_of
from recording.errors import InputError
from recording.recording import Recording
from recording.visibility import visibility_of


def true_flow(recording: Recording) -> Given:
    """The exact flow of every labelled pixel instead of optical flow; matching and chaining stay the algorithm's."""

    def flow(a: int, b: int) -> PixelFlow:
        begin, end = (recording.camera.pixel_from_world(places_of(recording, a, at=at))[0] for at in (a, b))
        return (end - begin).astype(np.float32)

    return Given(flow=flow)


def true_segments(recording: Recording) -> Given:
    """Instead of clustering: an object's trajectories in one visible episode are one segment.

    A trajectory is of the object and episode that most of its points show; of the background it is noise. Episodes
    between which an object's trajectories do not break off are one: what is in sight all the time was never lost.
    """
    numbers = episodes(visibility_of(recording))
    if numbers is None:
        raise InputError("expected a recording with X-ray twins, got one without: only simulated ones know what hides")

    def segments(trajectories: Trajectories) -> Segments:
        owner = _owners(trajectories.trajectory, objects_behind(recording, trajectories))
        middle = (trajectories.first_frame + trajectories.last_frame) // 2
        segment = np.full(trajectories.count, -1)
        begun = 0
        for number, objectid in enumerate(sorted(recording.moving_ids)):
            own = np.flatnonzero(owner == objectid)
            first, last = trajectories.first_frame[own], trajectories.last_frame[own]
            segment[own] = begun + unbroken(first, last, numbers[number][middle[own]])
            begun = int(segment.max(initial=-1)) + 1
        return segment

    return Given(segments=segments)


def true_links(recording: Recording) -> Given:
    """Instead of the assignment: the segments of one object, each linked with the next.

    A segment is of the object that most of its points show. Segments that overlap in time cannot be linked: of an
    object's segments those are taken that follow one another and have the most points.
    """

    def links(trajectories: Trajectories, segments: Segments) -> list[tuple[int, int]]:
        segment = segments[trajectories.trajectory]
        kept = segment >= 0
        owner = _owners(segment[kept], objects_behind(recording, trajectories)[kept])
        first, last = np.full(len(owner), np.iinfo(int).max), np.full(len(owner), -1)
        np.minimum.at(first, segment[kept], trajectories.frame[kept])
        np.maximum.at(last, segment[kept], trajectories.frame[kept])
        points = np.bincount(segment[kept], minlength=len(owner))
        pairs: list[tuple[int, int]] = []
        for objectid in recording.moving_ids:
            own = np.flatnonzero(owner == objectid)
            pairs += pairwise(own[heaviest_chain(first[own], last[own], points[own])].tolist())
        return pairs

    return Given(links=links)


def objects_behind(recording: Recording, trajectories: Trajectories) -> Int[np.ndarray, "observation"]:
    """The moving object that each point shows; `BACKGROUND` where it shows none."""
    found = np.full(len(trajectories.frame), BACKGROUND)
    column, row = np.floor(trajectories.column_row).astype(int).T
    for number in np.unique(trajectories.frame).tolist():
        labels = recording.frames[number].labels
        if labels is None:
            raise InputError(f"frame {number}: expected labels, got none: oracles need a simulated recording")
        here = trajectories.frame == number
        found[here] = labels.objectid[row[here], column[here]]
    return np.where(np.isin(found, recording.moving_ids), found, BACKGROUND)


def heaviest_chain(
    first: Int[np.ndarray, "interval"], last: Int[np.ndarray, "interval"], weight: Int[np.ndarray, "interval"]
) -> list[int]:
    """The intervals that follow one another without overlap and have the greatest weight in all, in order of time."""
    total = np.zeros(len(first), int)
    before = np.full(len(first), -1)
    for interval in np.argsort(first, kind="stable").tolist():
        earlier = np.flatnonzero((last < first[interval]) & (total > 0))  # Those that begin later have no total yet.
        if len(earlier):
            before[interval] = earlier[np.argmax(total[earlier])]
        total[interval] = weight[interval] + (total[before[interval]] if len(earlier) else 0)
    chain = [int(np.argmax(total))] if len(first) else []
    while chain and before[chain[0]] >= 0:
        chain.insert(0, int(before[chain[0]]))
    return chain


def unbroken(
    first: Int[np.ndarray, "interval"], last: Int[np.ndarray, "interval"], episode: Int[np.ndarray, "interval"]
) -> Int[np.ndarray, "interval"]:
    """The episodes of intervals numbered anew from 0; an episode that begins before earlier ones have ended goes on."""
    names, index = np.unique(episode, return_inverse=True)
    if not len(names):
        return index
    begins = np.array([first[index == number].min() for number in range(len(names))])
    ends = np.maximum.accumulate([last[index == number].max() for number in range(len(names))])
    return np.concatenate([[0], np.cumsum(begins[1:] > ends[:-1])])[index]


def _owners(group: Int[np.ndarray, "point"], objectid: Int[np.ndarray, "point"]) -> Int[np.ndarray, "group"]:
    """The object that most points of each group show, the lowest of equals; groups count from 0."""
    names, column = np.unique(objectid, return_inverse=True)
    count = np.zeros((int(group.max(initial=-1)) + 1, len(names)), int)
    np.add.at(count, (group, column), 1)
    return names[count.argmax(axis=1)] if count.size else np.zeros(0, int)
