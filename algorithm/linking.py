"""Step 9 of the default, second part: the links that together are likeliest, entering and leaving included."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from algorithm.companions import meetings
from algorithm.continuation import Candidates
from algorithm.segment_frames import SegmentFrames
from algorithm.settings import Settings
from recording.camera import Camera

_LOOK_AHEAD_SECONDS = 0.5
"""Who leaves the picture within this time, at the speed that he has, has left it."""
_LEAVING, _VANISHING = 1.0, 6.0
"""The prices of an end without a continuation: at the border of the picture, and in its middle."""
_SCRAP, _WHOLE = 0.02, 0.3
"""A segment with less than the first share of what a near one shows links nothing; beyond the second all counts."""
_SURE = 0.5, 2.2, 0.16, 0.7
"""Of the logistic curve from margin, restlessness and price to confidence, fitted on development recordings."""
_STRANGE = 2.0
"""From this price on a link is surprising even where nothing else is likelier: they may have turned round."""
_RIVAL = 0.5
"""How fast the confidence of what was not chosen falls with what it would cost."""
_LONG_SECONDS, _MANY = 0.5, 20.0
"""A segment that is seen for so long, with so many points a frame, has its full weight."""
_FEWEST = 3.0
"""Points a frame; with fewer a segment links nothing."""
_FOREVER = 1e6
FORCED = -1e5
"""The price of a link that must be made: no other can outweigh it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Links:
    """Candidates with their standing."""

    before: Int[np.ndarray, "link"]
    after: Int[np.ndarray, "link"]
    chosen: Bool[np.ndarray, "link"]
    margin: Float[np.ndarray, "link"]
    """How much dearer everything gets without a chosen link, or with another one: above 0 and below it."""
    restlessness: Float[np.ndarray, "link"]
    """Of what is linked, m^2 / s^3."""
    price: Float[np.ndarray, "link"]
    """As `Candidates` has it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Standing:
    """What it costs to leave a segment alone, and how much it matters."""

    begin: Float[np.ndarray, "segment"]
    """The price of having nothing before."""
    end: Float[np.ndarray, "segment"]
    """The price of having nothing after."""
    weight: Float[np.ndarray, "segment"]
    """0 to 1: a scrap explains nobody's coming and going."""


def linked(possible: Candidates, standing: Standing) -> Links:
    """The assignment of least total price.

    A link spares the prices of staying alone at both of its ends, by the smaller of the two weights.
    """
    before, after, gain = possible.before, possible.after, gains(possible, standing)
    chosen = np.zeros(len(gain), bool)
    for part in _components(possible, len(standing.begin)):
        chosen[part[_assigned(before[part], after[part], gain[part])]] = True
    margin = _margins(possible, gain, chosen)
    return Links(
        before=before,
        after=after,
        chosen=chosen,
        margin=margin,
        restlessness=possible.restlessness,
        price=possible.price,
    )


def gains(possible: Candidates, standing: Standing) -> Float[np.ndarray, "link"]:
    """What each link costs beyond leaving both its ends alone: below 0 it is worth making."""
    before, after = possible.before, possible.after
    weight = np.minimum(standing.weight[before], standing.weight[after])
    return possible.price - weight * (standing.end[before] + standing.begin[after])


def confidences(links: Links) -> Float[np.ndarray, "link"]:
    """The probability that each link is right: the larger its margin, the calmer what it links, the less surprising.

    Of one that was not chosen it is at most a half, and falls with what choosing it would cost; one that must be made
    is certain.
    """
    evidence = _SURE[0] + _SURE[1] * np.log1p(np.maximum(links.margin, 0.0)) - _SURE[2] * np.log(links.restlessness)
    evidence -= _SURE[3] * np.maximum(links.price - _STRANGE, 0.0)
    evidence = np.where(links.chosen, evidence, _RIVAL * np.minimum(links.margin, 0.0))
    return np.where(links.price <= FORCED, 1.0, 1.0 / (1.0 + np.exp(-np.clip(evidence, -50.0, 50.0))))


def standings(rows: SegmentFrames, camera: Camera, settings: Settings, *, frames: int, fps: float) -> Standing:
    """The standing of every segment.

    Staying alone is cheap where someone enters or leaves the picture and at the recording's ends. What shows little
    beside what is near, for a short time or with few points, has little weight.
    """
    bounds = np.searchsorted(rows.segment, np.arange(rows.count + 1))
    reach = max(1, round(_LOOK_AHEAD_SECONDS * fps))
    begin, end = np.full(rows.count, _VANISHING), np.full(rows.count, _VANISHING)
    for segment, (first, stop) in enumerate(pairwise(bounds.tolist())):
        early, late = slice(first, min(first + reach, stop)), slice(max(stop - reach, first), stop)
        back = rows.centre[first] - _speed(rows, early) * reach
        on = rows.centre[stop - 1] + _speed(rows, late) * reach
        if rows.frame[first] < reach or not _in_view(camera, back):
            begin[segment] = _LEAVING
        if rows.frame[stop - 1] >= frames - reach or not _in_view(camera, on):
            end[segment] = _LEAVING
    weight = np.minimum(1.0, prominence(rows, settings) / _WHOLE)
    weight *= np.minimum(1.0, np.diff(bounds) / fps / _LONG_SECONDS) * np.minimum(1.0, mean_points(rows) / _MANY)
    return Standing(begin=begin, end=end, weight=weight)


def is_scrap(rows: SegmentFrames, settings: Settings) -> Bool[np.ndarray, "segment"]:
    """Which segments show next to nothing, or next to nothing of what a near one shows, and so can link nothing."""
    return (prominence(rows, settings) < _SCRAP) | (mean_points(rows) < _FEWEST)


def mean_points(rows: SegmentFrames) -> Float[np.ndarray, "segment"]:
    """Observed points a frame."""
    count = np.bincount(rows.segment, minlength=rows.count)
    return np.bincount(rows.segment, rows.points, minlength=rows.count) / np.maximum(count, 1)


def prominence(rows: SegmentFrames, settings: Settings) -> Float[np.ndarray, "segment"]:
    """What each segment shows in all its frames, as a share of what a near one shows; 1 if it shows the most.

    Near are segments whose centres are within a body's width in a common frame.
    """
    shown = np.bincount(rows.segment, rows.area, minlength=rows.count)
    most = shown.copy()
    met = meetings(rows, reach_m=settings.widest_m)
    for one, other in ((met.one, met.other), (met.other, met.one)):
        np.maximum.at(most, rows.segment[one], shown[rows.segment[other]])
    return shown / most


def _speed(rows: SegmentFrames, part: slice) -> Float[np.ndarray, "3"]:
    """The mean displacement in a frame, by area."""
    weight = rows.followed[part]
    return np.asarray(np.sum(rows.step[part] * weight[:, None], axis=0) / max(float(weight.sum()), 1e-12))


def _in_view(camera: Camera, place: Float[np.ndarray, "3"]) -> bool:
    pixel, depth = camera.pixel_from_world(place[None])
    return bool(depth[0] > 0 and camera.contains(pixel)[0])


def _components(possible: Candidates, count: int) -> Sequence[Int[np.ndarray, "link"]]:
    """The candidates in groups that share no segment."""
    if not len(possible.before):
        return []
    ends = (possible.before, possible.after + count)
    graph = coo_array((np.ones(len(possible.before)), ends), shape=(2 * count, 2 * count))
    label = connected_components(graph, directed=False)[1][possible.before]
    order = np.argsort(label, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def _assigned(before: np.ndarray, after: np.ndarray, gain: np.ndarray) -> Int[np.ndarray, "chosen"]:
    """The links of least total gain, each segment before one and after one at the most."""
    rows, row = np.unique(before, return_inverse=True)
    columns, column = np.unique(after, return_inverse=True)
    cost = np.zeros((len(rows), len(columns) + len(rows)))  # The last columns: nothing follows.
    cost[:, : len(columns)] = _FOREVER
    cost[row, column] = gain
    where = np.full((len(rows), len(columns)), -1)
    where[row, column] = np.arange(len(gain))
    taken = [
        where[i, j] for i, j in zip(*linear_sum_assignment(cost), strict=True) if j < len(columns) and where[i, j] >= 0
    ]
    return np.array(taken, int)


def _margins(
    possible: Candidates, gain: Float[np.ndarray, "link"], chosen: Bool[np.ndarray, "link"]
) -> Float[np.ndarray, "link"]:
    """The rise of the total price when one link is dropped or exchanged for another, the cheapest way.

    For a chosen link positive; for another one negative: what it would cost to take it instead. The two segments that
    this leaves alone may be linked with each other: then two people have changed places.
    """
    count = int(max(possible.before.max(initial=-1), possible.after.max(initial=-1))) + 1
    number_before, number_after = np.full(count, -1), np.full(count, -1)  # The chosen link of each segment.
    number_before[possible.before[chosen]] = number_after[possible.after[chosen]] = np.flatnonzero(chosen)
    every = {pair: float(its) for pair, its in zip(_pairs(possible), gain, strict=True)}
    margin = np.where(chosen, -gain, -np.inf)
    for link in np.flatnonzero(~chosen).tolist():
        rivals = {number_before[possible.before[link]], number_after[possible.after[link]]} - {-1}
        loss = gain[link] - sum(gain[rival] for rival in rivals)
        if len(rivals) == 2:
            follower = possible.after[number_before[possible.before[link]]]
            leader = possible.before[number_after[possible.after[link]]]
            loss += min(every.get((int(leader), int(follower)), 0.0), 0.0)
        margin[link] = -loss
        for rival in rivals:
            margin[rival] = min(margin[rival], loss)
    return margin


def _pairs(possible: Candidates) -> list[tuple[int, int]]:
    return list(zip(possible.before.tolist(), possible.after.tolist(), strict=True))
