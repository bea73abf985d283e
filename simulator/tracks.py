"""Everybody in a trajectory file, as smooth tracks over the file's ground."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from simulator.trajectory_rows import Row, by_frames, rows_of, smoothed

STEP_S = 0.1
"""Between the moments of a track."""
_GAP_S = 2.0  # Who was lost for longer is somebody else.
_END_S = 0.5  # Whose record ends walks on as in the last so many seconds.


@dataclass(frozen=True, kw_only=True, eq=False)
class Track:
    """One person."""

    begin_s: float
    """When the record begins, seconds after the file's first frame."""
    places: Float[np.ndarray, "time 2"]
    """Every `STEP_S` from then on, metres."""

    @property
    def end_s(self) -> float:
        """When the record ends, seconds after the file's first frame."""
        return self.begin_s + STEP_S * (len(self.places) - 1)

    def recorded(self, times: Float[np.ndarray, "moment"]) -> Bool[np.ndarray, "moment"]:
        """Whether the times are those of the record."""
        return (times >= self.begin_s) & (times <= self.end_s)

    def at(self, times: Float[np.ndarray, "moment"]) -> Float[np.ndarray, "moment 2"]:
        """The places at the times, metres: before and after the record on a straight line, at the speed there."""
        own = self.begin_s + STEP_S * np.arange(len(self.places))
        inside = np.stack([np.interp(times, own, axis) for axis in self.places.T], axis=-1)
        last = min(len(self.places) - 1, round(_END_S / STEP_S))
        ahead = (self.places[last] - self.places[0]) / (last * STEP_S)
        on = (self.places[-1] - self.places[-1 - last]) / (last * STEP_S)
        early, late = np.minimum(times - own[0], 0.0), np.maximum(times - own[-1], 0.0)
        return inside + early[:, None] * ahead + late[:, None] * on


@dataclass(frozen=True, kw_only=True, eq=False)
class Tracks:
    """All people of a file."""

    source: Path
    first_frame: float
    """The file's first and last."""
    last_frame: float
    fps: float
    tracks: tuple[Track, ...]
    """In the order of their ids; who was lost for long is somebody else afterwards."""

    @property
    def seconds(self) -> float:
        """From the first frame to the last."""
        return (self.last_frame - self.first_frame) / self.fps


def tracks_of(source: Path, *, fps: float, metres: float) -> Tracks:
    """Everybody in the file, smoothed as `trajectory_rows.smoothed` does; `metres` is the file's unit.

    Who is in the file for less than two moments of a track is left out.
    """
    people: dict[float, list[Row]] = {}
    for row in rows_of(source):
        people.setdefault(row[1][0], []).append(row)
    rows = [by_frames(source, people[one]) for one in sorted(people)]
    first = min(own[0, 1] for own in rows)
    tracks = []
    for own in rows:
        lost = np.flatnonzero(np.diff(own[:, 1]) > _GAP_S * fps) + 1
        tracks += [_track((part[:, 1] - first) / fps, part[:, 2:] * metres) for part in np.split(own, lost)]
    return Tracks(
        source=source,
        first_frame=float(first),
        last_frame=float(max(own[-1, 1] for own in rows)),
        fps=fps,
        tracks=tuple(track for track in tracks if len(track.places) > 1),
    )


def _track(time: Float[np.ndarray, "row"], places: Float[np.ndarray, "row 2"]) -> Track:
    """The track through somebody's places."""
    sampled = np.arange(time[0], time[-1] + 1e-9, STEP_S)
    return Track(begin_s=float(time[0]), places=smoothed(time, places, sampled))
