"""All scores of a recording and its motions, under the keys of `unocclude evaluate --json`.

Each number is made by one function whose docstring defines it; here they are only put together. A number that cannot
be computed (no truth, nothing hidden) is None.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from evaluation.calibration import calibration_scores
from evaluation.clustering import (
    Contingency,
    adjusted_rand_index,
    extracted,
    inverse_purity,
    over_segmented,
    purity,
    v_measure,
)
from evaluation.completion import (
    CentreErrors,
    LengthRow,
    PointErrors,
    by_hidden_length,
    centre_errors,
    point_errors,
)
from evaluation.events import event_counts, event_scores
from evaluation.identity import assa, fragmentations, hota, id_switches, idf1, places_of, tracks_of
from evaluation.ignored import counted, uncarried
from evaluation.links import link_precision, link_recall
from evaluation.observations import Observations, observations_of, require_fitting
from evaluation.scorecard import Scorecard
from evaluation.segmentation import (
    coverage,
    found,
    motion_table,
    motions_of_objects,
    segment_episode_table,
    segment_table,
    trajectory_table,
)
from evaluation.surfaces import hidden_surfaces, recall, surface_coverage
from recording.errors import InputError
from recording.motions import NOISE, Motions
from recording.recording import Recording
from recording.version import VERSION
from recording.visibility import Visibility, holes, longest_hole, visibility_of

Scores = dict[str, Any]
"""Numbers by name, None where there is none; nested as JSON is."""
STAGES = ("flow", "match", "trajectories", "affinity", "clustering", "completion", "total")
"""What `seconds` tells the times of."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """A recording and its motions, with what most scores need to know of both."""

    recording: Recording
    motions: Motions
    """Without what is ignored (`evaluation.ignored`)."""
    visibility: Visibility
    """Without the frames in which an object is carried."""
    observations: Observations
    motion_of: dict[int, tuple[int, float]]
    """Object -> (its motion, F)."""

    @property
    def motion_of_object(self) -> dict[int, int]:
        """Object -> its motion."""
        return {objectid: motion for objectid, (motion, _) in self.motion_of.items()}


def evaluate(recording: Recording, motions: Motions) -> Scorecard:
    """The scores of the motions of a recording; InputError where they cannot be of that recording."""
    check_belongs(recording, motions)
    return Scorecard(scores(recording, motions))


def check_belongs(recording: Recording, motions: Motions) -> str | None:
    """A warning where the motions do not say which recording they are of; InputError where they are of another."""
    stated = motions.making.recording_digest
    if stated is None:
        return "the motions do not say which recording they were made from: taken to be of this one"
    digest = recording.digest()
    if stated != digest:
        raise InputError(
            f"expected motions of this recording (digest {digest[:12]}), got motions of another ({stated[:12]}): "
            "solve this recording, or evaluate against the other"
        )
    return None


def scores(recording: Recording, motions: Motions, visibility: Visibility | None = None) -> Scores:
    """The scores, the digest unchecked; a visibility that was worked out before saves a pass over the frames."""
    return scores_of(evidence_of(recording, motions, visibility))


def scores_of(evidence: Evidence) -> Scores:
    """The scores that the evidence gives."""
    seconds, settings = evidence.motions.making.seconds, evidence.motions.making.settings
    points = hidden_points(evidence)
    return {
        **_content(evidence),
        "coverage": coverage(evidence.observations, evidence.visibility),
        "trajectories": _trajectories(evidence),
        "segments": _segments(evidence),
        "motions": _motions(evidence),
        "identity": _identity(evidence),
        "completion": _completion(evidence, points),
        "links": {
            "precision": _if_known(evidence, link_precision(evidence.motions, evidence.observations)),
            "recall": link_recall(evidence.observations, evidence.visibility),
        },
        "events": _events(evidence),
        "calibration": _if_known(evidence, calibration_scores(evidence.motions, evidence.observations, points)),
        "seconds": {stage: seconds.get(stage) for stage in STAGES},
        "version": VERSION,
        "preset": settings.get("preset"),
    }


def evidence_of(recording: Recording, motions: Motions, visibility: Visibility | None = None) -> Evidence:
    """What the scores are made of; InputError where a row lies outside the recording's frames or picture."""
    require_fitting(recording, motions)
    motions = counted(recording, motions)
    visibility = uncarried(visibility or visibility_of(recording), recording)
    observations = observations_of(recording, motions, visibility)
    return Evidence(
        recording=recording,
        motions=motions,
        visibility=visibility,
        observations=observations,
        motion_of=motions_of_objects(observations, visibility),
    )


def completion_by_length(evidence: Evidence) -> list[LengthRow]:
    """Recall and errors by the number of frames that an object was hidden; empty without X-ray."""
    surfaces = hidden_surfaces(evidence.recording, evidence.motions, evidence.visibility, evidence.motion_of_object)
    if surfaces is None:
        return []
    return by_hidden_length(surfaces, hidden_points(evidence), _centre_errors(evidence))


def _content(evidence: Evidence) -> Scores:
    """What the recording holds."""
    visibility = evidence.visibility
    found_holes = holes(visibility)
    return {
        "scene": evidence.recording.metadata.name,
        "frames": evidence.recording.metadata.frames,
        "objects": _if_known(evidence, len(visibility.ids)),
        "points_per_frame": visibility.points_per_frame,
        "holes": len(found_holes) if found_holes is not None else None,
        "longest_hole_frames": longest_hole(visibility),
    }


def _trajectories(evidence: Evidence) -> Scores:
    """The number of trajectories with an observed point, their mean number of observed frames, their purity."""
    observed = evidence.motions.trajectory[evidence.motions.observed]
    count = len(np.unique(observed))
    return {
        "count": count,
        "mean_frames": len(observed) / count if count else None,
        "purity": _if_known(evidence, purity(trajectory_table(evidence.observations))),
    }


def _segments(evidence: Evidence) -> Scores:
    """The segments before completion: purity against objects, the rest against objects' visible episodes."""
    segments = evidence.motions.segment[evidence.motions.observed]
    by_episode = segment_episode_table(evidence.observations, evidence.visibility)
    return {
        "count": len(np.unique(segments[segments != NOISE])),
        "purity": _if_known(evidence, purity(segment_table(evidence.observations))),
        **_agreement(evidence, by_episode),
    }


def _motions(evidence: Evidence) -> Scores:
    """The motions after completion, against objects."""
    table = motion_table(evidence.observations)
    ids = list(evidence.visibility.ids)
    return {
        "count": len(evidence.motions.motion_ids),
        "found": found(evidence.motion_of) if ids else None,
        "purity": _if_known(evidence, purity(table)),
        **_agreement(evidence, table),
        "extracted": extracted(table, ids) if ids else None,
        "over_segmented": _if_known(evidence, over_segmented(table)),
    }


def _agreement(evidence: Evidence, table: Contingency | None) -> Scores:
    """The scores of a partition that purity does not tell."""
    measures = {"inverse_purity": inverse_purity, "v_measure": v_measure, "ari": adjusted_rand_index}
    if table is None:
        return dict.fromkeys(measures)
    return {name: _if_known(evidence, measure(table)) for name, measure in measures.items()}


def _identity(evidence: Evidence) -> Scores:
    measures = {
        "hota": hota,
        "assa": assa,
        "idf1": idf1,
        "id_switches": id_switches,
        "fragmentations": fragmentations,
    }
    tracks = tracks_of(evidence.visibility, evidence.motions)
    return {name: measure(tracks) if tracks is not None else None for name, measure in measures.items()}


def _completion(evidence: Evidence, points: PointErrors | None) -> Scores:
    """The scores of hidden frames; all None where nothing is hidden."""
    motion_of = evidence.motion_of_object
    surfaces = hidden_surfaces(evidence.recording, evidence.motions, evidence.visibility, motion_of)
    centre = _centre_errors(evidence).error_m
    hidden = surfaces if surfaces is not None and len(surfaces.area) else None
    return {
        "hidden_object_frames": len(hidden.area) if hidden is not None else None,
        "recall": recall(hidden) if hidden is not None else None,
        **_error_statistics(points.error_m if points is not None else np.empty(0)),
        "centre_mean_m": float(centre.mean()) if len(centre) else None,
        "centre_max_m": float(centre.max()) if len(centre) else None,
        "surface_coverage_10cm": surface_coverage(hidden) if hidden is not None else None,
    }


def _events(evidence: Evidence) -> Scores | None:
    """Merges and splits; None where nobody knows who carried what."""
    if evidence.recording.truth is None:
        return None
    return event_scores(event_counts(evidence.recording, evidence.motions, evidence.motion_of_object))


def _error_statistics(error_m: np.ndarray) -> Scores:
    """Metres; the shares within count errors up to and including the distance."""
    some = len(error_m) > 0
    return {
        "median_m": float(np.median(error_m)) if some else None,
        "mean_m": float(error_m.mean()) if some else None,
        "p95_m": float(np.percentile(error_m, 95)) if some else None,
        "max_m": float(error_m.max()) if some else None,
        **{f"within_{cm}cm": float((error_m <= cm / 100).mean()) if some else None for cm in (1, 4, 16, 64)},
    }


def hidden_points(evidence: Evidence) -> PointErrors | None:
    """The errors of the completed points of hidden objects; None without meshes."""
    return point_errors(evidence.recording, evidence.motions, evidence.observations, evidence.visibility)


def _centre_errors(evidence: Evidence) -> CentreErrors:
    places = places_of(evidence.motions, evidence.recording.metadata.frames)
    return centre_errors(evidence.visibility, places, evidence.motion_of_object)


def _if_known(evidence: Evidence, value: Any) -> Any:
    """The value where the recording's objects are known, else None."""
    return value if evidence.visibility.labelled else None
