"""Seconds by stage."""

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain


@dataclass(frozen=True, kw_only=True)
class Stopwatch:
    """Adds up the wall time of stages, which may run in turns."""

    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    begun: float = field(default_factory=time.perf_counter)
    earlier: list[Mapping[str, float]] = field(default_factory=list)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count the time of this block to the stage."""
        begun = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - begun

    def add(self, seconds: Mapping[str, float]) -> None:
        """Count what was spent before, by stage and in total."""
        self.earlier.append(seconds)

    def by_stage(self) -> dict[str, float]:
        """The seconds of every stage, and in total: since the watch was made, with what was spent before."""
        parts = [*self.earlier, {**self.seconds, "total": time.perf_counter() - self.begun}]
        return {name: sum(part.get(name, 0.0) for part in parts) for name in dict.fromkeys(chain(*parts))}
