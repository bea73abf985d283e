"""What runs leave for later runs: the cache of the solver's stages, the journal of a sweep. A damaged one is none."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from algorithm.kept_stages import FLOWING, grouped_form, motion_form, observed_form
from algorithm.settings import Settings
from algorithm.staged import Course, solve
from algorithm.stages import Observed
from evaluation.sweeps.journal import Done, journal
from fuzz.target import Target
from recording.cache import Cache
from recording.camera import Camera
from recording.corrections import Corrections
from recording.frame import Frame
from recording.metadata import metadata_of
from recording.recording import Recording

_KEY = "stage"
_NAME = f"{_KEY[-2:]}/{_KEY}"
"""Where a cache has what it keeps under the key."""
_JOURNAL = ".unfinished.jsonl"


@cache
def _recording() -> Recording:
    """A patch that crosses the picture and is not seen for two frames."""
    depth = np.full((11, 9, 15), 3, np.float32)
    for frame in range(11):
        depth[frame, 2:7, frame : 5 + frame] = 2
    depth[5:7] = np.nan
    camera = Camera(width=15, height=9, fx=15.0, fy=15.0, cx=7.5, cy=4.5)
    metadata = metadata_of(camera, frames=len(depth), fps=10.0)
    return Recording(metadata=metadata, frames=tuple(Frame(depth=each) for each in depth))


def _stages() -> list[bytes]:
    """What a solver keeps while somebody corrects: a file a stage, of the motions one each."""
    recording = _recording()
    nothing_said = Corrections(recording_digest=recording.digest())
    with TemporaryDirectory() as folder:
        solve(recording, cache=Cache(folder=Path(folder)), corrections=nothing_said)
        return [path.read_bytes() for path in sorted(Path(folder).glob("*/*"))]


@cache
def _observed() -> Observed:
    """What the third stage's result belongs to."""
    recording = _recording()
    return Course(recording=recording, digest=recording.digest(), settings=Settings()).observed()


def _look_up(folder: Path) -> None:
    """Take the file for the result of each stage in turn; one that is damaged is removed."""
    content = (folder / _NAME).read_bytes()
    motion = motion_form(np.ones(4, np.bool_), np.zeros(4, np.int64))  # Whose it is, is told, not kept.
    for form in (FLOWING, observed_form(_recording()), grouped_form(_observed()), motion):
        (folder / _NAME).write_bytes(content)
        Cache(folder=folder).found(_KEY, form.read)


def _go_on(folder: Path) -> None:
    with journal(folder) as sweep:
        sweep.add(Done(key="b", scores={"worth": 0.5}))


KEPT = {
    "stages": Target(name=_NAME, read=_look_up, seeds=_stages),
    "journal": Target(
        name=_JOURNAL,
        read=_go_on,
        seeds=lambda: [b'{"key": "a", "scores": {"worth": 1.0}, "failure": null}\n{"key": "b", "sc'],
    ),
}
"""By what they read."""
