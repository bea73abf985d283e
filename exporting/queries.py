"""The points whose tracks are exported: where each is first seen, and what it is a point of."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from exporting.source import Source
from recording.camera import PIXEL_CENTRE
from recording.correspondence import exact_labels
from recording.frame import Labels
from recording.motions import NOISE
from recording.over_time import spread_numbers

_FRAMES, _COUNT = 8, 1024
"""Without motions tracks begin in so many frames, and are at most so many."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Queries:
    """Points of a recording."""

    column_row: Float[np.ndarray, "track 2"]
    """Picture position, pixels."""
    frame: Int[np.ndarray, "track"]
    trajectory: Int[np.ndarray, "track"]
    """Ascending."""
    motion: Int[np.ndarray, "track"]
    """`NOISE` where there are no motions."""

    def __len__(self) -> int:
        return len(self.frame)

    def of(self, chosen: Bool[np.ndarray, "track"]) -> "Queries":
        """Some of them."""
        return Queries(**{name: values[chosen] for name, values in vars(self).items()})


def first_seen(source: Source) -> Queries:
    """Where each trajectory of a motion was first seen in the picture."""
    motions = source.needed_motions("tapvid3d")
    seen = motions.observed & (motions.motion != NOISE) & source.recording.camera.contains(motions.column_row)
    row = np.flatnonzero(seen)
    trajectory, first = np.unique(motions.trajectory[row], return_index=True)
    row = row[first]
    return Queries(
        column_row=motions.column_row[row],
        frame=motions.frame[row],
        trajectory=trajectory,
        motion=motions.motion[row],
    )


def evenly_spread(source: Source) -> Queries:
    """Pixels of moving objects, one of so many in each of some frames that are spread over the recording."""
    recording, found = source.recording, []
    for moment in spread_numbers(source.frames, _FRAMES):
        objectid = exact_labels(recording.frames[moment], moment).objectid
        row, column = np.nonzero(np.isin(objectid, recording.moving_ids))
        found.append(np.stack([column, row, np.full(len(row), moment)], axis=-1))
    every = np.concatenate(found)
    chosen = every[:: max(1, -(-len(every) // _COUNT))]
    return Queries(
        column_row=chosen[:, :2] + PIXEL_CENTRE,
        frame=chosen[:, 2],
        trajectory=np.arange(len(chosen)),
        motion=np.full(len(chosen), NOISE),
    )


def labels_at(source: Source, queries: Queries) -> Labels:
    """The material points behind the centres of the queries' pixels, as an image one pixel wide."""
    column, row = np.floor(queries.column_row).astype(np.intp).T
    found = {"objectid": np.uint32(0), "face": np.uint32(0), "u": np.float32(0), "v": np.float32(0)}
    images = {name: np.full((len(queries), 1), nothing) for name, nothing in found.items()}
    for frame in np.unique(queries.frame).tolist():
        labels = exact_labels(source.recording.frames[frame], frame)
        here = np.flatnonzero(queries.frame == frame)
        for name, image in images.items():
            image[here, 0] = getattr(labels, name)[row[here], column[here]]
    return Labels(**images)


def chosen_rows(labels: Labels, chosen: Bool[np.ndarray, "track"]) -> Labels:
    """Some rows of exact labels."""
    return Labels(**{name: values[chosen] for name, values in vars(labels).items()})
