"""What the viewer shows, and all that can change it. Everything happens in one thread; long work is a worker's."""

import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any, Literal

from algorithm.settings import Settings
from recording.cache import Cache
from recording.corrections import Corrections
from recording.motions import NOISE, Motions
from recording.recording import Recording, stripped
from viewer.answer import Answer, Judgement
from viewer.clock import Action, Clock, Delay, Signal
from viewer.colours import Colouring
from viewer.foresight import Foresight
from viewer.jury import Jury
from viewer.keeping import CorrectionsFile
from viewer.marks import Marks, mark_at
from viewer.playback import Playback
from viewer.space import Space, space_of
from viewer.wish import Wish, wish_of
from viewer.worker import Worker

Clicks = Literal["pick", "mark"]
"""What a click on a point in the scene does: it picks its motion, or it marks its segment."""
PATIENCE_SECONDS = 0.5
"""A setting that did not change for so long is one that was meant."""


class Session:
    """A recording, its motions under some settings, and the moment that is looked at."""

    def __init__(
        self,
        recording: Recording,
        motions: Motions | None,
        *,
        clock: Clock,
        cache: Cache | None,
        file: CorrectionsFile | None = None,
    ) -> None:
        self.recording = recording
        self.bare = stripped(recording)
        """What the sensor saw, and nothing else, to be solved again without reading files."""
        self.space: Space = space_of(self.bare, motions)
        self.opened = Answer(motions=motions) if motions else None
        """The motions that the viewer was opened with, the "before" of all changes."""
        self.answer = self.opened
        self.opened_wish = wish_of(recording, motions, self.bare.digest())
        read = file.known if file is not None else None
        self.wish = replace(self.opened_wish, corrections=read) if read is not None else self.opened_wish
        """What the motions are to be; those that are shown may still be on their way there."""
        self.file = file
        """Where corrections are kept, if anywhere."""
        self.marks = Marks()
        self.clicks: Clicks = "pick"
        self.playback = Playback(frames=self.frames, fps=recording.fps, clock=clock)
        self.picked: int | None = None
        self.colouring: Colouring = "motion"
        self.status = ""
        self.answered, self.judged = Signal(), Signal()
        self.picked_changed, self.recoloured, self.clicks_changed = Signal(), Signal(), Signal()
        self.status_changed, self.settings_changed, self.corrections_changed = Signal(), Signal(), Signal()
        self._clock, self._cache = clock, cache
        self._worker: Worker[Any] = Worker(self.post)
        self.jury = Jury(recording, self.space, worker=self._worker, refused=self.say)
        self.jury.truth_known.connect(lambda: self._judge(self.opened))
        self._patience = Delay(clock, PATIENCE_SECONDS)
        self._busy, self._spent = False, ""
        self._granted = self.wish
        """The wish of which the motions are that are shown."""
        self._foresight = Foresight(self.bare, cache, worker=self._worker, refused=self.say)
        for signal in (self.picked_changed, self.marks.changed):
            signal.connect(self._prepare)

    @property
    def frames(self) -> int:
        """Of the recording."""
        return self.recording.metadata.frames

    @property
    def settings(self) -> Settings:
        """Those that are wished for."""
        return self.wish.settings

    @property
    def corrections(self) -> Corrections:
        """By hand, those that are wished for."""
        return self.wish.corrections

    @property
    def frame(self) -> int:
        """The one that is looked at."""
        return self.playback.frame

    def post(self, action: Action) -> None:
        """Do it in the session's thread."""
        with suppress(RuntimeError):  # The viewer has ended, its event loop is closed, and nobody waits for this.
            self._clock.call_soon_threadsafe(action)

    def begin(self) -> None:
        """Find out what the truth says, and solve where the corrections in the file are others, in the background."""
        if self.jury.has_truth:
            self.say("reading the truth ...")
            self.jury.read()
        else:
            self.say("no truth in this recording: no scores")
        if self.opened is not None and self.wish != self.opened_wish:
            self.solve()

    def pick(self, motion: int | None) -> None:
        """Pick a motion, or none."""
        self.picked = motion
        self.picked_changed()
        self.recoloured()

    def click(self, row: int | None) -> None:
        """Pick the motion of a row of the motions, or mark its segment, whichever clicks do now."""
        motions = self.answer.motions if self.answer else None
        if motions is None:
            return
        if self.clicks == "mark":
            mark = mark_at(motions, row) if row is not None else None
            if mark is not None:
                self.marks.add(mark)
            return
        motion = NOISE if row is None else int(motions.motion[row])
        self.pick(None if motion == NOISE else motion)

    def click_to(self, clicks: Clicks) -> None:
        """Clicks do something else from now on."""
        self.clicks = clicks
        self.clicks_changed()

    def colour_by(self, colouring: Colouring) -> None:
        """Other colours."""
        self.colouring = colouring
        self.recoloured()

    def want(self, settings: Settings) -> None:
        """Solve under other settings, as soon as they do not change any more."""
        if settings == self.settings:
            return
        self.wish = replace(self.wish, settings=settings)
        self.settings_changed()
        self._patience.do(self.solve)

    def correct(self, corrections: Corrections) -> None:
        """Solve under other corrections."""
        if corrections == self.corrections:
            return
        self.wish = replace(self.wish, corrections=corrections)
        self.corrections_changed()
        self._patience.cancel()
        self.solve()

    def reset(self) -> None:
        """Go back to the settings that the viewer was opened with; corrections stay."""
        self._patience.cancel()
        self.wish = replace(self.wish, settings=self.opened_wish.settings)
        self.settings_changed()
        self.solve()

    def solve(self) -> None:
        """Solve what is wished for, in the background."""
        if self._busy:
            return  # What is being solved is followed by what is wished for then.
        if self.opened is not None and self.wish == self.opened_wish:
            self._spent, self._granted = "", self.wish
            self._take(self.opened)
            self.say("")
            return
        self._busy = True
        self.say("solving ...")
        wish, begun = self.wish, time.monotonic()
        self._worker.do(
            lambda: wish.solved(self.bare, self._cache),
            done=partial(self._solved, wish, begun),
            refused=partial(self._refused, wish),
        )

    def _prepare(self) -> None:
        """Somebody points at something, and may correct it next."""
        if not self._busy and (self.picked is not None or self.marks.known):
            self._foresight.prepare(self._granted)

    def say(self, status: str) -> None:
        """Tell what is going on."""
        self.status = status
        self.status_changed()

    def _say_spent(self, more: str = "") -> None:
        """Tell what the answer took, unless another one is being made."""
        if not self._busy:
            self.say(", ".join(filter(None, (self._spent, more))))

    def _judge(self, answer: Answer | None) -> None:
        if answer is None or self.jury.visibility is None:
            self._say_spent()
            return
        self._say_spent("scoring ...")
        self.jury.judge(answer, done=partial(self._judged, answer))

    def _judged(self, answer: Answer, judgement: Judgement | None) -> None:
        better = replace(answer, judgement=judgement)
        if self.opened is answer:
            self.opened = better
        if self.answer is answer:
            self.answer = better
        self._say_spent()
        self.judged()
        self.recoloured()

    def _solved(self, wish: Wish, begun: float, motions: Motions) -> None:
        self._busy = False
        if wish.settings != self.settings:
            self.solve()
            return
        answer = Answer(motions=motions)
        if self.opened is None:
            self.opened, self.opened_wish = answer, wish
        self._granted = wish
        self._foresight.prepared = wish.settings
        self._take(answer)
        self._spent = f"solved in {time.monotonic() - begun:.1f} s"
        if wish == self.wish:
            self._judge(answer)
        else:
            self.solve()

    def _refused(self, wish: Wish, sentence: str) -> None:
        """Tell why; a correction that was added last, and contradicts those before it, is not kept."""
        self._busy = False
        if wish != self.wish:
            self.solve()
            return
        before = self._granted.corrections
        added = len(wish.corrections.correction) > len(before.correction)
        if added and wish.settings == self._granted.settings:
            self.wish = self._granted
            self.corrections_changed()
            sentence = f"not added: {sentence}"
        self.say(sentence)

    def _take(self, answer: Answer | None) -> None:
        self.answer = answer
        self.picked = None
        self.marks.forget()
        self.picked_changed()
        self.answered()
        self.judged()
