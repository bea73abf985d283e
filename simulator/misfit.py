"""How far what is foretold of crowds is from what was wished: the measure by which scenes are searched for.

Every term is 1 where it is as far off as can be borne, and grows with the square. Whether somebody is hidden hangs on
a threshold, and foresight is not exact: so that a scene is not taken for a hole that opens and closes at a hair's
breadth, everything is measured at three thresholds, and the mean taken.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, UInt64
from scipy.special import ndtri

from recording.visibility import HIDDEN_BELOW
from simulator.foresight import seen_share
from simulator.occlusion import OcclusionWish

THRESHOLDS = (HIDDEN_BELOW - 0.07, HIDDEN_BELOW, HIDDEN_BELOW + 0.07)
LENGTH_OFF = 0.2
"""Of the logarithm of a hole's length."""
SHARE_OFF = 0.1
"""Of the hidden share, relative; and of the share that somebody else hides than was wished."""
STRAY_BORNE, STRAY_OFF = 0.2, 0.25
"""Of the hidden object-frames, those in no hole, for somebody enters, leaves or begins hidden: so many are borne."""
NO_HOLE = 25.0
"""As bad as holes five times too far off."""
_LEAST_OF_BOTH = 0.25
_AS_FAR_AS_COUNTS = 9.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Cover:
    """What is foretold of crowds, an entry a crowd, person and frame; cells as in `simulator.foresight`."""

    inside: UInt64[np.ndarray, "crowd person frame"]
    """The cells in the picture."""
    people: UInt64[np.ndarray, "crowd person frame"]
    """Those that other people cover."""
    obstacles: UInt64[np.ndarray, "crowd person frame"]
    """Those that obstacles cover."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Holes:
    """The holes of several crowds, by crowd and length."""

    crowd: Int[np.ndarray, "hole"]
    frames: Int[np.ndarray, "hole"]


def misfit(wish: OcclusionWish, cover: Cover, *, chance: float) -> Float[np.ndarray, "crowd"]:
    """How far each crowd is from the wish: about 1 where it is as far off as can be borne.

    `chance`, from 0 to 1, says where between two quantiles of the wanted distribution the lengths are wanted: drawn
    anew for each scene, it makes the lengths of many scenes together those of the distribution.
    """
    seen = seen_share(cover.inside, cover.people | cover.obstacles)
    in_view = cover.inside > 0
    off = [_lengths_off(wish, seen < limit, in_view, chance) for limit in THRESHOLDS]
    if wish.hidden_share is not None:
        shares = [hidden_share(seen < limit, in_view) for limit in THRESHOLDS]
        off += [((np.maximum(share, 1e-3) / wish.hidden_share - 1) / SHARE_OFF) ** 2 for share in shares]
    if wish.by != "anything":
        off += [_hider_off(wish, cover, seen < HIDDEN_BELOW) * len(THRESHOLDS)]
    return np.sum(off, axis=0) / len(THRESHOLDS)


@dataclass(frozen=True, kw_only=True)
class Foretold:
    """What is foretold of one crowd."""

    hole_median: float | None
    """Frames; None where there is no hole."""
    hidden_share: float

    @property
    def sentence(self) -> str:
        """It in words."""
        holes = "no hole" if self.hole_median is None else f"holes of {self.hole_median:g} frames"
        return f"{holes} and {self.hidden_share:.2f} hidden"


def foretold(cover: Cover) -> Foretold:
    """What is foretold of the first of the crowds."""
    hidden = seen_share(cover.inside, cover.people | cover.obstacles)[:1] < HIDDEN_BELOW
    in_view = cover.inside[:1] > 0
    lengths = holes_of(hidden, in_view).frames
    return Foretold(
        hole_median=float(np.median(lengths)) if len(lengths) else None,
        hidden_share=float(hidden_share(hidden, in_view)[0]),
    )


def hidden_share(
    hidden: Bool[np.ndarray, "crowd person frame"], in_view: Bool[np.ndarray, "crowd person frame"]
) -> Float[np.ndarray, "crowd"]:
    """The share of the object-frames in view in which the object is hidden; 0 where nobody is in view."""
    return (hidden & in_view).sum(axis=(1, 2)) / np.maximum(in_view.sum(axis=(1, 2)), 1)


def holes_of(hidden: Bool[np.ndarray, "crowd person frame"], in_view: Bool[np.ndarray, "crowd person frame"]) -> Holes:
    """The runs of hidden frames between two frames in which the person is seen, as in `recording.visibility`."""
    crowds, people, frames = hidden.shape
    dark = np.zeros((crowds * people, frames + 2), np.int8)
    clear = np.zeros_like(dark)
    dark[:, 1:-1] = (hidden & in_view).reshape(-1, frames)
    clear[:, 1:-1] = (in_view & ~hidden).reshape(-1, frames)
    change = np.diff(dark.reshape(-1), append=np.int8(0))
    before, last = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    whole = (clear.reshape(-1)[before] > 0) & (clear.reshape(-1)[last + 1] > 0)
    crowd, lengths = before[whole] // ((frames + 2) * people), (last - before)[whole]
    order = np.lexsort((lengths, crowd))
    return Holes(crowd=crowd[order], frames=lengths[order])


def _lengths_off(
    wish: OcclusionWish, hidden: np.ndarray, in_view: np.ndarray, chance: float
) -> Float[np.ndarray, "crowd"]:
    """The mean square of how far the holes' lengths are from the quantiles of the wanted distribution.

    And by how much too many hidden frames are in no hole.
    """
    holes, crowds = holes_of(hidden, in_view), len(hidden)
    count = np.bincount(holes.crowd, minlength=crowds)
    rank = np.arange(len(holes.crowd)) - (np.cumsum(count) - count)[holes.crowd]
    wanted = np.log(wish.hole_frames) + wish.spread * ndtri((rank + chance) / count[holes.crowd])
    short = np.minimum(((np.log(holes.frames) - wanted) / LENGTH_OFF) ** 2, _AS_FAR_AS_COUNTS)
    total = np.bincount(holes.crowd, weights=short, minlength=crowds)
    dark = np.maximum((hidden & in_view).sum(axis=(1, 2)), 1)
    stray = 1 - np.bincount(holes.crowd, weights=holes.frames, minlength=crowds) / dark
    off = total / np.maximum(count, 1) + (np.maximum(stray - STRAY_BORNE, 0.0) / STRAY_OFF) ** 2
    return np.where(count > 0, off, NO_HOLE)


def _hider_off(wish: OcclusionWish, cover: Cover, hidden: np.ndarray) -> Float[np.ndarray, "crowd"]:
    """By how much others hide than were wished."""
    by_people, by_obstacles = (np.bitwise_count(cover.inside & cells) for cells in (cover.people, cover.obstacles))
    hidden = hidden & (cover.inside > 0)
    people = (hidden & (by_people > by_obstacles)).sum(axis=(1, 2)) / np.maximum(hidden.sum(axis=(1, 2)), 1)
    lacking = {
        "people": 1 - people,
        "obstacles": people,
        "both": np.maximum(_LEAST_OF_BOTH + SHARE_OFF / 2 - np.minimum(people, 1 - people), 0.0),
    }[wish.by]
    return (lacking / SHARE_OFF) ** 2
