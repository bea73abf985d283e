"""Step 9 under guidance: the likeliest assignment among those that respect what a user says of the segments."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from algorithm.continuation import Candidates
from algorithm.guidance import Guidance, Pairs, joined
from algorithm.linking import FORCED, Links, Standing, gains, linked
from algorithm.segment_frames import SegmentFrames
from recording.errors import InputError

_DEAR = 50.0
"""The price of a link that is no candidate, where one of several ways is chosen."""
_ANY_RESTLESSNESS = 1.0
"""Of a link that is no candidate, m^2 / s^3: it is made whatever it is."""
_OVERLAP = 0.5
"""Who shares a larger part of the shorter one's time with another segment does not go on as it."""


def guided(possible: Candidates, standing: Standing, guidance: Guidance, span: Int[np.ndarray, "segment 2"]) -> Links:
    """The assignment of least total price that respects the guidance; `span` is each segment's first and last frame.

    Segments that are the same are linked along the cheapest way from the one to the other, over others where that is
    likelier; such as are seen at the same time, beside each other, need no link. Where segments that are different are
    in one motion, the link between them that is missed least is forbidden, until none are.
    """
    if guidance.silent:
        return linked(possible, standing)
    barred = set(guidance.forbid)
    while True:
        ways = _Ways(possible=possible, gain=gains(possible, standing), guidance=guidance, span=span, barred=barred)
        found = linked(_priced(possible, ways.found(), barred - set(guidance.force)), standing)
        offending = _offending(found, guidance, len(span))
        if offending is None:
            return found
        barred.add(offending)


def spans(rows: SegmentFrames) -> Int[np.ndarray, "segment 2"]:
    """First and last frame of each segment."""
    bounds = np.searchsorted(rows.segment, np.arange(rows.count + 1))
    return np.stack([rows.frame[bounds[:-1]], rows.frame[bounds[1:] - 1]], axis=1)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Ways:
    """Of the links those that must be made."""

    possible: Candidates
    gain: Float[np.ndarray, "link"]
    guidance: Guidance
    span: Int[np.ndarray, "segment 2"]
    barred: set[tuple[int, int]]
    onward: dict[int, int] = field(default_factory=dict)
    """What each segment goes on as."""
    back: dict[int, int] = field(default_factory=dict)

    def found(self) -> Pairs:
        """The links that are forced, and those along the ways between segments that are the same."""
        for a, b in self.guidance.force:
            self._make(a, b)
        group = joined(self.guidance.bound, len(self.span))
        several = np.flatnonzero(np.bincount(group, minlength=1) > 1).tolist()
        for number in several:
            members = np.flatnonzero(group == number)
            shunned = self._unlike(group, number)
            for a, b in pairwise(members[np.argsort(self.span[members, 0], kind="stable")].tolist()):
                if not (self._leads(a, b) or self._beside(a, b)):
                    for link in self._cheapest(a, b, shunned):
                        self._make(*link)
        return tuple(self.onward.items())

    def _unlike(self, group: Int[np.ndarray, "segment"], number: int) -> set[int]:
        """The segments that are different from those of a group, and what is the same as these."""
        ends = group[np.array(self.guidance.different, int).reshape(-1, 2)]
        others = ends[(ends == number).any(axis=1)]
        return set(np.flatnonzero(np.isin(group, others[others != number])).tolist())

    def _beside(self, a: int, b: int) -> bool:
        """Whether two segments, of which the first begins first, share most of the shorter one's time."""
        (_, last), (begin, end) = self.span[[a, b]].tolist()
        shorter = int(np.diff(self.span[[a, b]]).min()) + 1
        return bool(min(last, end) - begin + 1 > _OVERLAP * shorter)

    def _make(self, a: int, b: int) -> None:
        if self._free(a, b) and not self._leads(b, a):
            self.onward[a], self.back[b] = b, a

    def _free(self, a: int, b: int) -> bool:
        """Whether nothing that must be made is in the way of the link."""
        return self.onward.get(a, b) == b and self.back.get(b, a) == a

    def _leads(self, a: int, b: int) -> bool:
        while a in self.onward and a != b:
            a = self.onward[a]
        return a == b

    def _cheapest(self, a: int, b: int, shunned: set[int]) -> Pairs:
        """The links of the cheapest way from one segment to another, none where there is none."""
        cost, comes_from = {a: 0.0}, {}
        steps = zip(self.possible.before.tolist(), self.possible.after.tolist(), self.gain.tolist(), strict=True)
        edges = sorted([*steps, (a, b, _DEAR)], key=lambda edge: self.span[edge[0], 0])  # They lead on in time.
        for one, other, gain in edges:
            open_ = (one, other) not in self.barred and self._free(one, other) and other not in shunned
            if open_ and one in cost and cost[one] + gain < cost.get(other, np.inf):
                cost[other], comes_from[other] = cost[one] + gain, one
        way = [b]
        while way[-1] != a:
            if way[-1] not in comes_from:
                return ()
            way.append(comes_from[way[-1]])
        return tuple(pairwise(way[::-1]))


def _priced(possible: Candidates, forced: Pairs, barred: set[tuple[int, int]]) -> Candidates:
    """The candidates with the forced ones among them, at a price that none outweighs, and without the barred ones."""
    known = dict.fromkeys(zip(possible.before.tolist(), possible.after.tolist(), strict=True))
    missing = np.array([pair for pair in forced if pair not in known], int).reshape(-1, 2)
    kept = np.array([pair not in barred for pair in known], bool)
    before = np.concatenate([possible.before[kept], missing[:, 0]])
    after = np.concatenate([possible.after[kept], missing[:, 1]])
    must = set(forced)
    is_forced = np.array([pair in must for pair in zip(before.tolist(), after.tolist(), strict=True)], bool)
    price = np.concatenate([possible.price[kept], np.zeros(len(missing))])
    restlessness = np.concatenate([possible.restlessness[kept], np.full(len(missing), _ANY_RESTLESSNESS)])
    return replace(
        possible,
        before=before,
        after=after,
        price=np.where(is_forced, FORCED, price),
        restlessness=restlessness,
    )


def _offending(found: Links, guidance: Guidance, count: int) -> tuple[int, int] | None:
    """The least missed link of those that join segments which are different; None where none are joined."""
    chosen = np.flatnonzero(found.chosen)
    margin: Mapping[tuple[int, int], float] = {
        (int(found.before[link]), int(found.after[link])): float(found.margin[link]) for link in chosen
    }
    bound = {frozenset(pair) for pair in guidance.bound}
    joints = [*margin, *guidance.bound]
    for a, b in guidance.different:
        between = [*_way_along(joints, (a, b), count)]
        cuttable = [link for link in margin if frozenset(link) in between and frozenset(link) not in bound]
        if cuttable:
            return min(cuttable, key=lambda link: margin[link])
        if between:
            raise InputError(
                "corrections: expected a way to keep apart what is 'different', but 'same' and 'force' join it: "
                "take one of them back"
            )
    return None


def _way_along(joints: Pairs, ends: tuple[int, int], count: int) -> list[frozenset[int]]:
    """The joints that lead from one segment to another; none where they are not joined."""
    one, other = np.array(joints, int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(one)), (one, other)), shape=(count, count)).tocsr()
    _, comes_from = breadth_first_order(graph, ends[0], directed=False)
    way = [ends[1]]
    while way[-1] != ends[0]:
        if comes_from[way[-1]] < 0:
            return []
        way.append(int(comes_from[way[-1]]))
    return [frozenset(pair) for pair in pairwise(way)]
