"""What the truth says: it is read once, and held against each answer, both in the background."""

from collections.abc import Callable
from typing import Any

from recording.recording import Recording
from recording.visibility import Visibility, visibility_of
from viewer.answer import Answer, Judgement, judged
from viewer.clock import Signal
from viewer.clouds import Cloud, xray_cloud
from viewer.space import Space
from viewer.worker import Worker


class Jury:
    """The truth of a recording, as far as it holds any."""

    def __init__(
        self, recording: Recording, space: Space, *, worker: Worker[Any], refused: Callable[[str], None]
    ) -> None:
        self.visibility: Visibility | None = None
        """None until it is known."""
        self.xray: Cloud | None = None
        self.truth_known = Signal()
        self._recording, self._space = recording, space
        self._worker, self._refused = worker, refused

    @property
    def has_truth(self) -> bool:
        """Whether there is something to judge by."""
        known = self._recording
        return known.truth is not None or known.xray is not None or known.frames[0].labels is not None

    def read(self) -> None:
        """Read the truth, and tell when it is known."""
        self._worker.do(
            lambda: (visibility_of(self._recording), xray_cloud(self._recording, self._space)),
            done=self._know,
            refused=self._refused,
        )

    def judge(self, answer: Answer, done: Callable[[Judgement | None], None]) -> None:
        """Hold an answer against the truth, which must be known."""
        visibility = self.visibility
        if visibility is None:
            raise ValueError("expected the truth to be read before an answer is judged")
        self._worker.do(lambda: judged(self._recording, answer.motions, visibility), done=done, refused=self._refused)

    def _know(self, truth: tuple[Visibility, Cloud]) -> None:
        self.visibility, self.xray = truth
        self.truth_known()
