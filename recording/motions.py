"""Motions: what a solver says of a recording, one row a point and frame."""

from dataclasses import dataclass, field, fields
from typing import Any, Literal

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32, UInt8

NOISE = -1
SOURCES = ("observed", "intra", "inter")
"""How a row came about; `Motions.source` counts in this order."""
OBSERVED, INTRA, INTER = range(3)


@dataclass(frozen=True, kw_only=True, eq=False)
class Representative:
    """The place of one motion over time."""

    motion: int
    frame: Int32[np.ndarray, "moment"]
    """Consecutive frame numbers."""
    position: Float[np.ndarray, "moment 3"]
    """World axes, metres."""
    observed: Bool[np.ndarray, "moment"]
    """False where the place was completed."""


@dataclass(frozen=True, kw_only=True)
class Link:
    """Two segments that were joined into one motion."""

    before: int
    """The segment that ends."""
    after: int
    """The segment that begins."""
    confidence: float
    """The probability that both are of one object, 0 to 1."""
    chosen: bool = True
    """Whether it was made; false for the alternatives of doubtful ones."""


EventKind = Literal["merge", "split"]


@dataclass(frozen=True, kw_only=True)
class Event:
    """Two motions that become one, as when a ball is caught, or one that becomes two, as when it is thrown.

    Both keep their numbers: who is carried comes back as the same motion.
    """

    kind: EventKind
    frame: int
    """The first frame in which they move as one (`merge`), or apart (`split`)."""
    motions: tuple[int, int]
    """Different ones, in any order."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Making:
    """How a result was made."""

    settings: dict[str, Any] = field(default_factory=dict)
    recording_digest: str | None = None
    version: str | None = None
    seconds: dict[str, float] = field(default_factory=dict)
    """By stage."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motions:
    """The rows of `motions.parquet` as columns, sorted by trajectory, then frame; and what belongs to them."""

    frame: Int32[np.ndarray, "observation"]
    trajectory: Int32[np.ndarray, "observation"]
    position: Float32[np.ndarray, "observation 3"]
    """World axes, metres."""
    column_row: Float32[np.ndarray, "observation 2"]
    """Picture position, pixels; NaN where completed."""
    segment: Int32[np.ndarray, "observation"]
    motion: Int32[np.ndarray, "observation"]
    """`NOISE` where the point belongs to no motion."""
    source: UInt8[np.ndarray, "observation"]
    """Index into `SOURCES`."""
    confidence: Float32[np.ndarray, "observation"]
    representatives: tuple[Representative, ...] = ()
    links: tuple[Link, ...] = ()
    alternatives: tuple[Link, ...] = ()
    """Links that might have been made in place of doubtful ones; none of them is `chosen`."""
    events: tuple[Event, ...] = ()
    making: Making = field(default_factory=Making)

    def __len__(self) -> int:
        return len(self.frame)

    @property
    def observed(self) -> Bool[np.ndarray, "observation"]:
        """Which rows the sensor saw."""
        return self.source == OBSERVED

    @property
    def motion_ids(self) -> list[int]:
        """The motions, noise left out, ascending."""
        return [int(motion) for motion in np.unique(self.motion) if motion != NOISE]

    def rows(self, chosen: np.ndarray) -> "Motions":
        """The chosen rows (mask or indices), with everything that belongs to them."""
        columns = {name: getattr(self, name)[chosen] for name in COLUMNS}
        return Motions(
            **columns,
            representatives=self.representatives,
            links=self.links,
            alternatives=self.alternatives,
            events=self.events,
            making=self.making,
        )


COLUMNS = tuple(entry.name for entry in fields(Motions))[:8]
"""The fields of `Motions` that have an entry a row."""


def mean_places(motions: Motions) -> tuple[Representative, ...]:
    """A representative for every motion of a file without any: the mean of its points in each frame.

    Frames without a point between two with points are left out: nothing was said about them.
    """
    return tuple(_mean_place(motions, motion) for motion in motions.motion_ids)


def _mean_place(motions: Motions, motion: int) -> Representative:
    rows = motions.motion == motion
    frame, index = np.unique(motions.frame[rows], return_inverse=True)
    count = np.bincount(index)
    position = np.stack(
        [np.bincount(index, motions.position[rows, axis].astype(np.float64)) / count for axis in range(3)],
        axis=1,
    )
    observed = np.bincount(index, motions.observed[rows]) > 0
    return Representative(motion=motion, frame=frame.astype(np.int32), position=position, observed=observed)
