"""The flow stage in parts of some frames: what is made is kept part by part, and memory holds no more than one.

Flow is most of the work. A run that is interrupted goes on where it was; a long recording needs no more room than a
short one.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from algorithm.kept_stages import FLOWING
from algorithm.moving_flows import FlowsBegun
from algorithm.scene_flow import Depth, FlowsBetween, ThereAndBack
from algorithm.stages import Flowing
from algorithm.stopwatch import Stopwatch
from recording.cache import Cache, key_of

_PAIRS = 64
"""Pairs of frames in a part."""


def nobody(_part: Flowing) -> None:
    """Nobody wants to know."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FlowParts:
    """The flows between all consecutive frames, in parts of 64 pairs, each made at most once where a cache keeps it."""

    flows: FlowsBetween
    moving: Sequence[Depth]
    key: str
    """Of the whole stage."""
    cache: Cache | None
    watch: Stopwatch
    """Counts the making, whenever it was."""
    told: Callable[[Flowing], None] = nobody
    """Gets each part when it is there."""

    def pairs(self) -> Iterator[ThereAndBack]:
        """The flows of one pair of frames after the other."""
        count = len(self.moving) - 1
        for begin in range(0, count, _PAIRS):
            yield from self._part(range(begin, min(begin + _PAIRS, count)))

    def _part(self, pairs: range) -> Iterator[ThereAndBack]:
        key = key_of("flow", {"of": self.key, "pairs": [pairs.start, pairs.stop]})
        part = self.cache.found(key, FLOWING.read) if self.cache is not None else None
        if part is None:
            yield from self._made(pairs, key)
            return
        self.watch.add(part.seconds)
        self.told(part)
        yield from part.flows.pairs()

    def _made(self, pairs: range, key: str) -> Iterator[ThereAndBack]:
        watch, begun = Stopwatch(), FlowsBegun(self.moving[0].shape)
        wanted = self.cache is not None or self.told is not nobody
        for a in pairs:
            with watch.stage("flow"):
                both = self.flows(a, a + 1)
            if wanted:
                begun.add(both, (self.moving[a], self.moving[a + 1]))
            yield both
        seconds = {"flow": watch.seconds["flow"], "total": watch.seconds["flow"]}
        self.watch.seconds["flow"] += seconds["flow"]
        part = Flowing(flows=begun.ended(), seconds=seconds)
        self.told(part)
        if self.cache is not None:
            self.cache.keep(key, partial(FLOWING.write, part))
