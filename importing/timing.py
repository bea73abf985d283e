"""From time stamps to frame numbers: a recording has evenly spaced frames, so what was dropped leaves empty ones."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from recording.errors import InputError

Dropped = Literal["empty", "skip"]
"""A dropped frame becomes an empty one, or is left out, which puts the frames beside it next to one another."""
LONGEST_GAP_SECONDS = 10.0
SLOWEST_FPS, QUICKEST_FPS = 1e-3, 1e3
"""No depth camera sees less, or more; and a gap is ten thousand empty frames at the most."""
_LATE = 1.7
"""A frame is dropped where the next comes this many frame times later; less is jitter of the clock."""
_TRUST = 0.2
"""How far one stamp moves the even beat; the jitter of single stamps averages out."""


@dataclass(frozen=True, kw_only=True)
class Timeline:
    """Which frame of the recording each frame of the source is."""

    fps: float
    places: tuple[int, ...]
    """The number of each of the source's frames in the recording; the numbers between are empty frames."""
    stamps: tuple[float, ...] | None
    """Seconds, one for each frame of the recording; those of empty frames lie evenly between."""

    @property
    def frames(self) -> int:
        """The number of frames of the recording."""
        return self.places[-1] + 1

    @property
    def empty(self) -> int:
        """How many of them are empty."""
        return self.frames - len(self.places)


def timeline(
    times: tuple[float, ...] | None, *, count: int, fps: float | None, dropped: Dropped, source: str
) -> Timeline:
    """The frames' numbers by their times; without times they follow one another at the given rate."""
    if times is None:
        if fps is None:
            raise InputError(f"{source}: expected frames a second, but nothing in it says how many: pass --fps")
        return Timeline(fps=fps, places=tuple(range(count)), stamps=None)
    stamps = np.array(times, dtype=np.float64)
    _check_growing(stamps, source)
    rate = _rate(stamps, fps, source)
    places = np.arange(count) if dropped == "skip" else _places(stamps, rate)
    widest = float(np.max(np.diff(stamps), initial=0.0))
    if dropped == "empty" and widest > max(LONGEST_GAP_SECONDS, 2 / rate):
        number = int(np.argmax(np.diff(stamps)))
        raise InputError(
            f"{source}: expected gaps below {LONGEST_GAP_SECONDS:g} s, got one of {widest:g} s after frame {number}: "
            "import the parts alone, or pass --dropped skip"
        )
    even = np.interp(np.arange(places[-1] + 1), places, stamps)
    return Timeline(fps=rate, places=tuple(map(int, places)), stamps=tuple(map(float, even)))


def _check_growing(stamps: Float[np.ndarray, "moment"], source: str) -> None:
    if not np.isfinite(stamps).all():
        raise InputError(f"{source}: expected time stamps in seconds, got {stamps[~np.isfinite(stamps)][0]}")
    wrong = np.flatnonzero(np.diff(stamps) <= 0)
    if wrong.size:
        a, b = (float(stamps[wrong[0] + step]) for step in (0, 1))
        raise InputError(
            f"{source}: expected time stamps that grow, got {b!r} after {a!r} at frame {wrong[0] + 1}: put the frames "
            "in the order of their times, each once"
        )


def _rate(stamps: Float[np.ndarray, "moment"], fps: float | None, source: str) -> float:
    """Frames a second: as the user says, if the time stamps agree, else by the median of their distances."""
    if len(stamps) == 1:
        if fps is None:
            raise InputError(f"{source}: expected frames a second, which one frame does not tell: pass --fps")
        return fps
    with np.errstate(over="ignore"):  # What is infinite is too quick.
        measured = float(np.round(1 / np.median(np.diff(stamps)), 3))
    if not SLOWEST_FPS <= measured <= QUICKEST_FPS:
        raise InputError(
            f"{source}: expected time stamps in seconds, of {SLOWEST_FPS:g} to {QUICKEST_FPS:g} frames a second, got "
            f"those of {measured:g}"
        )
    if fps is None:
        return measured
    if not 2 / 3 < fps / measured < 1.5:
        raise InputError(f"fps: expected about {measured:g}, as the time stamps say, got {fps:g}: leave --fps out")
    return fps


def _places(stamps: Float[np.ndarray, "moment"], rate: float) -> np.ndarray:
    """Frame numbers by an even beat that follows the stamps slowly, so that neither jitter nor drift makes gaps."""
    places, beat = [0], stamps[0]
    for stamp in stamps[1:]:
        steps = max(1, int((stamp - beat) * rate + 2 - _LATE))
        places.append(places[-1] + steps)
        beat += steps / rate
        beat += _TRUST * (stamp - beat)
    return np.array(places)
