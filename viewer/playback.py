"""Which frame is looked at, and how time goes on."""

import time

from viewer.clock import Clock, Signal, Timer

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
"""Multiples of the recording's own speed."""


class Playback:
    """A frame that moves on by itself while it plays, round and round; frames that nobody had time for are skipped."""

    def __init__(self, *, frames: int, fps: float, clock: Clock) -> None:
        self.frames, self.fps = frames, fps
        self.frame, self.speed, self.playing = 0, 1.0, False
        self.moved, self.playing_changed = Signal(), Signal()
        self._clock = clock
        self._since, self._from = time.monotonic(), 0
        self._timer: Timer | None = None

    def go_to(self, frame: int) -> None:
        """Look at another frame; beyond the ends it begins anew."""
        self.frame = frame % self.frames
        self._restart()
        self.moved()

    def step(self, frames: int) -> None:
        """Stop, and look at a frame so many later."""
        self.play(False)
        self.go_to(self.frame + frames)

    def play(self, playing: bool) -> None:
        """Play, or stop."""
        if playing == self.playing:
            return
        self.playing = playing
        self._restart()
        self.playing_changed()
        if playing:
            self._tick()
        elif self._timer is not None:
            self._timer.cancel()

    def set_speed(self, speed: float) -> None:
        """Play at a multiple of the recording's own speed."""
        self.speed = speed
        self._restart()

    def _restart(self) -> None:
        """Count time from now on."""
        self._since, self._from = time.monotonic(), self.frame

    def _tick(self) -> None:
        rate = self.fps * self.speed
        passed = int((time.monotonic() - self._since) * rate)
        due = (self._from + passed) % self.frames
        if due != self.frame:
            self.frame = due
            self.moved()
        wait = (passed + 1) / rate + self._since - time.monotonic()
        self._timer = self._clock.call_later(max(wait, 0.0), self._tick)
