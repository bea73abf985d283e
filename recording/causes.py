"""What hides every moving object in every frame, pixel by pixel.

An object's unoccluded pixels are those of its X-ray twin. Each of them is seen, or covered by the object whose
label stands there, or the object's own but lost to the sensor. So an object never hides itself here: the X-ray
twin holds its front side only. That it hides points of its far side is a matter of points, and
`recording.correspondence` answers it (`covered_by` is then the object itself).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from recording.errors import InputError
from recording.frame import Frame
from recording.metadata import Metadata
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import HIDDEN_BELOW, seen_pixels
from recording.xray import XRay

NOT_HIDDEN = 0
"""The cause where an object is not hidden."""
OUT_OF_VIEW = -1
"""The cause where an object has no unoccluded pixel."""
SENSOR = -2
"""The cause where most of the missing pixels show the object, and the sensor lost their return."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Causes:
    """Pixel counts of the moving objects by what became of them, an entry an object and frame."""

    ids: tuple[int, ...]
    """The moving objects, ascending: the first axis."""
    covers: tuple[int, ...]
    """All objects, ascending: the last axis of `covered`."""
    seen: Int64[np.ndarray, "object frame"]
    """Unoccluded pixels with a return and the object's label."""
    unoccluded: Int64[np.ndarray, "object frame"]
    """Pixels of the X-ray twin; seen + hidden."""
    covered: Int64[np.ndarray, "object frame cover"]
    """Unoccluded pixels in which another object stands before this one, by that object."""
    lost: Int64[np.ndarray, "object frame"]
    """Unoccluded pixels that show the object but have no return; hidden is covered + lost."""
    cause: Int64[np.ndarray, "object frame"]
    """Where an object is hidden (under 20 % of it seen), the id of the object that covers most of it, the lowest
    one of equals; `SENSOR` where more is lost than any object covers; `NOT_HIDDEN`, `OUT_OF_VIEW`."""

    @property
    def hidden(self) -> Int64[np.ndarray, "object frame"]:
        """Unoccluded pixels in which the object is not seen."""
        return self.unoccluded - self.seen

    def shares(self, objectid: int, frame: int) -> dict[int, float]:
        """What covers the object in the frame: the share of its unoccluded pixels, by id, largest first.

        What the sensor lost stands under `SENSOR`. Empty where all of the object is seen, or it is out of view.
        """
        if objectid not in self.ids:
            raise InputError(f"expected a moving object, one of {list(self.ids)}, got {objectid}")
        if not 0 <= frame < self.seen.shape[1]:
            raise InputError(f"expected a frame from 0 to {self.seen.shape[1] - 1}, got {frame}")
        place = self.ids.index(objectid), frame
        counts = {**dict(zip(self.covers, self.covered[place].tolist(), strict=True)), SENSOR: int(self.lost[place])}
        found = sorted((-count, cover) for cover, count in counts.items() if count)
        return {cover: -negative / int(self.unoccluded[place]) for negative, cover in found}


@dataclass(frozen=True, kw_only=True, eq=False)
class Tally:
    """What is counted in one frame: it is small, and `causes_from` needs no more."""

    seen: Int64[np.ndarray, "object"]
    """Pixels with a return and the moving object's label."""
    met: Int64[np.ndarray, "object label"]
    """Unoccluded pixels of the moving object that carry each label; the last one counts labels of what there is not."""


def causes_of(recording: Recording) -> Causes:
    """What hides each moving object in each frame, from one pass over frames and X-rays.

    Needs labels and X-ray twins that agree, as `verify` checks; a recording without them is an `InputError`.
    """
    if recording.xray is None or recording.metadata.objects is None:
        raise InputError("expected a recording with X-ray twins, got one without: only simulated ones know what hides")
    pictures = zip(recording.frames, recording.xray, strict=True)
    count = recording.metadata.frames
    tallies = [tally_of(*picture, recording.metadata) for picture in tracked(pictures, "causes", total=count)]
    return causes_from(tallies, recording.metadata)


def tally_of(frame: Frame, xray: XRay, metadata: Metadata) -> Tally:
    """The tally of a frame with labels and its X-ray twin."""
    ids, _ = _moving_and_all(metadata)
    if frame.labels is None or not set(ids) <= set(xray):
        raise InputError("expected labels and an X-ray of every moving object in every frame: make the recording again")
    beyond = max((entry.id for entry in metadata.objects or ()), default=0) + 1
    found = np.minimum(frame.labels.objectid, beyond).astype(np.int64)
    seen = seen_pixels(frame)
    met = [np.bincount(found[np.isfinite(xray[one])], minlength=beyond + 1) for one in ids]
    return Tally(
        seen=np.array([seen.get(one, 0) for one in ids], np.int64),
        met=np.array(met, np.int64).reshape(len(ids), beyond + 1),
    )


def causes_from(tallies: Sequence[Tally], metadata: Metadata) -> Causes:
    """What hides each moving object, by the tally of every frame, in their order."""
    ids, covers = _moving_and_all(metadata)
    seen = np.stack([tally.seen for tally in tallies], axis=1)
    met = np.stack([tally.met for tally in tallies], axis=1)
    own = np.take_along_axis(met, np.array(ids, np.int64)[:, None, None], axis=2)[..., 0]
    unoccluded, lost = met.sum(axis=2), own - seen
    covered = met[..., list(covers)].copy()
    covered[np.arange(len(ids)), :, np.searchsorted(covers, ids)] = 0
    most = np.array(covers, np.int64)[covered.argmax(axis=2)]
    cause = np.where(lost > covered.max(axis=2), SENSOR, most)
    hidden = seen < HIDDEN_BELOW * unoccluded
    return Causes(
        ids=ids,
        covers=covers,
        seen=seen,
        unoccluded=unoccluded,
        covered=covered,
        lost=lost,
        cause=np.where(unoccluded == 0, OUT_OF_VIEW, np.where(hidden, cause, NOT_HIDDEN)),
    )


def _moving_and_all(metadata: Metadata) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The ids of what moves, and of everything, ascending."""
    objects = sorted(metadata.objects or (), key=lambda entry: entry.id)
    return tuple(entry.id for entry in objects if entry.moving), tuple(entry.id for entry in objects)
