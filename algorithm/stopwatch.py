"""Seconds by stage."""

import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class Stopwatch:
    """Adds up the wall time of stages, which may run in turns."""

    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    begun: float = field(default_factory=time.perf_counter)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count the time of this block to the stage."""
        begun = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - begun

    def by_stage(self) -> dict[str, float]:
        """The seconds of every stage, and in total since the watch was made."""
        return {**self.seconds, "total": time.perf_counter() - self.begun}
