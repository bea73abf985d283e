"""Steps 7 to 9 of the default: segments linked over the whole recording into motions, and these completed."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from algorithm.companions import companions
from algorithm.completion import completed
from algorithm.continuation import candidates
from algorithm.events import Clock, events_between, things
from algorithm.flights import flights
from algorithm.followed import Followed
from algorithm.given import Linker, Segments
from algorithm.grouping import groups
from algorithm.linking import confidences, is_scrap, linked, standings
from algorithm.restlessness import restless_path
from algorithm.result import Motion, Solution
from algorithm.segment_frames import SegmentFrames, segment_frames
from algorithm.settings import Settings
from algorithm.stragglers import gathered
from recording.motions import Link

Pairs = Sequence[tuple[int, int]]
_WORTH_KEEPING = 0.02
"""A link that was not made is told of from this confidence on."""


def common_fates(followed: Followed, settings: Settings) -> Segments:
    """The segment of every trajectory (steps 5 and 6): what keeps together, what goes beside it, and its scraps."""
    segment = groups(followed.trajectories, settings, fps=followed.fps)
    if not len(segment):
        return segment
    rows = _rows(followed, segment)
    body = companions(rows, settings, fps=followed.fps)
    body = _renumbered(gathered(rows.renamed(body), settings, fps=followed.fps)[body])
    return body[segment]


def continued(followed: Followed, segments: Segments, settings: Settings, linker: Linker | None) -> Solution:
    """The motions: segments linked, stragglers gathered, and every point's places while it was hidden."""
    rows = _rows(followed, segments)
    if linker is None:
        links, alternatives = links_between(rows, followed, settings)
    else:
        pairs = linker(followed.trajectories, segments)
        links, alternatives = tuple(Link(before=a, after=b, confidence=1.0) for a, b in pairs), ()
    motion = _joined([(link.before, link.after) for link in links], rows.count)
    motion = _renumbered(gathered(rows.renamed(motion), settings, fps=followed.fps)[motion])
    motion = _without_few(motion, segments, settings)
    rows = rows.renamed(motion)
    of_trajectory = np.append(motion, -1)[segments]  # Noise, -1, stays noise.
    motions = tuple(
        _motion(followed, segments, of_trajectory == number, one, settings) for number, one in enumerate(rows.singles())
    )
    return Solution(
        trajectories=followed.trajectories,
        segments=segments,
        motions=motions,
        links=links,
        alternatives=alternatives,
        events=events_between(
            things(followed.trajectories, of_trajectory), Clock(fps=followed.fps, frames=followed.frames)
        ),
    )


def links_between(
    rows: SegmentFrames, followed: Followed, settings: Settings
) -> tuple[tuple[Link, ...], tuple[Link, ...]]:
    """The links of the likeliest assignment (step 9), and those that might stand in their place."""
    flown = flights(rows, (), fps=followed.fps)
    whole = _joined([(link.before, link.after) for link in flown], rows.count)
    known, first, last = _ends(rows, whole, settings)
    possible = candidates(known, settings, fps=followed.fps)
    standing = standings(known, followed.camera, settings, frames=followed.frames, fps=followed.fps)
    found = linked(possible, standing)
    confidence = confidences(found)
    every = [
        Link(before=int(last[before]), after=int(first[after]), confidence=float(sure), chosen=bool(chosen))
        for before, after, sure, chosen in zip(found.before, found.after, confidence, found.chosen, strict=True)
    ]
    made = tuple(link for link in every if link.chosen)
    return (*made, *flown), tuple(link for link in every if not link.chosen and link.confidence >= _WORTH_KEEPING)


def _ends(
    rows: SegmentFrames, whole: Int[np.ndarray, "segment"], settings: Settings
) -> tuple[SegmentFrames, Int[np.ndarray, "known"], Int[np.ndarray, "known"]]:
    """What can be linked, the segments that are one flight as one; and the first and the last segment of each."""
    whole_rows = rows.renamed(whole)
    main = np.flatnonzero(~is_scrap(whole_rows, settings))
    name = np.full(whole_rows.count, -1)
    name[main] = np.arange(len(main))
    begin = np.array([one.frame[0] for one in rows.singles()], int)
    order = np.argsort(begin, kind="stable")
    last, first = np.zeros(whole_rows.count, int), np.zeros(whole_rows.count, int)
    last[whole[order]] = order
    first[whole[order[::-1]]] = order[::-1]
    return whole_rows.renamed(name), first[main], last[main]


def _rows(followed: Followed, segments: Segments) -> SegmentFrames:
    position = followed.camera.position
    return segment_frames(followed.trajectories, segments, followed.patches, camera_position=position)


def _motion(
    followed: Followed,
    segments: Segments,
    members: Bool[np.ndarray, "trajectory"],
    rows: SegmentFrames,
    settings: Settings,
) -> Motion:
    curve = restless_path(rows, fps=followed.fps, calmest=settings.restlessness)
    own = segments[members]
    completion = completed(
        followed.trajectories.chosen(members),
        own,
        curve,
        settings=settings,
        spacing_m=followed.spacing_m,
        fps=followed.fps,
    )
    return Motion(segments=tuple(np.unique(own).tolist()), curve=curve, members=members, completion=completion)


def _joined(pairs: Pairs, count: int) -> Int[np.ndarray, "segment"]:
    """The motion of every segment when the pairs are joined."""
    before, after = np.array(pairs, int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(before)), (before, after)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], int) if count else np.zeros(0, int)


def _renumbered(names: Int[np.ndarray, "segment"]) -> Int[np.ndarray, "segment"]:
    """The names counted from 0."""
    return np.unique(names, return_inverse=True)[1] if len(names) else names


def _without_few(
    motion: Int[np.ndarray, "segment"], segments: Segments, settings: Settings
) -> Int[np.ndarray, "segment"]:
    """The motions numbered anew, -1 for such of fewer than epsilon 4 trajectories: they are noise."""
    if not len(motion):
        return motion
    count = np.bincount(motion[segments[segments >= 0]], minlength=int(motion.max()) + 1)
    kept = count >= settings.eps4
    return np.where(kept, np.cumsum(kept) - 1, -1)[motion]
