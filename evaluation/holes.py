"""Each hole by itself: who was hidden when and by what, and how well the motion goes on through it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from tabulate import tabulate

from evaluation.completion import PointErrors
from evaluation.identity import places_of
from evaluation.scores import Evidence, hidden_points
from evaluation.surfaces import HiddenSurfaces, hidden_surfaces, recalled
from recording.causes import SENSOR, Causes, causes_of
from recording.visibility import HiddenRun, holes


@dataclass(frozen=True, kw_only=True)
class HoleRow:
    """A hole and the errors in its frames; None where the object's motion says nothing."""

    objectid: int
    name: str
    first: int
    """Its first frame."""
    frames: int
    hidden_by: str
    """The name of what covers most of the object in most of the frames; `sensor` where its returns are lost."""
    recall: float
    """Share of the frames in which the completed points lie within 25 cm of half of the object's surface."""
    centre_mean_m: float | None
    centre_max_m: float | None
    straight_mean_m: float
    """Mean error of a straight line between the object's true places before and after the hole, at even speed."""
    points_mean_m: float | None


def hole_rows(evidence: Evidence) -> list[HoleRow]:
    """The holes of the recording's moving objects, by object, then frame; none without X-ray."""
    found = holes(evidence.visibility)
    if not found:
        return []
    causes = causes_of(evidence.recording)
    places = places_of(evidence.motions, evidence.recording.metadata.frames)
    surfaces = hidden_surfaces(evidence.recording, evidence.motions, evidence.visibility, evidence.motion_of_object)
    points = hidden_points(evidence)
    rows = []
    for hole in found:
        centre = _centre_errors(evidence, hole, places)
        recall = recalled(surfaces)[_within(surfaces, hole)] if surfaces is not None else np.zeros(0)
        rows.append(
            HoleRow(
                objectid=hole.objectid,
                name=_name(evidence, hole.objectid),
                first=hole.first,
                frames=hole.frames,
                hidden_by=_name(evidence, _main_cause(causes, hole)),
                recall=float(recall.mean()) if len(recall) else 0.0,
                centre_mean_m=_mean(centre),
                centre_max_m=float(centre.max()) if len(centre) else None,
                straight_mean_m=float(_straight_errors(evidence, hole).mean()),
                points_mean_m=_mean(points.error_m[_within(points, hole)]) if points is not None else None,
            )
        )
    return rows


def hole_table(rows: Sequence[HoleRow]) -> str:
    """The holes as a table of text; lengths in centimetres, "-" for what cannot be computed."""
    cells = [
        {
            "object": row.name,
            "frames": f"{row.first} to {row.first + row.frames - 1}",
            "length": row.frames,
            "hidden by": row.hidden_by,
            "recall": f"{row.recall:.2f}",
            "centre cm": _centimetres(row.centre_mean_m),
            "max cm": _centimetres(row.centre_max_m),
            "straight line cm": _centimetres(row.straight_mean_m),
            "points cm": _centimetres(row.points_mean_m),
        }
        for row in rows
    ]
    return tabulate(cells, headers="keys", disable_numparse=True, tablefmt="plain") if cells else "no holes"


def _centimetres(metres: float | None) -> str:
    return "-" if metres is None else f"{100 * metres:.1f}"


def _mean(values: Float64[np.ndarray, "value"]) -> float | None:
    return float(values.mean()) if len(values) else None


def _name(evidence: Evidence, objectid: int) -> str:
    names = {entry.id: entry.name for entry in evidence.recording.metadata.objects or ()}
    return "sensor" if objectid == SENSOR else names[objectid]


def _main_cause(causes: Causes, hole: HiddenRun) -> int:
    """What hides the object in most of the hole's frames; of equals the lowest."""
    cause, count = np.unique(causes.cause[causes.ids.index(hole.objectid), hole.first : hole.stop], return_counts=True)
    return int(cause[count.argmax()])


def _within(moments: HiddenSurfaces | PointErrors, hole: HiddenRun) -> Bool[np.ndarray, "moment"]:
    """Which entries are of the hole."""
    during = (moments.frame >= hole.first) & (moments.frame < hole.stop)
    return during & (moments.objectid == hole.objectid)


def _true_places(evidence: Evidence, hole: HiddenRun) -> Float64[np.ndarray, "frame 3"]:
    """The object's true places in all frames."""
    if evidence.visibility.centre is None:
        raise ValueError("expected X-ray twins: without them there is no hole")
    return evidence.visibility.centre[evidence.visibility.ids.index(hole.objectid)]


def _centre_errors(
    evidence: Evidence, hole: HiddenRun, places: dict[int, Float64[np.ndarray, "frame 3"]]
) -> Float64[np.ndarray, "known"]:
    """The distance of the motion's place from the object's, in each frame of the hole for which there is one."""
    motion = evidence.motion_of_object.get(hole.objectid)
    if motion not in places:
        return np.zeros(0)
    off = places[motion] - _true_places(evidence, hole)
    error = np.linalg.norm(off[hole.first : hole.stop], axis=1)
    return error[np.isfinite(error)]


def _straight_errors(evidence: Evidence, hole: HiddenRun) -> Float64[np.ndarray, "frame"]:
    """The distance of the straight line between the hole's ends from the object, in each of its frames."""
    true = _true_places(evidence, hole)
    share = (np.arange(hole.frames) + 1)[:, None] / (hole.frames + 1)
    straight = (1 - share) * true[hole.first - 1] + share * true[hole.stop]
    return np.linalg.norm(straight - true[hole.first : hole.stop], axis=1)
