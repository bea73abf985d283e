"""Steps 7 to 9 of the default: segments linked over the whole recording into motions, and these completed."""

from collections.abc import Iterable
from functools import partial

import numpy as np
from jaxtyping import Bool, Int

from algorithm.companions import companions
from algorithm.completion import completed
from algorithm.continuation import candidates
from algorithm.events import Clock, events_between, things
from algorithm.flights import flights
from algorithm.followed import Followed
from algorithm.given import Linker, Segments
from algorithm.grouping import groups
from algorithm.guidance import UNGUIDED, Guidance, joined
from algorithm.guided import guided, spans
from algorithm.linking import confidences, is_scrap, standings
from algorithm.restlessness import restless_path
from algorithm.result import Keep, Motion, Solution, made_now
from algorithm.segment_frames import SegmentFrames, segment_frames
from algorithm.settings import Settings
from algorithm.stragglers import gathered
from recording.motions import Link

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


def continued(
    followed: Followed,
    segments: Segments,
    settings: Settings,
    linker: Linker | None,
    guidance: Guidance = UNGUIDED,
    keep: Keep = made_now,
) -> Solution:
    """The motions: segments linked, stragglers gathered, and every point's places while it was hidden."""
    rows = _rows(followed, segments)
    if linker is None:
        links, alternatives = links_between(rows, followed, settings, guidance)
    else:
        pairs = linker(followed.trajectories, segments)
        links, alternatives = tuple(Link(before=a, after=b, confidence=1.0) for a, b in pairs), ()
    motion = _joined(links, rows.count)
    motion = _renumbered(
        _with_stragglers(rows.renamed(motion), settings, followed.fps, guidance.renamed(motion))[motion]
    )
    motion = _without_few(motion, segments, settings)
    rows = rows.renamed(motion)
    of_trajectory = np.append(motion, -1)[segments]  # Noise, -1, stays noise.
    motions = []
    for number, one in enumerate(rows.singles()):
        members = of_trajectory == number
        own = segments[members]
        motions.append(keep(members, own, partial(_motion, followed, own, members, one, settings)))
    return Solution(
        trajectories=followed.trajectories,
        segments=segments,
        motions=tuple(motions),
        links=links,
        alternatives=alternatives,
        events=events_between(
            things(followed.trajectories, of_trajectory), Clock(fps=followed.fps, frames=followed.frames)
        ),
    )


def links_between(
    rows: SegmentFrames, followed: Followed, settings: Settings, guidance: Guidance = UNGUIDED
) -> tuple[tuple[Link, ...], tuple[Link, ...]]:
    """The links of the likeliest assignment (step 9), and those that might stand in their place."""
    flown = guidance.allowed(flights(rows, guidance.forced_links(), fps=followed.fps), rows.count)
    known, unit, first, last = _ends(rows, _joined(flown, rows.count), settings)
    possible = candidates(known, settings, fps=followed.fps)
    standing = standings(known, followed.camera, settings, frames=followed.frames, fps=followed.fps)
    found = guided(possible, standing, guidance.renamed(unit), spans(known))
    confidence = confidences(found)
    every = [
        Link(before=int(last[before]), after=int(first[after]), confidence=float(sure), chosen=bool(chosen))
        for before, after, sure, chosen in zip(found.before, found.after, confidence, found.chosen, strict=True)
    ]
    made = (*(link for link in every if link.chosen), *flown)
    made += guidance.missing(_joined(made, rows.count))
    return made, tuple(link for link in every if not link.chosen and link.confidence >= _WORTH_KEEPING)


def _ends(
    rows: SegmentFrames, whole: Int[np.ndarray, "segment"], settings: Settings
) -> tuple[SegmentFrames, Int[np.ndarray, "segment"], Int[np.ndarray, "known"], Int[np.ndarray, "known"]]:
    """What can be linked, segments that are one flight as one; its number by segment; its first and last segment.

    The number of a scrap is -1.
    """
    whole_rows = rows.renamed(whole)
    main = np.flatnonzero(~is_scrap(whole_rows, settings))
    name = np.full(whole_rows.count, -1)
    name[main] = np.arange(len(main))
    begin = np.array([one.frame[0] for one in rows.singles()], int)
    order = np.argsort(begin, kind="stable")
    last, first = np.zeros(whole_rows.count, int), np.zeros(whole_rows.count, int)
    last[whole[order]] = order
    first[whole[order[::-1]]] = order[::-1]
    return whole_rows.renamed(name), name[whole], first[main], last[main]


def _with_stragglers(
    rows: SegmentFrames, settings: Settings, fps: float, guidance: Guidance
) -> Int[np.ndarray, "motion"]:
    """The motion that each motion belongs to."""
    into = gathered(rows, settings, fps=fps)
    shown = np.bincount(rows.segment, rows.area, minlength=rows.count).astype(float)  # Integers where nothing is.
    return guidance.kept_apart(into, shown)


def _rows(followed: Followed, segments: Segments) -> SegmentFrames:
    position = followed.camera.position
    return segment_frames(followed.trajectories, segments, followed.patches, camera_position=position)


def _motion(
    followed: Followed,
    own: Int[np.ndarray, "member"],
    members: Bool[np.ndarray, "trajectory"],
    rows: SegmentFrames,
    settings: Settings,
) -> Motion:
    curve = restless_path(rows, fps=followed.fps, calmest=settings.restlessness)
    completion = completed(
        followed.trajectories.chosen(members),
        own,
        curve,
        settings=settings,
        spacing_m=followed.spacing_m,
        fps=followed.fps,
    )
    return Motion(segments=tuple(np.unique(own).tolist()), curve=curve, members=members, completion=completion)


def _joined(links: Iterable[Link], count: int) -> Int[np.ndarray, "segment"]:
    """The motion of every segment when the links are made."""
    return joined([(link.before, link.after) for link in links], count)


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
    kept = count >= settings.fewest_trajectories
    return np.where(kept, np.cumsum(kept) - 1, -1)[motion]
