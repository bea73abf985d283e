"""What the scores mean: the words come from the functions that make them."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from evaluation import clustering, identity, links, segmentation, surfaces
from evaluation.scores import Scores
from recording import visibility

NOTHING = "-"
"""Stands for a number that cannot be computed."""


@dataclass(frozen=True, kw_only=True)
class Meaning:
    """How a score is shown and what it says."""

    name: str
    words: str
    unit: str = ""
    digits: int = 3
    scale: float = 1.0
    """From the score to what is shown."""

    def text(self, value: float | int | None) -> str:
        """The number with its unit."""
        if value is None:
            return NOTHING
        return f"{value * self.scale:.{self.digits}f}{' ' if self.unit else ''}{self.unit}"


def _said(function: Callable[..., object]) -> str:
    """The first paragraph of what a function says of itself."""
    return " ".join((inspect.getdoc(function) or "").split("\n\n", 1)[0].split())


def _share(name: str, words: str) -> Meaning:
    return Meaning(name=name, words=words)


def _count(name: str, words: str, unit: str = "") -> Meaning:
    return Meaning(name=name, words=words, unit=unit, digits=0)


def _length(name: str, words: str) -> Meaning:
    return Meaning(name=name, words=words, unit="cm", digits=1, scale=100.0)


def _partition(what: str, function: Callable[..., object]) -> str:
    return f"{what} {_said(function)}"


_POINTS = "Distance of completed points from where their material point really is, in frames in which it is hidden."
_CENTRE = "Distance of a motion's place from its object's centre, in frames in which the object is hidden."
_SEGMENTS = "Segments, before completion:"
_MOTIONS = "Motions, after completion:"

FAMILIES: Mapping[str, Mapping[str, Meaning]] = {
    "What the recording holds": {
        "frames": _count("frames", "Depth images."),
        "objects": _count("objects", "Moving objects."),
        "points_per_frame": _count("points a frame", "Returns of the sensor, occluders included, ground excluded."),
        "holes": _count("holes", _said(visibility.holes)),
        "longest_hole_frames": _count("longest hole", _said(visibility.longest_hole), "frames"),
    },
    "Segmentation": {
        "motions.found": _count("objects found", _said(segmentation.found)),
        "motions.count": _count("motions", "Motions in all."),
        "motions.purity": _share("purity of motions", _partition(_MOTIONS, clustering.purity)),
        "motions.inverse_purity": _share("inverse purity of motions", _partition(_MOTIONS, clustering.inverse_purity)),
        "coverage": _share("coverage", _said(segmentation.coverage)),
        "motions.v_measure": _share("V-measure of motions", _partition(_MOTIONS, clustering.v_measure)),
        "motions.ari": _share("adjusted Rand index of motions", _partition(_MOTIONS, clustering.adjusted_rand_index)),
        "motions.extracted": _count("extracted objects", _said(clustering.extracted)),
        "motions.over_segmented": _count("motions too many", _said(clustering.over_segmented)),
        "segments.count": _count("segments", "Segments, before completion."),
        "segments.purity": _share("purity of segments", _partition(_SEGMENTS, clustering.purity)),
        "segments.inverse_purity": _share(
            "inverse purity of segments", _partition(_SEGMENTS, clustering.inverse_purity)
        ),
        "segments.v_measure": _share("V-measure of segments", _partition(_SEGMENTS, clustering.v_measure)),
        "segments.ari": _share(
            "adjusted Rand index of segments", _partition(_SEGMENTS, clustering.adjusted_rand_index)
        ),
        "trajectories.count": _count("trajectories", "Trajectories with an observed point."),
        "trajectories.mean_frames": Meaning(
            name="mean length of trajectories", words="Observed frames of a trajectory.", unit="frames", digits=1
        ),
        "trajectories.purity": _share("purity of trajectories", _said(segmentation.trajectory_table)),
    },
    "Identity": {
        "identity.idf1": _share("IDF1", _said(identity.idf1)),
        "identity.hota": _share("HOTA", _said(identity.hota)),
        "identity.assa": _share("AssA", _said(identity.assa)),
        "identity.id_switches": _count("identity switches", _said(identity.id_switches)),
        "identity.fragmentations": _count("fragmentations", _said(identity.fragmentations)),
        "links.precision": _share("precision of links", _said(links.link_precision)),
        "links.recall": _share("recall of links", _said(links.link_recall)),
    },
    "Completion of what was hidden": {
        "completion.hidden_object_frames": _count("hidden object-frames", "An object hidden in a frame counts one."),
        "completion.recall": _share("hidden frames recalled", _said(surfaces.recall) + " " + _said(surfaces.recalled)),
        "completion.surface_coverage_10cm": _share("surface within 10 cm", _said(surfaces.surface_coverage)),
        "completion.centre_mean_m": _length("centre error, mean", _CENTRE),
        "completion.centre_max_m": _length("centre error, largest", _CENTRE),
        "completion.mean_m": _length("point error, mean", _POINTS),
        "completion.median_m": _length("point error, median", _POINTS),
        "completion.p95_m": _length("point error, 95th percentile", _POINTS),
        "completion.max_m": _length("point error, largest", _POINTS),
        **{
            f"completion.within_{reach}cm": _share(
                f"points within {reach} cm", f"Share of the completed points of hidden objects up to {reach} cm off."
            )
            for reach in (1, 4, 16, 64)
        },
    },
    "Events and confidence": {
        "events.count": _count("events told", "Motions that were said to merge or to split."),
        "events.true": _count("events in truth", "What is caught and let go in the recording."),
        "events.precision": _share("precision of events", "Share of the told events that are right, within 0.3 s."),
        "events.recall": _share("recall of events", "Share of the true events that were told, within 0.3 s."),
        "calibration.right_links_above_90": _share(
            "right links that are sure", "Share of the right links that were made with a confidence of 0.9 or more."
        ),
    },
}
"""How the scores are told, by dotted key, in the order of the page."""

HEADLINES = (
    "motions.found",
    "coverage",
    "identity.idf1",
    "completion.recall",
    "completion.centre_mean_m",
    "completion.mean_m",
)
"""What a page begins with."""
HEADLINES_WITHOUT_TRUTH = ("motions.count", "segments.count", "trajectories.count")


def meaning_of(key: str) -> Meaning:
    """The meaning of a score by dotted key."""
    return next(family[key] for family in FAMILIES.values() if key in family)


def dotted(scores: Scores) -> Scores:
    """The numbers of scores by dotted key."""
    flat: Scores = {}
    for name, value in scores.items():
        if isinstance(value, dict):
            flat |= {f"{name}.{key}": each for key, each in value.items() if not isinstance(each, list)}
        elif not isinstance(value, str):
            flat[name] = value
    return flat
