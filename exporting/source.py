"""What is exported: a recording with the motions found in it, looked up frame by frame."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float32, Int, Int32

from recording.errors import InputError
from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording
from recording.truth import Truth

_PLAIN = "-_"
"""What a file's name may hold beside letters and digits."""

_UPRIGHT = 0.5
"""From this share on the camera's top points along the world's z axis."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """The points that motions have in one frame."""

    frame: int
    position: Float32[np.ndarray, "point 3"]
    """World axes, metres."""
    motion: Int32[np.ndarray, "point"]
    """`NOISE` where the point belongs to no motion."""
    trajectory: Int32[np.ndarray, "point"]
    completed: Bool[np.ndarray, "point"]
    """Whether nobody saw the point there."""
    confidence: Float32[np.ndarray, "point"]

    def of(self, chosen: Bool[np.ndarray, "point"]) -> "Moment":
        """Some of the points."""
        columns = ("position", "motion", "trajectory", "completed", "confidence")
        return Moment(frame=self.frame, **{name: getattr(self, name)[chosen] for name in columns})


@dataclass(frozen=True, kw_only=True, eq=False)
class Source:
    """A recording, and the motions found in it if there are any."""

    recording: Recording
    motions: Motions | None = None

    def __post_init__(self) -> None:
        if self.motions is not None and len(self.motions):
            first, last = int(self.motions.frame.min()), int(self.motions.frame.max())
            if first < 0 or last >= self.frames:
                wrong = first if first < 0 else last
                raise InputError(
                    f"expected motions in frames 0 to {self.frames - 1}, got frame {wrong}: solve it again"
                )

    @property
    def frames(self) -> int:
        """How many there are."""
        return self.recording.metadata.frames

    @property
    def upright(self) -> bool:
        """Whether the world's z axis is up: the camera's top points along it. Else nobody has placed the camera."""
        return bool(-self.recording.camera.world_from_camera[2, 1] > _UPRIGHT)

    @cached_property
    def digest(self) -> str:
        """The recording's, by the motions, which were checked against it, if these know it."""
        return (self.motions and self.motions.making.recording_digest) or self.recording.digest()

    @property
    def name(self) -> str:
        """The recording's name as that of a file or a node: letters, digits, `-` and `_`."""
        name = self.recording.metadata.name or ""
        plain = "".join(sign if sign.isascii() and (sign.isalnum() or sign in _PLAIN) else "_" for sign in name)
        return plain or "recording"

    def needed_motions(self, format_name: str) -> Motions:
        """The motions, for a format that is about nothing else."""
        if self.motions is None:
            raise InputError(f"{format_name}: expected motions, got a recording alone: run 'unocclude solve' first")
        return self.motions

    def needed_truth(self, format_name: str) -> Truth:
        """The truth's meshes, for a format that has nothing else to show."""
        if self.recording.truth is None:
            raise InputError(f"{format_name}: expected motions or a truth, got neither: run 'unocclude solve' first")
        return self.recording.truth

    def numbers(self, words: str) -> Iterator[int]:
        """The frames' numbers, counted on the progress bar."""
        return tracked(range(self.frames), words, total=self.frames)

    def moment(self, frame: int) -> Moment:
        """The points of the motions in a frame; none where there are no motions."""
        motions = self.needed_motions("points")
        start, stop = self._bounds[frame : frame + 2]
        rows = self._order[start:stop]
        return Moment(
            frame=frame,
            position=motions.position[rows],
            motion=motions.motion[rows],
            trajectory=motions.trajectory[rows],
            completed=~(motions.source[rows] == 0),
            confidence=motions.confidence[rows],
        )

    @cached_property
    def _order(self) -> Int[np.ndarray, "observation"]:
        """The rows by frame, within a frame by trajectory: the one array as long as the motions that is made."""
        return np.argsort(self.needed_motions("points").frame, kind="stable")

    @cached_property
    def _bounds(self) -> Int[np.ndarray, "frame_and_one"]:
        counts = np.bincount(self.needed_motions("points").frame, minlength=self.frames)
        return np.concatenate([[0], np.cumsum(counts)])
