"""The tracks of detections as motions: what a track's points do where it has no detection."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from evaluation.detections import Detections
from recording.motions import INTER, NOISE, OBSERVED, Link, Making, Motions, Representative

_CONFIDENCE = 0.5
"""Of every carried point: a baseline does not say how sure it is."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DetectionTrack:
    """One object's detections, and its place in every frame from the first of them to the last."""

    detections: Int[np.ndarray, "hit"]
    """Numbers of the detections, one a frame at the most, in order of time."""
    first: int
    """The frame of the first."""
    position: Float[np.ndarray, "moment 3"]
    """The track's state, world axes, metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Carried:
    """Points of detections in frames in which their track has none."""

    point: Int[np.ndarray, "row"]
    """Number of the observed point that is carried along."""
    frame: Int[np.ndarray, "row"]
    position: Float[np.ndarray, "row 3"]


def motions_of_tracks(
    detections: Detections, tracks: Sequence[DetectionTrack], *, carry_frames: int, making: Making
) -> Motions:
    """Every track as a motion, in the order given; points of detections without a track are noise.

    A point is seen once: it is a trajectory of its own. Where a track has no detection, the points of its largest
    detection in the `carry_frames` frames before are carried along with its state, as a practitioner would do it.
    A segment is a run of consecutive frames with a detection, and a link leads from each to the next.
    """
    motion_of = np.full(len(detections.moment) + 1, NOISE)  # The last entry is for -1: no detection.
    segment_of = motion_of.copy()
    links: list[Link] = []
    parts = []
    for number, track in enumerate(tracks):
        segments = int(segment_of.max()) + 1 + _runs(detections.moment[track.detections])
        motion_of[track.detections], segment_of[track.detections] = number, segments
        links += [Link(before=int(a), after=int(b), confidence=1.0) for a, b in pairwise(np.unique(segments))]
        parts += _carried_through_gaps(detections, track, max(carry_frames, 1))
    carried = _joined(parts)
    observed = len(detections.frame)
    source = np.repeat([OBSERVED, INTER], [observed, len(carried.point)])
    point = np.concatenate([np.arange(observed), carried.point])
    frame = np.concatenate([detections.frame, carried.frame])
    column_row = np.where((source == OBSERVED)[:, None], detections.column_row[point], np.nan)
    return Motions(
        frame=frame.astype(np.int32),
        trajectory=point.astype(np.int32),
        position=np.concatenate([detections.position, carried.position]).astype(np.float32),
        column_row=column_row.astype(np.float32),
        segment=segment_of[detections.detection[point]].astype(np.int32),
        motion=motion_of[detections.detection[point]].astype(np.int32),
        source=source.astype(np.uint8),
        confidence=np.where(source == OBSERVED, 1.0, _CONFIDENCE).astype(np.float32),
        representatives=tuple(_representative(detections, number, track) for number, track in enumerate(tracks)),
        links=tuple(links),
        making=making,
    ).rows(np.lexsort((frame, point)))


def _runs(moment: Int[np.ndarray, "hit"]) -> Int[np.ndarray, "hit"]:
    """The number of the run of consecutive frames that each frame lies in, from 0."""
    return np.cumsum(np.diff(moment, prepend=moment[:1]) > 1)


def _carried_through_gaps(detections: Detections, track: DetectionTrack, carry_frames: int) -> list[_Carried]:
    """The points of the track in each of its gaps."""
    moment = detections.moment[track.detections]
    size = detections.size[track.detections]
    parts = []
    for last, following in pairwise(range(len(moment))):
        missed = np.arange(moment[last] + 1, moment[following])
        if len(missed):
            recent = np.flatnonzero((moment > moment[last] - carry_frames) & (moment <= moment[last]))
            fullest = recent[np.argmax(size[recent])]
            point = np.flatnonzero(detections.detection == track.detections[fullest])
            shift = track.position[missed - track.first] - track.position[moment[fullest] - track.first]
            place = detections.position[point][:, None] + shift[None]
            parts.append(
                _Carried(
                    point=np.repeat(point, len(missed)),
                    frame=np.tile(missed, len(point)),
                    position=place.reshape(-1, 3),
                )
            )
    return parts


def _joined(parts: Sequence[_Carried]) -> _Carried:
    return _Carried(
        point=np.concatenate([np.zeros(0, int), *(part.point for part in parts)]),
        frame=np.concatenate([np.zeros(0, int), *(part.frame for part in parts)]),
        position=np.concatenate([np.zeros((0, 3)), *(part.position for part in parts)]),
    )


def _representative(detections: Detections, number: int, track: DetectionTrack) -> Representative:
    frame = np.arange(track.first, track.first + len(track.position))
    observed = np.isin(frame, detections.moment[track.detections])
    return Representative(motion=number, frame=frame.astype(np.int32), position=track.position, observed=observed)
