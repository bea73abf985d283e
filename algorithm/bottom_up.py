"""Completion in the paper's order, bottom-up: within each segment (step 8), across segments (step 9), then every point.

What it completes lies where the fitted curves say, jumps included; nothing is added to what the paper does.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from algorithm.completion import Completion
from algorithm.given import Linker, Segments
from algorithm.inter import Polynomial, chains, joined_by_polynomials, merged_curve, polynomial_links
from algorithm.intra import aligned, bridged, joined
from algorithm.representative import Curve, representative
from algorithm.result import Motion, Solution
from algorithm.settings import Settings
from algorithm.trajectories import Trajectories
from recording.motions import INTER, INTRA, Link


@dataclass(frozen=True, kw_only=True)
class Reach:
    """How far joins of trajectories may reach."""

    gate_m: float
    """Metres: a costlier pair of trajectories is not joined."""
    longest_frames: float
    """Frames: nor is one farther apart."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Tracks:
    """Trajectories some of which were joined, the gaps between them filled."""

    trajectories: Trajectories
    first: Int[np.ndarray, "_track"]
    """The number, before any was joined, of the trajectory that each begins with."""
    last: Int[np.ndarray, "_track"]
    """The number of the one that it ends with."""
    segment: Int[np.ndarray, "_track"]


def completed_bottom_up(
    trajectories: Trajectories,
    segments: Segments,
    settings: Settings,
    reach: Reach,
    linker: Linker | None = None,
) -> Solution:
    """The motions, and every point's places while it was hidden (paper, section 4, Motion completion).

    In each segment the trajectories are joined and filled along its representative, which is then made anew
    of the filled ones. The representatives are linked by polynomials, or as the `linker` says, and merged
    with them. The segments of a motion count as one from then on: its filled trajectories are joined and
    filled once more, along its completed representative.
    """
    tracks, parts, curves = [], [], []
    for segment in range(int(segments.max(initial=-1)) + 1):
        seen = _tracks(trajectories, segments, segments == segment)
        curve = representative(seen.trajectories)
        filled, within = _filled(seen, curve, settings, reach)
        tracks.append(filled)
        parts.append(within)
        curves.append(replace(representative(filled.trajectories), points=curve.points))
    if linker is None:
        links = polynomial_links(curves, eps6_m=settings.eps6)
    else:
        links = joined_by_polynomials(curves, linker(trajectories, segments), eps6_m=settings.eps6)
    motions = []
    for chain in chains(links, len(curves)):
        curve = merged_curve([curves[segment] for segment in chain], [links[pair] for pair in pairwise(chain)])
        places = [parts[segment] for segment in chain]
        if len(chain) > 1:
            places.append(_filled(_together([tracks[segment] for segment in chain]), curve, settings, reach)[1])
        members = np.isin(segments, chain)
        completion = _of_members(places, members)
        motions.append(Motion(segments=tuple(chain), curve=curve, members=members, completion=completion))
    return Solution(trajectories=trajectories, segments=segments, motions=tuple(motions), links=_told(links, settings))


def _told(links: Mapping[tuple[int, int], Polynomial], settings: Settings) -> tuple[Link, ...]:
    """The links, each with 1 less its error's share of epsilon 6 as its confidence (not calibrated)."""
    return tuple(
        Link(before=before, after=after, confidence=float(np.clip(1.0 - polynomial.error_m / settings.eps6, 0.0, 1.0)))
        for (before, after), polynomial in sorted(links.items())
    )


def _filled(tracks: _Tracks, curve: Curve, settings: Settings, reach: Reach) -> tuple[_Tracks, Completion]:
    """The tracks joined and filled along the curve, and what this adds, in the numbers of all trajectories.

    A missing place lies where the curve, laid on the track that ends, has it.
    """
    own = tracks.trajectories
    alignment = aligned(own, curve, method=settings.alignment)
    joins = joined(own, curve, alignment, gate_m=reach.gate_m, longest_frames=reach.longest_frames)
    before, after, cost = joins
    join, frame, _ = bridged(own, curve, alignment, joins)
    position = alignment.extended(before[join], curve.position[frame - curve.first])
    added = Completion(
        trajectory=tracks.last[before][join],
        frame=frame,
        position=position,
        source=np.where(tracks.segment[before] == tracks.segment[after], INTRA, INTER)[join],
        confidence=1.0 - cost[join] / reach.gate_m,
        joins=(tracks.last[before], tracks.first[after]),
    )
    graph = sparse.coo_array((np.ones(len(before)), (before, after)), shape=(own.count, own.count))
    count, track = connected_components(graph, directed=False)
    number = np.concatenate([track[own.trajectory], track[before[join]]])
    frame = np.concatenate([own.frame, frame])
    order = np.lexsort((frame, number))
    filled = Trajectories(
        trajectory=number[order],
        frame=frame[order],
        position=np.concatenate([own.position, position])[order],
        column_row=np.concatenate([own.column_row, np.full((len(join), 2), np.nan)])[order],
    )
    first, last, segment = np.zeros((3, count), int)
    begins, ends = np.delete(np.arange(own.count), after), np.delete(np.arange(own.count), before)
    first[track[begins]], segment[track[begins]] = tracks.first[begins], tracks.segment[begins]
    last[track[ends]] = tracks.last[ends]
    return _Tracks(trajectories=filled, first=first, last=last, segment=segment), added


def _tracks(trajectories: Trajectories, segments: Segments, which: Bool[np.ndarray, "trajectory"]) -> _Tracks:
    """The chosen trajectories, none of them joined."""
    number = np.flatnonzero(which)
    return _Tracks(trajectories=trajectories.chosen(which), first=number, last=number, segment=segments[number])


def _together(parts: list[_Tracks]) -> _Tracks:
    """The tracks of several segments."""
    before = np.cumsum([0, *(part.trajectories.count for part in parts)])
    return _Tracks(
        trajectories=Trajectories(
            trajectory=np.concatenate(
                [part.trajectories.trajectory + start for part, start in zip(parts, before[:-1], strict=True)]
            ),
            frame=np.concatenate([part.trajectories.frame for part in parts]),
            position=np.concatenate([part.trajectories.position for part in parts]),
            column_row=np.concatenate([part.trajectories.column_row for part in parts]),
        ),
        first=np.concatenate([part.first for part in parts]),
        last=np.concatenate([part.last for part in parts]),
        segment=np.concatenate([part.segment for part in parts]),
    )


def _of_members(parts: list[Completion], members: Bool[np.ndarray, "trajectory"]) -> Completion:
    """All that was added to a motion, in the numbers of its members."""
    number = np.cumsum(members) - 1
    return Completion(
        trajectory=number[np.concatenate([part.trajectory for part in parts])],
        frame=np.concatenate([part.frame for part in parts]),
        position=np.concatenate([part.position for part in parts]),
        source=np.concatenate([part.source for part in parts]),
        confidence=np.concatenate([part.confidence for part in parts]),
        joins=(
            number[np.concatenate([part.joins[0] for part in parts])],
            number[np.concatenate([part.joins[1] for part in parts])],
        ),
    )
