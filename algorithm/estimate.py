"""What solving a recording will take, from a few of its frames."""

import time
from dataclasses import dataclass, replace

import numpy as np

from algorithm.pipeline import moving_depths
from algorithm.scene_flow import Footage, flows_between
from algorithm.settings import Settings
from recording.metadata import Metadata
from recording.recording import Recording

_LONG = 5e7
"""Pixels in all frames: half a minute."""
_PAIRS = 16
"""Of consecutive frames, spread over the recording: what stands still and how many points move is judged by them."""
_TIMED = 3
"""Of these pairs, after a first one."""
_SHARE_FOR_FRAMES = 0.25
"""Of the memory: where all depth images fit into it, with and without what stands still, they stay there."""
_FEWEST_AT_HAND = 8
_PASSES = 6
"""How often a depth image is read that does not stay in memory."""
_BASE_BYTES = 5e8
_BYTES_A_PIXEL = 400.0
"""Of a picture, while what stands still is recognised."""
_BYTES_FLOWING = 2 * 16.0 * 2 * 64
"""Of the moving points of a frame: the flows of a part, and as much again to keep it."""
_BYTES_FOLLOWED, _BYTES_KEPT = 30.0, 300.0
"""Of each moving point in each frame: while it is followed, and if it is kept."""
_FARTHEST_APART_PX = 4
"""Of fewer points, what is small is lost."""
_SECONDS_A_POINT = 8e-6
"""Of all steps after the flow, on one core."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What solving a recording will take."""

    points: float
    """Moving points in all frames together."""
    seconds: float
    """On this machine, as busy as it is now, if no stage is in the cache."""
    least_bytes: float
    """Of the libraries, of the depth images and of the flows that are in memory at a time."""
    points_apart_px: int
    """As the settings have it."""

    @property
    def memory_bytes(self) -> float:
        """The largest that it will need at a time."""
        return self.least_bytes + self.points * (_BYTES_FOLLOWED + _BYTES_KEPT / self.points_apart_px**2)

    def within(self, memory_bytes: int) -> "Estimate | None":
        """The same with points so far apart that so much memory is enough; None where nothing helps."""
        every = range(self.points_apart_px, max(self.points_apart_px, _FARTHEST_APART_PX) + 1)
        fewer = (replace(self, points_apart_px=apart) for apart in every)
        return next((one for one in fewer if one.memory_bytes <= memory_bytes), None)


def is_long(metadata: Metadata) -> bool:
    """Whether solving takes so long that the seconds of an estimate are worth it."""
    return metadata.frames * metadata.width * metadata.height > _LONG


def room_for(metadata: Metadata, memory_bytes: int) -> int:
    """How many depth images may stay in memory: all, if they take a small part of it, else the few that are at work."""
    both = 2 * 4 * metadata.frames * metadata.width * metadata.height
    return metadata.frames if both <= _SHARE_FOR_FRAMES * memory_bytes else _FEWEST_AT_HAND


def estimated(recording: Recording, settings: Settings | None = None, *, memory_bytes: int) -> Estimate:
    """What solving the recording will take, if it may use so much memory; it takes some seconds to tell.

    Points are counted in some frames spread over the recording, the flow is timed between three pairs of them. A crowd
    that comes and goes between these is not seen: numbers hold within a factor of two.
    """
    settings, about = settings or Settings(), recording.metadata
    begun = time.perf_counter()
    firsts = np.linspace(0, max(about.frames - 2, 0), _PAIRS).astype(int).tolist()
    sensed = [recording.frames[min(number + k, about.frames - 1)].depth for number in firsts for k in (0, 1)]
    read_seconds = (time.perf_counter() - begun) / len(sensed)
    moving = moving_depths(sensed, settings) if settings.remove_static else sensed
    points = about.frames * float(np.mean([np.isfinite(depth).sum() for depth in moving]))
    room = room_for(about, memory_bytes)
    passes = _PASSES if room < about.frames else 1
    footage = Footage(moving=moving, sensed=sensed, camera=recording.camera, fps=recording.fps)
    flow_seconds = _seconds_a_pair(footage, settings)
    return Estimate(
        points=points,
        seconds=about.frames * (flow_seconds + passes * read_seconds) + _SECONDS_A_POINT * points,
        least_bytes=_BASE_BYTES
        + (2 * 4.0 * room + _BYTES_A_PIXEL) * about.width * about.height
        + _BYTES_FLOWING * points / about.frames,
        points_apart_px=settings.points_apart_px,
    )


def _seconds_a_pair(footage: Footage, settings: Settings) -> float:
    """The time that the flow between two frames takes, there and back; the first, which compiles, does not count."""
    flows = flows_between(footage, settings)
    spent = []
    for first in np.linspace(0, _PAIRS - 1, _TIMED + 1).astype(int).tolist():
        begun = time.perf_counter()
        flows(2 * first, 2 * first + 1)
        spent.append(time.perf_counter() - begun)
    return float(np.median(spent[1:]))
