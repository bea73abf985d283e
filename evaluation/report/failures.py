"""The failures of a solved recording, first: objects that were lost, the worst segments and links, with pictures."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from evaluation.clustering import FOUND_FROM
from evaluation.figures.stages import Solved
from evaluation.observations import BACKGROUND
from evaluation.report.images import drawn
from evaluation.report.moments import RIGHT, WRONG, Dots, Panel, draw_panels, draw_plan, motion_dots, strip
from evaluation.report.page import Card, Cards, Picture, Section, Text
from evaluation.report.worst import LinkRow, SegmentRow, unbridged_holes, worst_links, worst_segments
from evaluation.scores import Evidence
from recording.camera import PIXEL_CENTRE
from recording.motions import NOISE
from recording.palette import colour_of
from recording.visibility import HiddenRun

SHOWN = 4
"""Segments, links and holes, of each the worst."""
_MIXED_FROM = 0.01
"""Share of wrong points from which on a segment counts as a failure."""


def failures_section(case: Solved, evidence: Evidence) -> Section | None:
    """What went wrong, or the nearest to it; without truth what may be wrong, None where nothing is in doubt."""
    links = worst_links(evidence)
    if not evidence.visibility.labelled:
        return _doubts_section(case, evidence, links) if links else None
    segments, missed = worst_segments(evidence), unbridged_holes(evidence)
    mixed, wrong = [row for row in segments if _mixes(row)], [row for row in links if row.right is False]
    of_segments = [_segment_card(case, evidence, row) for row in segments[:SHOWN]]
    of_holes = [_missed_card(case, evidence, hole) for hole in missed[:SHOWN]]
    of_links = [_link_card(case, evidence, row) for row in links[:SHOWN]]
    in_order = "Worst links" if wrong else "Links, all of them right, the least sure first"
    groups = [
        (mixed, _cards("Worst segments" if mixed else "Segments, none of which mixes objects", of_segments, segments)),
        (missed, _cards("Holes that no motion bridges", of_holes, missed)),
        (wrong, _cards(in_order, of_links, links)),
    ]
    groups.sort(key=lambda group: not group[0])  # Where nothing failed comes last.
    shown = (cards for _, cards in groups if cards.items)
    return Section(
        key="failures",
        title="Failures first",
        lead="Blue dots are right, orange ones wrong; rings are completed; the black line is the true "
        "outline of the object, hidden or not; in plans the grey band is the truth.",
        blocks=(Text(words=_words(evidence, segments, links, missed)), *shown),
    )


def _doubts_section(case: Solved, evidence: Evidence, links: Sequence[LinkRow]) -> Section:
    cards = [_link_card(case, evidence, row) for row in links[:SHOWN]]
    return Section(
        key="failures",
        title="Links in doubt",
        lead="The recording holds no truth to judge by: these are the links that the solver is least sure of.",
        blocks=(_cards("The least sure first", cards, links),),
    )


def object_name(evidence: Evidence, objectid: int) -> str:
    """What an object is called."""
    names = {entry.id: entry.name for entry in evidence.recording.metadata.objects or ()}
    return "the background" if objectid == BACKGROUND else names.get(objectid, f"object {objectid}")


def frames_words(first: int, stop: int) -> str:
    """The frames from the first to the one before the last, in words."""
    return f"frame {first}" if stop == first + 1 else f"frames {first} to {stop - 1}"


def count_words(frames: int) -> str:
    """A number of frames in words."""
    return f"{frames} frame{'' if frames == 1 else 's'}"


def _percent(share: float) -> str:
    return "under 0.1 %" if 0 < share < 0.001 else f"{100 * share:.1f} %"


def _cards(words: str, shown: Sequence[Card], every: Sequence[object]) -> Cards:
    """Cards under words, with how many of all they are."""
    share = f", {len(shown)} of {len(every)}" if len(shown) < len(every) else ""
    return Cards(title=words + share, items=tuple(shown))


def _mixes(row: SegmentRow) -> bool:
    """Whether so many of its points are wrong that the segment counts as a failure."""
    return row.share > _MIXED_FROM


def _words(
    evidence: Evidence, segments: Sequence[SegmentRow], links: Sequence[LinkRow], missed: Sequence[HiddenRun]
) -> str:
    """The sum of it in a sentence."""
    ids = evidence.visibility.ids
    lost = [one for one in ids if evidence.motion_of.get(one, (0, 0.0))[1] < FOUND_FROM]
    extra = sorted(set(evidence.motions.motion_ids) - set(evidence.motion_of_object.values()))
    mixed, wrong = sum(map(_mixes, segments)), sum(row.right is False for row in links)
    if not (lost or extra or mixed or wrong or missed):
        return "No failures: every object is found, and no motion, segment, link or hole is wrong."
    names = f" ({', '.join(object_name(evidence, one) for one in lost)})" if lost else ""
    beyond = f" (motion{'s' * (len(extra) > 1)} {', '.join(map(str, extra))})" if extra else ""
    return (
        f"{len(lost)} of {len(ids)} objects not found{names}; {len(extra)} motions that stand for no object{beyond}; "
        f"{mixed} of {len(segments)} segments with more than {100 * _MIXED_FROM:.0f} % of points of other objects; "
        f"{wrong} of {len(links)} links wrong; {len(missed)} holes not bridged."
    )


def _segment_card(case: Solved, evidence: Evidence, row: SegmentRow) -> Card:
    name = object_name(evidence, row.objectid)
    words = f"{row.points} points, mostly {name}; {row.wrong} of them ({_percent(row.share)}) are not."
    if row.objectid == BACKGROUND:
        words = f"Most of its {row.points} points are of what does not move."
    elif row.wrong == 0:
        words = f"All of its {row.points} points are of {name}."
    return Card(
        title=f"Segment {row.segment}",
        words=words,
        picture=_segment_picture(case, evidence, row),
        frame=row.frame,
        bad=_mixes(row),
    )


def _segment_picture(case: Solved, evidence: Evidence, row: SegmentRow) -> Picture:
    """Its right and wrong points in the frame with most wrong ones, and the path of its motion."""
    observations, camera = evidence.observations, case.recording.camera
    own = (observations.segment == row.segment) & (observations.frame == row.frame)
    wrong = own & ((observations.objectid != row.objectid) | (row.objectid == BACKGROUND))
    at_row, at_column = np.divmod(observations.pixel % (camera.width * camera.height), camera.width)
    place = np.stack([at_column, at_row], axis=1) + PIXEL_CENTRE
    dots = (Dots(column_row=place[own & ~wrong], colour=RIGHT), Dots(column_row=place[wrong], colour=WRONG))
    outline = row.objectid if row.objectid != BACKGROUND else None

    def figure() -> Figure:
        made, axes = strip(1, 2)
        draw_panels(case, [Panel(frame=row.frame, title=f"frame {row.frame}", dots=dots, outline=outline)], axes[:1])
        draw_plan(axes[1], case, _motions_of(case, row.segment), [row.objectid])
        axes[1].set_title("path of its motion")
        return made

    alt = f"Segment {row.segment} in frame {row.frame}: its right and wrong points, and the path of its motion."
    return drawn(figure, alt=alt)


def _missed_card(case: Solved, evidence: Evidence, hole: HiddenRun) -> Card:
    name = object_name(evidence, hole.objectid)
    motion = evidence.motion_of_object.get(hole.objectid)
    return Card(
        title=f"{name}, {frames_words(hole.first, hole.stop)}",
        words=f"Hidden for {count_words(hole.frames)}; no motion that is mostly {name} holds it both before and after.",
        picture=hole_picture(case, name, motion, (hole.first, hole.stop), outline=hole.objectid),
        frame=hole.first,
        bad=True,
    )


def hole_picture(
    case: Solved, name: str, motion: int | None, run: tuple[int, int], *, outline: int | None = None
) -> Picture:
    """The frame before a hole, one in its middle, and the frame after it."""
    first, stop = run
    last = case.recording.metadata.frames - 1
    moments = {"before": max(first - 1, 0), "hidden": (first + stop - 1) // 2, "after": min(stop, last)}
    panels = [
        Panel(
            frame=frame,
            title=f"{when}: frame {frame}",
            dots=motion_dots(case, motion, frame) if motion is not None else (),
            outline=outline,
        )
        for when, frame in moments.items()
    ]

    def figure() -> Figure:
        made, axes = strip(1, 1, 1)
        draw_panels(case, panels, axes)
        return made

    said = f"motion {motion}" if motion is not None else "no motion"
    alt = f"{name} before the hole (frame {moments['before']}), hidden (frame {moments['hidden']}) and after it "
    return drawn(figure, alt=f"{alt}(frame {moments['after']}), with the points of {said}.")


def _link_card(case: Solved, evidence: Evidence, row: LinkRow) -> Card:
    motions, link = evidence.motions, row.link
    ends: list[tuple[int, int]] = []
    for segment, at in ((link.before, np.max), (link.after, np.min)):
        frames = motions.frame[motions.observed & (motions.segment == segment)]
        ends.append((segment, int(at(frames)) if len(frames) else 0))
    of_one = {True: "Right; confidence", False: "Wrong: not of one object; confidence", None: "Confidence"}
    (_, last), (_, following) = ends
    gap = count_words(max(following - last - 1, 0))
    return Card(
        title=f"Segment {link.before} to {link.after}",
        words=f"{of_one[row.right]} {link.confidence:.2f}; {gap} between them.",
        picture=_link_picture(case, evidence, row, ends),
        frame=last,
        bad=row.right is False,
    )


def _link_picture(case: Solved, evidence: Evidence, row: LinkRow, ends: Sequence[tuple[int, int]]) -> Picture:
    """The segments in the frames where the first one ends and the second one begins; between them the path."""
    motions, of = evidence.motions, _motions_of(case, row.link.before)
    colour = {True: RIGHT, False: WRONG, None: colour_of((of or [NOISE])[0])}[row.right]
    panels = []
    for segment, frame in ends:
        own = motions.observed & (motions.segment == segment) & (motions.frame == frame)
        dots = Dots(column_row=motions.column_row[own].astype(np.float64), colour=colour)
        panels.append(Panel(frame=frame, title=f"segment {segment}, frame {frame}", dots=(dots,)))

    def figure() -> Figure:
        made, axes = strip(1, 1, 1)
        draw_panels(case, panels, [axes[0], axes[2]])
        draw_plan(axes[1], case, of, evidence.visibility.ids)
        axes[1].set_title("path of the motion")
        return made

    (before, _), (after, _) = ends
    return drawn(figure, alt=f"The end of segment {before}, the path, the beginning of segment {after}.")


def _motions_of(case: Solved, segment: int) -> list[int]:
    """The motions that a segment belongs to: one, or none."""
    return [int(one) for one in np.unique(case.motions.motion[case.motions.segment == segment]) if one != NOISE]
