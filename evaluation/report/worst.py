"""What went wrong, worst first: segments that mix objects, links that are wrong, missing, or not sure."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evaluation.clustering import majority
from evaluation.holes import HoleRow
from evaluation.links import bridged_holes, right_links
from evaluation.observations import BACKGROUND
from evaluation.scores import Evidence
from evaluation.segmentation import segment_table
from recording.motions import Link
from recording.visibility import HiddenRun, holes


@dataclass(frozen=True, kw_only=True)
class SegmentRow:
    """A segment and how much of it is of one object."""

    segment: int
    points: int
    """Observed points in all frames."""
    wrong: int
    """Those that are not of its main object; all of a segment of the background."""
    objectid: int
    """The object that most of its points are of; `BACKGROUND` where it is none."""
    frame: int
    """The frame with most wrong points; with most points where none is wrong."""

    @property
    def share(self) -> float:
        """The share of its points that are wrong, in [0, 1]."""
        return self.wrong / self.points


@dataclass(frozen=True, kw_only=True)
class LinkRow:
    """A link that was made, and whether it is right."""

    link: Link
    right: bool | None
    """None where nobody knows the objects."""


def worst_segments(evidence: Evidence) -> list[SegmentRow]:
    """All segments, from the one with most wrong points to the one with fewest; the smaller first of equals."""
    observations = evidence.observations
    owner = majority(segment_table(observations)) if evidence.visibility.labelled else {}
    rows = []
    for segment, objectid in owner.items():
        own = observations.segment == segment
        wrong = own & ((observations.objectid != objectid) | (objectid == BACKGROUND))
        counted = wrong if wrong.any() else own
        rows.append(
            SegmentRow(
                segment=segment,
                points=int(own.sum()),
                wrong=int(wrong.sum()),
                objectid=objectid,
                frame=int(np.bincount(observations.frame[counted]).argmax()),
            )
        )
    return sorted(rows, key=lambda row: (-row.wrong, row.points, row.segment))


def worst_links(evidence: Evidence) -> list[LinkRow]:
    """The links that were made: wrong ones, the surest first; then the others, the least sure first."""
    links = evidence.motions.links
    right: Sequence[bool | None] = [None] * len(links)
    if evidence.visibility.labelled:
        right = right_links(evidence.observations, [(link.before, link.after) for link in links]).tolist()
    rows = [LinkRow(link=link, right=truth) for link, truth in zip(links, right, strict=True)]
    return sorted(rows, key=_badness)


def unbridged_holes(evidence: Evidence) -> list[HiddenRun]:
    """The holes through which no motion stays with its object, the longest first."""
    found = holes(evidence.visibility) or []
    bridged = bridged_holes(evidence.observations, evidence.visibility)
    missed = [hole for hole, fine in zip(found, bridged.tolist(), strict=True) if not fine]
    return sorted(missed, key=lambda hole: (-hole.frames, hole.objectid, hole.first))


def worst_holes(rows: Sequence[HoleRow]) -> list[HoleRow]:
    """The holes by the mean error of the centre, the largest first; those about which nothing is said before them."""
    return sorted(rows, key=lambda row: -np.inf if row.centre_mean_m is None else -row.centre_mean_m)


def _badness(row: LinkRow) -> tuple[bool, float, int]:
    """Sorts the worst link first."""
    confidence = row.link.confidence
    return row.right is not False, -confidence if row.right is False else confidence, row.link.before
