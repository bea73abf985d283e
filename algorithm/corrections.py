"""Corrections by hand, brought to the segments at hand: which of them each mark names, and what is said of those."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from algorithm.followed import Followed
from algorithm.given import Given, Segments
from algorithm.guidance import Guidance, joined
from algorithm.parting import parted
from algorithm.settings import Settings
from recording.corrections import Anchor, Correction, CorrectionKind, Corrections
from recording.errors import InputError

_NEAR_SHARE = 0.02
"""Of the picture's width: a point that is farther away than this is not the one that was marked."""
_Marks = Int[np.ndarray, "correction 2"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Corrected:
    """The segments as corrections have them, and what these say of them."""

    segments: Segments
    guidance: Guidance


def check_corrections(corrections: Corrections | None, recording_digest: str, settings: Settings, given: Given) -> None:
    """Refuse corrections that are of another recording, or that nothing would respect."""
    if corrections is None:
        return
    corrections.check_belongs(recording_digest)
    if settings.completing != "continuation" or given.links is not None:
        raise InputError(
            "corrections: expected completing = 'continuation', as in the preset default, and no given links, got "
            f"{settings.completing!r}{' with given ones' if given.links else ''}: solve without corrections"
        )


def corrected(followed: Followed, segments: Segments, settings: Settings, corrections: Corrections) -> Corrected:
    """What corrections say of the segments; one that holds points which are different is parted between them.

    A mark names the segment of the followed point that is nearest to it in its frame.
    """
    every = corrections.correction
    row = np.array(
        [[_row(followed, segments, mark) for mark in _named(each, index)] for index, each in enumerate(every)]
    )
    row = row.reshape(-1, 2).astype(int)
    mended = _with_parted(followed, segments, settings, every, row)
    named = mended[followed.trajectories.trajectory[row]]
    _check(every, named, followed, mended)
    pairs = {kind: _pairs(every, named, kind) for kind in ("same", "different", "forbid", "force")}
    return Corrected(segments=mended, guidance=Guidance(**pairs))


def _pairs(every: tuple[Correction, ...], named: _Marks, kind: CorrectionKind) -> tuple[tuple[int, int], ...]:
    """The pairs of segments of which this is said; what is one segment is the same already."""
    chosen = [pair for each, pair in zip(every, named.tolist(), strict=True) if each.kind == kind]
    return tuple((a, b) for a, b in chosen if a != b)


def _named(correction: Correction, index: int) -> tuple[tuple[Anchor, str], tuple[Anchor, str]]:
    """Both marks, and how an error calls them."""
    name = f"{_name(correction, index)}: {{}}"
    return (correction.one, name.format("one")), (correction.other, name.format("other"))


def _name(correction: Correction, index: int) -> str:
    return f"correction {index + 1} ({correction.kind})"


def _row(followed: Followed, segments: Segments, mark: tuple[Anchor, str]) -> int:
    """The row of the point nearest to the mark, among those of segments."""
    anchor, name = mark
    trajectories = followed.trajectories
    rows = np.flatnonzero(trajectories.frame == anchor.frame)
    rows = rows[segments[trajectories.trajectory[rows]] >= 0]
    away = np.linalg.norm(trajectories.column_row[rows] - (anchor.column, anchor.row), axis=1)
    reach = _NEAR_SHARE * followed.camera.width
    if not away.min(initial=np.inf) <= reach:
        raise InputError(
            f"{name}: expected a point of a segment within {reach:.1f} pixels of column {anchor.column:g}, row "
            f"{anchor.row:g} of frame {anchor.frame}, but nothing that moves is followed there: mark another point"
        )
    return int(rows[np.argmin(away)])


def _with_parted(
    followed: Followed, segments: Segments, settings: Settings, every: tuple[Correction, ...], row: _Marks
) -> Segments:
    """The segments, those parted that hold points which are different; the first part keeps the number."""
    trajectories = followed.trajectories
    of_mark = segments[trajectories.trajectory[row]]
    within = of_mark[:, 0] == of_mark[:, 1]
    mended, count = segments.copy(), int(segments.max(initial=-1)) + 1
    said = np.array([each.kind for each in every], str)
    for segment in np.unique(of_mark[within & (said == "different"), 0]).tolist():
        here = np.flatnonzero(within & (of_mark[:, 0] == segment))
        marks, label = _labels(every, row, here, trajectories.trajectory)
        which = segments == segment
        own_rows = np.flatnonzero(which[trajectories.trajectory])
        part = parted(trajectories.chosen(which), np.searchsorted(own_rows, marks), label, settings, fps=followed.fps)
        mended[which] = np.where(part == 0, segment, count + part - 1)
        count += int(part.max())
    return mended


def _labels(
    every: tuple[Correction, ...], row: _Marks, here: Int[np.ndarray, "_"], trajectory: Int[np.ndarray, "observation"]
) -> tuple[Int[np.ndarray, "mark"], Int[np.ndarray, "mark"]]:
    """The rows that are marked in one segment, and to which of its objects, from 0, each belongs.

    That is the first one from which nothing says that it is different.
    """
    marks = np.unique(row[here])
    number = np.searchsorted(marks, row[here])
    bound = [pair for index, pair in zip(here.tolist(), number.tolist(), strict=True) if every[index].kind == "same"]
    track = np.unique(trajectory[marks], return_inverse=True)[1]
    bound += [(int(np.flatnonzero(track == each)[0]), mark) for mark, each in enumerate(track.tolist())]
    group = joined(bound, len(marks))
    unlike: dict[int, set[int]] = {each: set() for each in range(int(group.max()) + 1)}
    for index, (a, b) in zip(here.tolist(), group[number].tolist(), strict=True):
        if every[index].kind != "different":
            continue
        if a == b:
            raise InputError(
                f"{_name(every[index], index)}: expected points of two objects, but they are one trajectory, or "
                "'same' joins them: take one of the corrections back"
            )
        unlike[a].add(b)
        unlike[b].add(a)
    label: dict[int, int] = {}
    for each, others in unlike.items():
        label[each] = min(set(range(len(unlike))) - {label.get(other, -1) for other in others})
    return marks, np.array([label[each] for each in group.tolist()])


def _check(every: tuple[Correction, ...], named: _Marks, followed: Followed, segments: Segments) -> None:
    """Refuse what cannot be respected, whatever the links are."""
    begin = _first_frames(followed, segments)
    group = joined([*_pairs(every, named, "same"), *_pairs(every, named, "force")], len(begin))
    forced = set(_pairs(every, named, "force"))
    for index, (each, (a, b)) in enumerate(zip(every, named.tolist(), strict=True)):
        name = _name(each, index)
        if each.kind == "different" and group[a] == group[b]:
            raise InputError(
                f"{name}: expected segments that nothing joins, but 'same' or 'force' join {a} and {b}: "
                "take one of the corrections back"
            )
        if each.kind == "forbid" and a == b:
            raise InputError(f"{name}: expected two segments, got {a} twice: to part it, mark two points 'different'")
        if each.kind == "forbid" and (a, b) in forced:
            raise InputError(f"{name}: the link from {a} to {b} is forced as well: take one of the corrections back")
        if each.kind in ("force", "forbid") and begin[a] > begin[b]:
            raise InputError(
                f"{name}: expected the first segment to begin before the second, got {a} from frame {begin[a]} and {b} "
                f"from frame {begin[b]}: exchange them"
            )


def _first_frames(followed: Followed, segments: Segments) -> Int[np.ndarray, "segment"]:
    begin = np.full(int(segments.max(initial=-1)) + 1, followed.frames)
    known = segments >= 0
    np.minimum.at(begin, segments[known], followed.trajectories.first_frame[known])
    return begin
