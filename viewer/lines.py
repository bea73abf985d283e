"""Curves as line segments: representatives, paths of segments, holes, links."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Float32, Int, UInt8

from recording.motions import NOISE, Link, Motions, Representative, mean_places
from recording.palette import rgb, rgb_of
from recording.visibility import Visibility, holes
from viewer.colours import pale

HOLE, CHOSEN, OTHER = "#555555", "#009E73", "#D55E00"
"""Colours of true paths through holes, of links that were made, and of those that might have been."""
_DASH = 2
"""Frames that a dash lasts, and the gap after it."""
_DASHES = 9
"""Dashes of a line between two places, gaps between them included."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Lines:
    """Line segments, each of one colour."""

    ends: Float32[np.ndarray, "line 2 3"]
    """World axes, metres."""
    colours: UInt8[np.ndarray, "line 3"]

    def __len__(self) -> int:
        return len(self.ends)

    @staticmethod
    def of(parts: Iterable["Lines"]) -> "Lines":
        """All of them."""
        every = [NO_LINES, *parts]
        return Lines(
            ends=np.concatenate([part.ends for part in every]), colours=np.concatenate([part.colours for part in every])
        )


NO_LINES = Lines(ends=np.zeros((0, 2, 3), np.float32), colours=np.zeros((0, 3), np.uint8))


def curve_lines(curves: Sequence[Representative], picked: int | None) -> Lines:
    """The representatives: full where they were observed, dashed where they were completed."""
    return Lines.of(_motion_path(curve, picked) for curve in curves)


def segment_places(motions: Motions) -> tuple[Representative, ...]:
    """The mean of every segment's observed points in each frame; the segment stands for the motion."""
    seen = motions.rows(motions.observed & (motions.segment != NOISE))
    return mean_places(replace(seen, motion=seen.segment))


def segment_lines(places: Sequence[Representative]) -> Lines:
    """The paths of segments."""
    return Lines.of(_path(place, np.ones(len(place.frame), bool), _colour(place.motion)) for place in places)


def hole_lines(visibility: Visibility | None, curves: Sequence[Representative]) -> Lines:
    """Where objects really went while they were hidden; where nobody knows, the completed parts of the curves."""
    if visibility is None or visibility.centre is None:
        return Lines.of(_path(curve, ~curve.observed, rgb(HOLE)) for curve in curves)
    centres = dict(zip(visibility.ids, visibility.centre, strict=True))
    return Lines.of(
        _joined(centres[hole.objectid][hole.first - 1 : hole.stop + 1], rgb(HOLE)) for hole in holes(visibility) or ()
    )


def links_of(motions: Motions, motion: int) -> list[Link]:
    """The links from or to a segment of the motion, made or not, the surest first."""
    segments = set(np.unique(motions.segment[(motions.motion == motion) & motions.observed]).tolist()) - {NOISE}
    every = [link for link in (*motions.links, *motions.alternatives) if segments & {link.before, link.after}]
    return sorted(every, key=lambda link: -link.confidence)


def link_lines(links: Sequence[Link], places: Sequence[Representative]) -> Lines:
    """From the last place of one segment to the first of the other: dashed where the link was not made."""
    place = {each.motion: each for each in places}
    known = [link for link in links if link.before in place and link.after in place]
    return Lines.of(
        _straight(place[link.before].position[-1], place[link.after].position[0], link.chosen) for link in known
    )


def shade(motion: int, picked: int | None) -> UInt8[np.ndarray, "3"]:
    """A motion's colour, pale where another one is picked."""
    return pale(_colour(motion)[None], np.array([picked not in (None, motion)]))[0]


def presence(curves: Sequence[Representative], frames: int) -> Int[np.ndarray, "curve frame"]:
    """Whether each curve is absent (0), completed (1) or observed (2) in each frame."""
    table = np.zeros((len(curves), frames), int)
    for number, curve in enumerate(curves):
        table[number, curve.frame] = 1 + curve.observed
    return table


def _motion_path(curve: Representative, picked: int | None) -> Lines:
    shown = curve.observed | (curve.frame // _DASH % 2 == 0)
    return _path(curve, shown, shade(curve.motion, picked))


def _path(place: Representative, shown: Bool[np.ndarray, "moment"], colour: UInt8[np.ndarray, "3"]) -> Lines:
    """The steps from each place that is shown to the one in the next frame."""
    step = np.flatnonzero(shown[:-1] & (np.diff(place.frame) == 1))
    return _lines(np.stack([place.position[step], place.position[step + 1]], axis=1), colour)


def _joined(places: Float[np.ndarray, "moment 3"], colour: UInt8[np.ndarray, "3"]) -> Lines:
    return _lines(np.stack([places[:-1], places[1:]], axis=1), colour)


def _straight(begin: Float[np.ndarray, "3"], end: Float[np.ndarray, "3"], chosen: bool) -> Lines:
    share = np.linspace(0, 1, 2 if chosen else 2 * _DASHES)[:, None]
    places = (1 - share) * begin + share * end
    return _lines(places.reshape(-1, 2, 3), rgb(CHOSEN if chosen else OTHER))


def _lines(ends: Float[np.ndarray, "line 2 3"], colour: UInt8[np.ndarray, "3"]) -> Lines:
    return Lines(ends=ends.astype(np.float32), colours=np.tile(colour, (len(ends), 1)))


def _colour(number: int) -> UInt8[np.ndarray, "3"]:
    return rgb_of(np.array([number]))[0]
