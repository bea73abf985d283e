"""What the viewer shows, and all that can change it. Everything happens in one thread; long work is a worker's."""

import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

from algorithm.settings import Preset, Settings
from algorithm.staged import solve
from evaluation.methods import settings_of
from recording.cache import Cache
from recording.checks import validated
from recording.errors import InputError
from recording.motions import Motions
from recording.recording import Recording, stripped
from recording.visibility import Visibility, visibility_of
from viewer.answer import Answer, Judgement, judged
from viewer.clock import Action, Clock, Signal, Timer
from viewer.clouds import Cloud, xray_cloud
from viewer.colours import Colouring
from viewer.playback import Playback
from viewer.space import Space, space_of
from viewer.worker import Worker

PATIENCE_SECONDS = 0.5
"""A setting that did not change for so long is one that was meant."""


class Session:
    """A recording, its motions under some settings, and the moment that is looked at."""

    def __init__(self, recording: Recording, motions: Motions | None, *, clock: Clock, cache: Cache | None) -> None:
        self.recording = recording
        self.bare = stripped(recording)
        """What the sensor saw, and nothing else, to be solved again without reading files."""
        self.space: Space = space_of(self.bare, motions)
        self.opened = Answer(motions=motions) if motions else None
        """The motions that the viewer was opened with, the "before" of all changes."""
        self.answer = self.opened
        self.settings = _settings(recording, motions)
        self.opened_settings = self.settings
        self.visibility: Visibility | None = None
        self.xray: Cloud | None = None
        self.playback = Playback(frames=self.frames, fps=recording.fps, clock=clock)
        self.picked: int | None = None
        self.colouring: Colouring = "motion"
        self.status = ""
        self.answered, self.judged, self.truth_known = Signal(), Signal(), Signal()
        self.picked_changed, self.recoloured = Signal(), Signal()
        self.status_changed, self.settings_changed = Signal(), Signal()
        self._clock, self._cache = clock, cache
        self._worker: Worker[Any] = Worker(self.post)
        self._waiting: Timer | None = None
        self._busy, self._spent = False, ""

    @property
    def frames(self) -> int:
        """Of the recording."""
        return self.recording.metadata.frames

    @property
    def frame(self) -> int:
        """The one that is looked at."""
        return self.playback.frame

    def post(self, action: Action) -> None:
        """Do it in the session's thread."""
        with suppress(RuntimeError):  # The viewer has ended, its event loop is closed, and nobody waits for this.
            self._clock.call_soon_threadsafe(action)

    def begin(self) -> None:
        """Find out what the truth says, in the background."""
        if self.recording.truth is None and self.recording.xray is None and not self._labelled:
            self.say("no truth in this recording: no scores")
            return
        self.say("reading the truth ...")
        self._worker.do(self._truth, done=self._know, refused=self.say)

    @property
    def _labelled(self) -> bool:
        """Whether the recording says which object stands behind a pixel."""
        return self.recording.frames[0].labels is not None

    def pick(self, motion: int | None) -> None:
        """Pick a motion, or none."""
        self.picked = motion
        self.picked_changed()
        self.recoloured()

    def colour_by(self, colouring: Colouring) -> None:
        """Other colours."""
        self.colouring = colouring
        self.recoloured()

    def want(self, settings: Settings) -> None:
        """Solve under other settings, as soon as they do not change any more."""
        if settings == self.settings:
            return
        self.settings = settings
        self.settings_changed()
        if self._waiting is not None:
            self._waiting.cancel()
        self._waiting = self._clock.call_later(PATIENCE_SECONDS, self.solve)

    def want_preset(self, preset: Preset) -> None:
        """Solve under a preset's settings."""
        self.want(settings_of(self.recording, preset))

    def reset(self) -> None:
        """Go back to the motions and settings that the viewer was opened with."""
        if self._waiting is not None:
            self._waiting.cancel()
        self.settings = self.opened_settings
        self.settings_changed()
        self._back()

    def _back(self) -> None:
        self._spent = ""
        self._take(self.opened)
        self.say("")

    def solve(self) -> None:
        """Solve under the settings, in the background."""
        if self._busy:
            return  # What is being solved is followed by what is wanted then.
        if self.opened is not None and self.settings == self.opened_settings:
            self._back()
            return
        self._busy = True
        self.say("solving ...")
        settings, begun = self.settings, time.monotonic()
        self._worker.do(
            lambda: solve(self.bare, settings, cache=self._cache),
            done=partial(self._solved, settings, begun),
            refused=self._refused,
        )

    def say(self, status: str) -> None:
        """Tell what is going on."""
        self.status = status
        self.status_changed()

    def _truth(self) -> tuple[Visibility, Cloud]:
        return visibility_of(self.recording), xray_cloud(self.recording, self.space)

    def _know(self, truth: tuple[Visibility, Cloud]) -> None:
        self.visibility, self.xray = truth
        self.truth_known()
        self._judge(self.opened)

    def _judge(self, answer: Answer | None) -> None:
        visibility = self.visibility
        if answer is None or visibility is None:
            self.say(self._spent)
            return
        self.say(f"{self._spent}, scoring ..." if self._spent else "scoring ...")
        self._worker.do(
            lambda: judged(self.recording, answer.motions, visibility),
            done=partial(self._judged, answer),
            refused=self.say,
        )

    def _judged(self, answer: Answer, judgement: Judgement | None) -> None:
        better = replace(answer, judgement=judgement)
        if self.opened is answer:
            self.opened = better
        if self.answer is answer:
            self.answer = better
        self.say(self._spent)
        self.judged()
        self.recoloured()

    def _solved(self, settings: Settings, begun: float, motions: Motions) -> None:
        self._busy = False
        if settings != self.settings:
            self.solve()
            return
        answer = Answer(motions=motions)
        if self.opened is None:
            self.opened, self.opened_settings = answer, settings
        self._take(answer)
        self._spent = f"solved in {time.monotonic() - begun:.1f} s"
        self._judge(answer)

    def _refused(self, sentence: str) -> None:
        self._busy = False
        self.say(sentence)

    def _take(self, answer: Answer | None) -> None:
        self.answer = answer
        self.picked = None
        self.picked_changed()
        self.answered()
        self.judged()


def _settings(recording: Recording, motions: Motions | None) -> Settings:
    """Those that the motions were made with; of motions from elsewhere, or none, the default's."""
    made = motions.making.settings if motions is not None else {}
    if not made:
        return settings_of(recording, "default")
    try:
        return validated(Settings, made, source="settings of the motions")
    except InputError:  # Made by another version.
        return settings_of(recording, "default")
