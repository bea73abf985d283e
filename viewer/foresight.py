"""Work ahead of a correction: the motions are kept one by one, so that a correction makes a few of many anew."""

from collections.abc import Callable
from typing import Any

from algorithm.settings import Settings
from recording.cache import Cache
from recording.recording import Recording
from viewer.wish import Wish
from viewer.worker import Worker


class Foresight:
    """Knows the settings under which motions are kept, and keeps those of others in the background."""

    def __init__(
        self, recording: Recording, cache: Cache | None, *, worker: Worker[Any], refused: Callable[[str], None]
    ) -> None:
        self.prepared: Settings | None = None
        """Under which the next correction is quick."""
        self._recording, self._cache = recording, cache
        self._worker, self._refused = worker, refused

    def prepare(self, wish: Wish) -> None:
        """Keep the motions of what is shown, if that is not done yet and takes seconds alone."""
        cache = self._cache
        if cache is None or self.prepared == wish.settings or not wish.is_near(cache):
            return
        self.prepared = wish.settings
        self._worker.do(lambda: wish.solved(self._recording, cache), done=lambda _: None, refused=self._refused)
