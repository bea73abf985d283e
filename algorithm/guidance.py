"""What a user says of pairs of segments, and what follows from it for flights, links and stragglers."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from recording.motions import Link

Pairs = Sequence[tuple[int, int]]


@dataclass(frozen=True, kw_only=True)
class Guidance:
    """What is said, in numbers of segments, or of what they were united to."""

    same: Pairs = ()
    """They are in one motion."""
    different: Pairs = ()
    """They are in different ones."""
    forbid: Pairs = ()
    """The first does not go on as the second."""
    force: Pairs = ()
    """The first goes on as the second."""

    @property
    def bound(self) -> Pairs:
        """The pairs that are in one motion whatever else is known."""
        return (*self.same, *self.force)

    @property
    def silent(self) -> bool:
        """Whether nothing is said."""
        return not any(getattr(self, entry.name) for entry in fields(self))

    def renamed(self, name: Int[np.ndarray, "segment"]) -> "Guidance":
        """The same under new names, -1 for none; what comes to be said of one name alone is left out."""
        return Guidance(**{entry.name: _renamed(getattr(self, entry.name), name) for entry in fields(self)})

    def forced_links(self) -> tuple[Link, ...]:
        """The links that are made whatever else is known."""
        return tuple(Link(before=a, after=b, confidence=1.0) for a, b in self.force)

    def allowed(self, links: Iterable[Link], count: int) -> tuple[Link, ...]:
        """Those of the links, in their order, that are not forbidden and join nothing that is different."""
        if not (self.different or self.forbid):
            return tuple(links)
        kept: list[Link] = []
        for link in links:
            trial = joined([*self.bound, *((each.before, each.after) for each in (*kept, link))], count)
            apart = all(trial[a] != trial[b] for a, b in self.different)
            if apart and (link.before, link.after) not in self.forbid:
                kept.append(link)
        return tuple(kept)

    def missing(self, motion: Int[np.ndarray, "segment"]) -> tuple[Link, ...]:
        """The links between what is in one motion whatever else is known, and as yet is not."""
        pairs = [pair for pair in self.bound if motion[pair[0]] != motion[pair[1]]]
        return tuple(Link(before=a, after=b, confidence=1.0) for a, b in pairs)

    def kept_apart(
        self, into: Int[np.ndarray, "motion"], shown: Float[np.ndarray, "motion"]
    ) -> Int[np.ndarray, "motion"]:
        """The motion that each belongs to, where of two that are different the one that shows less stays alone."""
        alone = into.copy()
        for a, b in self.different:
            if alone[a] == alone[b]:
                movable = [each for each in (a, b) if alone[each] != each]
                less = min(movable, key=lambda each: float(shown[each]))
                alone[less] = less
        return alone


UNGUIDED = Guidance()


def joined(pairs: Pairs, count: int) -> Int[np.ndarray, "segment"]:
    """The motion of every segment when the pairs are joined."""
    before, after = np.array(pairs, int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(before)), (before, after)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], int) if count else np.zeros(0, int)


def _renamed(pairs: Pairs, name: Int[np.ndarray, "segment"]) -> Pairs:
    named = ((int(name[a]), int(name[b])) for a, b in pairs)
    return tuple((a, b) for a, b in named if a != b and a >= 0 and b >= 0)
