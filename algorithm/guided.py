"""Step 9 under guidance: the likeliest assignment among those that respect what a user says of the segments."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from algorithm.continuation import Candidates
from algorithm.linking import Links, Standing, gains, linked
from algorithm.segment_frames import SegmentFrames
from recording.errors import InputError
from recording.motions import Link

Pair = tuple[int, int]
Pairs = Sequence[Pair]
_FORCED = -1e5
"""The price of a link that must be made: no other can outweigh it."""
_DEAR = 50.0
"""The price of a link that is no candidate, where one of several ways is chosen."""
_ANY_RESTLESSNESS = 1.0
"""Of a link that is no candidate, m^2 / s^3: it is made whatever its price is."""
_OVERLAP = 0.5
"""Of two segments that are one object and share a larger part of the shorter one's time, neither goes on as the other:
they are beside each other."""


@dataclass(frozen=True, kw_only=True)
class Guidance:
    """What a user says of pairs of segments."""

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

    def renamed(self, name: Int[np.ndarray, "segment"]) -> "Guidance":
        """The same of segments under new names, -1 for none; what comes to be said of one segment is left out."""
        parts = {
            kind: tuple(
                (int(name[a]), int(name[b])) for a, b in getattr(self, kind) if min(name[a], name[b]) >= 0 != name[a] - name[b]
            )
            for kind in ("same", "different", "forbid", "force")
        }
        return Guidance(**parts)


UNGUIDED = Guidance()
