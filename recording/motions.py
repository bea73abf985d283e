"""Motions: what a solver says of a recording, one row a point and frame."""

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32, UInt8

from recording.camera import Camera, transformed
from recording.corrections import Corrections
from recording.markup import chip, note, table
from recording.palette import colour_of

if TYPE_CHECKING:
    import matplotlib.axes

NOISE = -1
SOURCES = ("observed", "intra", "inter")
"""How a row came about; `Motions.source` counts in this order."""
OBSERVED, INTRA, INTER = range(3)
_MOST_ROWS = 40
"""Motions that a notebook's table shows at the most."""


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
    corrections: Corrections | None = None
    """By hand, that were respected."""


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

    def plot(
        self, camera: Camera | None = None, *, axes: "matplotlib.axes.Axes | None" = None
    ) -> "matplotlib.axes.Axes":
        """Draw the way of every motion, on new axes if none are given: dotted where it was completed.

        Through a camera they are seen from its top. Without one they lie on the two world axes along which they reach
        farthest: for people those of the floor, whichever way is up.
        """
        from recording.drawing import draw_ways, new_axes  # noqa: PLC0415 - matplotlib is slow to import.

        curves = self.representatives or mean_places(self)
        places, labels = _from_above(camera, [curve.position for curve in curves])
        ways = [(curve.motion, place, curve.observed) for curve, place in zip(curves, places, strict=True)]
        drawn = axes or new_axes(shape=0.6)
        draw_ways(drawn, ways)
        drawn.set(xlabel=labels[0], ylabel=labels[1])
        return drawn

    def __repr__(self) -> str:
        completed = int((~self.observed).sum())
        return f"<Motions: {len(self.motion_ids)} motions, {len(self):,} points, {completed:,} of them completed>"

    def _repr_html_(self) -> str:
        """A row a motion, as a notebook shows it; of very many the first."""
        curves = self.representatives or mean_places(self)
        head = ("motion", "frames", "of them unseen", "trajectories", "points seen", "points completed")
        rows = [self._facts(curve) for curve in curves[:_MOST_ROWS]]
        left_out = f"{len(curves) - _MOST_ROWS} more motions, " if len(curves) > _MOST_ROWS else ""
        noise = int((self.motion == NOISE).sum())
        more = f"{left_out}{noise:,} points of no motion, {len(self.links)} links, {len(self.events)} events"
        return str(table(head, rows) + note(more))

    def _facts(self, curve: Representative) -> tuple[object, ...]:
        rows = self.motion == curve.motion
        seen = int((rows & self.observed).sum())
        return (
            chip(colour_of(curve.motion)) + f" {curve.motion}",
            f"{curve.frame.min()} to {curve.frame.max()}",
            int((~curve.observed).sum()),
            f"{len(np.unique(self.trajectory[rows])):,}",
            f"{seen:,}",
            f"{int(rows.sum()) - seen:,}",
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


def _from_above(
    camera: Camera | None, places: list[Float[np.ndarray, "moment 3"]]
) -> tuple[list[Float[np.ndarray, "moment 2"]], tuple[str, str]]:
    """Places on the two axes that they are drawn on, and the names of these."""
    if camera is not None:
        camera_from_world = np.linalg.inv(camera.world_from_camera)
        aside_ahead = [transformed(camera_from_world, place)[:, [0, 2]] for place in places]
        return aside_ahead, ("right of the camera [m]", "before the camera [m]")
    reach = np.ptp(np.concatenate(places), axis=0) if places else np.zeros(3)
    first, second = sorted(np.argsort(-reach, kind="stable")[:2].tolist())
    return [place[:, [first, second]] for place in places], (f"{'xyz'[first]} [m]", f"{'xyz'[second]} [m]")
