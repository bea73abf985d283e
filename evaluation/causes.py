"""What hides every moving object in every frame, pixel by pixel.

An object's unoccluded pixels are those of its X-ray twin. Each of them is seen, or covered by the object whose
label stands there, or the object's own but lost to the sensor. So an object never hides itself here: the X-ray
twin holds its front side only. That it hides points of its far side is a matter of points, and
`recording.correspondence` answers it (`covered_by` is then the object itself).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from recording.errors import InputError
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import HIDDEN_BELOW, Visibility, visibility_of

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


def causes_of(recording: Recording, visibility: Visibility | None = None) -> Causes:
    """What hides each moving object in each frame, from one pass over frames and X-rays.

    `visibility` saves a second pass where it is known already. Needs labels and X-ray twins that agree, as
    `verify` checks; a recording without them is an `InputError`.
    """
    if recording.xray is None or recording.metadata.objects is None:
        raise InputError("expected a recording with X-ray twins, got one without: only simulated ones know what hides")
    visibility = visibility or visibility_of(recording)
    covers = tuple(sorted(entry.id for entry in recording.metadata.objects))
    count = recording.metadata.frames
    tables = [_met(recording, visibility.ids, number) for number in tracked(range(count), "causes", total=count)]
    met = np.array(tables, np.int64).reshape(count, len(visibility.ids), max(covers, default=0) + 2)
    return _causes(visibility, covers, met.transpose(1, 0, 2))


def _met(recording: Recording, ids: tuple[int, ...], number: int) -> list[Int64[np.ndarray, "label"]]:
    """For each moving object: how many of its unoccluded pixels carry each label in the frame.

    The last entry counts labels of what there is not.
    """
    labels, xray = recording.frames[number].labels, (recording.xray or [])[number]
    if labels is None or not set(ids) <= set(xray):
        raise InputError(f"frame {number}: expected labels and an X-ray of every moving object: make it again")
    beyond = max((entry.id for entry in recording.metadata.objects or ()), default=0) + 1
    found = np.minimum(labels.objectid, beyond).astype(np.int64)
    return [np.bincount(found[np.isfinite(xray[one])], minlength=beyond + 1) for one in ids]


def _causes(visibility: Visibility, covers: tuple[int, ...], met: Int64[np.ndarray, "object frame label"]) -> Causes:
    """The causes by the labels that each object's unoccluded pixels carry."""
    own = np.take_along_axis(met, np.array(visibility.ids, np.int64)[:, None, None], axis=2)[..., 0]
    unoccluded, lost = met.sum(axis=2), own - visibility.seen
    covered = met[..., list(covers)].copy()
    covered[np.arange(len(visibility.ids)), :, np.searchsorted(covers, visibility.ids)] = 0
    most = np.array(covers, np.int64)[covered.argmax(axis=2)]
    cause = np.where(lost > covered.max(axis=2), SENSOR, most)
    hidden = visibility.seen < HIDDEN_BELOW * unoccluded
    return Causes(
        ids=visibility.ids,
        covers=covers,
        seen=visibility.seen,
        unoccluded=unoccluded,
        covered=covered,
        lost=lost,
        cause=np.where(unoccluded == 0, OUT_OF_VIEW, np.where(hidden, cause, NOT_HIDDEN)),
    )
