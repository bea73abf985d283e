"""Whether confidences mean what they say: in each tenth of confidence, the share that holds."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from evaluation.completion import PointErrors
from evaluation.links import right_links
from evaluation.observations import Observations
from recording.motions import Motions

TENTHS = 10
HOLDS_WITHIN_M = 0.16
"""A completed row's confidence is the probability that it is this near to the truth."""
SURE_FROM = 0.9
"""Links above this confidence are taken for certain."""


@dataclass(frozen=True, kw_only=True)
class Tenth:
    """What holds of all that was said with a confidence from `begin` up to `end`; the last one includes 1."""

    begin: float
    end: float
    count: int
    holding: int
    """How many of these are so."""

    @property
    def share(self) -> float | None:
        """The share that holds, in [0, 1]; None where there is nothing."""
        return self.holding / self.count if self.count else None


def tenths(confidence: Float[np.ndarray, "claim"], holds: Bool[np.ndarray, "claim"]) -> tuple[Tenth, ...]:
    """The claims by tenth of confidence; what lies outside 0 to 1 goes to the nearest."""
    at = np.clip((confidence * TENTHS).astype(int), 0, TENTHS - 1)
    count, holding = (np.bincount(which, minlength=TENTHS).tolist() for which in (at, at[holds]))
    return tuple(_tenth(number, count[number], holding[number]) for number in range(TENTHS))


def link_tenths(motions: Motions, observations: Observations) -> tuple[Tenth, ...]:
    """The links that were made, by confidence; one holds when it is right (`evaluation.links`)."""
    confidence = np.array([link.confidence for link in motions.links], float)
    return tenths(confidence, right_links(observations, [(link.before, link.after) for link in motions.links]))


def completion_tenths(errors: PointErrors | None) -> tuple[Tenth, ...]:
    """The completed points of hidden objects, by confidence; one holds within 16 cm of its true place."""
    if errors is None:
        return tenths(np.empty(0), np.empty(0, bool))
    return tenths(errors.confidence, errors.error_m <= HOLDS_WITHIN_M)


def calibration_scores(motions: Motions, observations: Observations, errors: PointErrors | None) -> dict[str, Any]:
    """The tenths of links and of completed points that hold anything, and how many of the right links are sure ones."""
    links, completed = link_tenths(motions, observations), completion_tenths(errors)
    sure = sure_share(links)
    return {
        "links": _stored(links),
        "completed": _stored(completed),
        **({} if sure is None else {"right_links_above_90": sure}),
    }


def tenths_from(stored: Sequence[dict[str, Any]]) -> tuple[Tenth, ...]:
    """All tenths of those that scores hold."""
    counts = {each["begin"]: (each["count"], each["holding"]) for each in stored}
    return tuple(_tenth(number, *counts.get(number / TENTHS, (0, 0))) for number in range(TENTHS))


def _stored(found: Sequence[Tenth]) -> list[dict[str, Any]]:
    return [{**asdict(tenth), "share": tenth.share} for tenth in found if tenth.count]


def _tenth(number: int, count: int, holding: int) -> Tenth:
    return Tenth(begin=number / TENTHS, end=(number + 1) / TENTHS, count=count, holding=holding)


def pooled(calibrations: Iterable[Sequence[Tenth]]) -> tuple[Tenth, ...]:
    """Several recordings as one: the sums of their counts."""
    every = list(calibrations)
    return tuple(
        _tenth(number, sum(each[number].count for each in every), sum(each[number].holding for each in every))
        for number in range(TENTHS)
    )


def sure_share(found: Sequence[Tenth]) -> float | None:
    """The share of what holds that was said with a confidence of .9 or more, in [0, 1]; None where nothing holds."""
    holding = sum(tenth.holding for tenth in found)
    return sum(tenth.holding for tenth in found if tenth.begin >= SURE_FROM) / holding if holding else None


def largest_miss(found: Sequence[Tenth], *, least: int) -> float | None:
    """How far the share that holds is from the middle of its tenth, at the most over the tenths with enough claims.

    `least` is how many claims are enough; None where no tenth has as many.
    """
    shares = [(tenth, tenth.share) for tenth in found if tenth.share is not None and tenth.count >= least]
    return max((abs(share - (tenth.begin + tenth.end) / 2) for tenth, share in shares), default=None)
