"""Whether a motion stays with its object: HOTA, AssA, IDF1, switches, fragmentations, on object centres.

The true place of an object is its X-ray twin's centroid in every frame in which it is in view, hidden or not; the
place of a motion is its representative. Similarity is max(0, 1 - distance / 1 m). The reference is TrackEval 1.3.0.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64
from scipy.optimize import linear_sum_assignment

from recording.motions import Motions, Representative, mean_places
from recording.visibility import Visibility

REACH_M = 1.0
"""At this distance and beyond two places have nothing in common, metres."""
MATCHED_FROM = 0.5
"""Similarity from which IDF1, switches and fragmentations take a motion for an object: 50 cm."""
ALPHAS = np.arange(1, 20) / 20
"""The similarities that HOTA is averaged over: 0.05 to 0.95."""
_ROUNDING = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """The tracks that are there in one frame, and how near they are to each other."""

    truth: Int64[np.ndarray, "truth"]
    """Numbers of the true tracks."""
    predicted: Int64[np.ndarray, "prediction"]
    """Numbers of the predicted tracks."""
    similarity: Float64[np.ndarray, "truth prediction"]
    """0 to 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tracks:
    """True and predicted tracks, frame by frame; numbers count from 0."""

    moments: tuple[Moment, ...]
    truth_frames: Int64[np.ndarray, "truth"]
    """Frames that each true track is there."""
    predicted_frames: Int64[np.ndarray, "prediction"]
    """Frames that each predicted track is there."""


def tracks_of(visibility: Visibility, motions: Motions) -> Tracks | None:
    """The objects' and the motions' places; None where there is no X-ray or no object is ever in view."""
    if visibility.centre is None or not np.isfinite(visibility.centre).any():
        return None
    frames = len(visibility.returns)
    motion_places = places_of(motions, frames)
    predicted = np.stack(list(motion_places.values())) if motion_places else np.empty((0, frames, 3))
    return tracks(visibility.centre, predicted)


def places_of(motions: Motions, frames: int) -> dict[int, Float64[np.ndarray, "frame 3"]]:
    """Each motion's place in every frame, world axes, metres; NaN where nothing is said.

    It is the motion's representative; for motions without any representatives the mean of their points.
    """
    places: dict[int, np.ndarray] = {}
    representatives: tuple[Representative, ...] = motions.representatives or mean_places(motions)
    for entry in representatives:
        place = places.setdefault(entry.motion, np.full((frames, 3), np.nan))
        place[entry.frame] = entry.position
    return places


def tracks(truth: Float64[np.ndarray, "truth frame 3"], predicted: Float64[np.ndarray, "prediction frame 3"]) -> Tracks:
    """Tracks from places in metres, NaN where a track is absent; tracks that are never there are left out."""
    truth_there, predicted_there = (np.isfinite(places).all(axis=2) for places in (truth, predicted))
    truth, predicted = truth[truth_there.any(axis=1)], predicted[predicted_there.any(axis=1)]
    truth_there, predicted_there = (np.isfinite(places).all(axis=2) for places in (truth, predicted))
    moments = []
    for frame in range(truth.shape[1]):
        here, said = np.flatnonzero(truth_there[:, frame]), np.flatnonzero(predicted_there[:, frame])
        distance = np.linalg.norm(truth[here, None, frame] - predicted[None, said, frame], axis=-1)
        moments.append(Moment(truth=here, predicted=said, similarity=np.maximum(0.0, 1.0 - distance / REACH_M)))
    return Tracks(
        moments=tuple(moments),
        truth_frames=truth_there.sum(axis=1),
        predicted_frames=predicted_there.sum(axis=1),
    )


def hota(tracks: Tracks) -> float:
    """HOTA = mean over alpha of sqrt(DetA AssA), in [0, 1]. Luiten et al., IJCV 2021.

    DetA = TP / (TP + FN + FP): true positives are the pairs matched in a frame with similarity alpha or more.
    """
    detection, association = _hota_parts(tracks)
    return float(np.sqrt(detection * association).mean())


def assa(tracks: Tracks) -> float:
    """AssA = mean over alpha and true positives of TPA / (TPA + FNA + FPA), in [0, 1]; 0 without any.

    For a matched pair of tracks: the frames in which they are matched, among those in which either is there.
    """
    return float(_hota_parts(tracks)[1].mean())


def idf1(tracks: Tracks) -> float:
    """IDF1 = 2 IDTP / (true + predicted track-frames), in [0, 1]. Ristani et al. 2016.

    IDTP are the frames with similarity 0.5 or more in the one-to-one assignment of whole tracks that has most.
    """
    near = np.zeros((len(tracks.truth_frames), len(tracks.predicted_frames)))
    for moment in tracks.moments:
        near[np.ix_(moment.truth, moment.predicted)] += moment.similarity >= MATCHED_FROM
    matched = near[linear_sum_assignment(near, maximize=True)].sum()
    return float(2 * matched / (tracks.truth_frames.sum() + tracks.predicted_frames.sum()))


def id_switches(tracks: Tracks) -> int:
    """How often an object is matched with another motion than the last time it was matched, however long ago.

    CLEAR's matching in each frame: similarity 0.5 or more, pairs of the frame before first, then the nearest.
    """
    last = np.full(len(tracks.truth_frames), -1)
    switches = 0
    for matched in _clear_matches(tracks):
        now = matched >= 0
        switches += int(np.sum(now & (last >= 0) & (matched != last)))
        last[now] = matched[now]
    return switches


def fragmentations(tracks: Tracks) -> int:
    """How often an object is matched again after frames in which it was not; CLEAR's matching.

    Frames in which there is no object at all, or no motion at all, are passed over, as the reference does.
    """
    begun = np.zeros(len(tracks.truth_frames), np.int64)
    before = np.zeros(len(tracks.truth_frames), bool)
    for matched in _clear_matches(tracks):
        now = matched >= 0
        begun += now & ~before
        before = now
    return int(np.maximum(begun - 1, 0).sum())


def _clear_matches(tracks: Tracks) -> Iterator[Int64[np.ndarray, "truth"]]:
    """The motion matched to each object, -1 for none; for every frame with both objects and motions."""
    before = np.full(len(tracks.truth_frames), -1)
    for moment in tracks.moments:
        if not moment.similarity.size:
            continue
        kept = moment.predicted[None] == before[moment.truth][:, None]
        score = np.where(moment.similarity >= MATCHED_FROM - _ROUNDING, moment.similarity + 1000.0 * kept, 0.0)
        row, column = linear_sum_assignment(score, maximize=True)
        close = score[row, column] > 0
        before = np.full(len(tracks.truth_frames), -1)
        before[moment.truth[row[close]]] = moment.predicted[column[close]]
        yield before


def _hota_parts(tracks: Tracks) -> tuple[Float64[np.ndarray, "alpha"], Float64[np.ndarray, "alpha"]]:
    """DetA and AssA at every alpha."""
    matched = _hota_matches(tracks)
    positives = matched.sum(axis=(1, 2))
    either = tracks.truth_frames[:, None] + tracks.predicted_frames[None]
    detection = positives / (_all_frames(tracks) - positives)
    overlap = matched / (either - matched)
    association = (matched * overlap).sum(axis=(1, 2)) / np.maximum(positives, 1)
    return detection, association


def _all_frames(tracks: Tracks) -> int:
    """All true and all predicted track-frames."""
    return int(tracks.truth_frames.sum() + tracks.predicted_frames.sum())


def _hota_matches(tracks: Tracks) -> Float64[np.ndarray, "alpha truth prediction"]:
    """The frames in which each pair of tracks is matched with similarity alpha or more.

    In every frame the assignment maximises similarity times the pair's alignment over the whole recording.
    """
    alignment = _alignment(tracks)
    matched = np.zeros((len(ALPHAS), *alignment.shape))
    for moment in tracks.moments:
        score = alignment[np.ix_(moment.truth, moment.predicted)] * moment.similarity
        row, column = linear_sum_assignment(score, maximize=True)
        close = moment.similarity[row, column] >= ALPHAS[:, None] - _ROUNDING
        matched[:, moment.truth[row], moment.predicted[column]] += close
    return matched


def _alignment(tracks: Tracks) -> Float64[np.ndarray, "truth prediction"]:
    """The Jaccard index of every pair of tracks over time, before any matching.

    A frame's contribution is the pair's similarity, divided by what both have with anything in that frame.
    """
    shared = np.zeros((len(tracks.truth_frames), len(tracks.predicted_frames)))
    for moment in tracks.moments:
        near = moment.similarity
        all_of_both = near.sum(axis=0)[None] + near.sum(axis=1)[:, None] - near
        shared[np.ix_(moment.truth, moment.predicted)] += np.divide(
            near, all_of_both, out=np.zeros_like(near), where=all_of_both > _ROUNDING
        )
    return shared / (tracks.truth_frames[:, None] + tracks.predicted_frames[None] - shared)
