"""The page of a solved recording."""

import math

from evaluation.figures.stages import Solved
from evaluation.holes import hole_rows
from evaluation.remarks import why_no_motions
from evaluation.report.cloud import view_of
from evaluation.report.definitions import FAMILIES, HEADLINES, HEADLINES_WITHOUT_TRUTH, dotted, meaning_of
from evaluation.report.failures import failures_section
from evaluation.report.gaps import error_section, holes_section
from evaluation.report.making import making_section, seconds_section
from evaluation.report.page import Block, Fold, Page, Section, Table, Text, Tile, Tiles
from evaluation.report.stages import stages_section
from evaluation.scores import Scores, evidence_of, scores_of
from recording.motions import Motions
from recording.recording import Recording

_BAD_BELOW = {"motions.found": 1.0, "coverage": 0.9, "identity.idf1": 0.95, "completion.recall": 0.9}
"""Shares below which a headline stands for a failure; of the number of objects, what was found."""


def solved_page(recording: Recording, motions: Motions) -> Page:
    """What was run, how good it is and how it looks, the failures before all else."""
    case = Solved(recording=recording, motions=motions)
    evidence = evidence_of(recording, motions)
    found = scores_of(evidence)
    rows = hole_rows(evidence) if recording.xray is not None and recording.metadata.objects is not None else []
    sections = (
        _summary_section(case, found),
        failures_section(case, evidence),
        Section(key="scene", title="The scene in 3D", blocks=(view_of(case),)),
        holes_section(case, evidence, rows),
        error_section(case, rows),
        stages_section(case),
        scores_section(found),
        seconds_section(motions.making),
        making_section(recording, motions.making),
    )
    known = recording.metadata
    name = known.name or "a recording"
    return Page(
        title=f"{name}: motions and what was hidden",
        subtitle=f"{known.frames} frames, {known.width} x {known.height} pixels, {known.fps:g} frames a second"
        + ("" if known.seed is None else f", seed {known.seed}"),
        sections=tuple(section for section in sections if section is not None),
    )


def scores_section(scores: Scores) -> Section:
    """All scores with their meaning, the most telling family first; without truth those that need none."""
    flat = dotted(scores)
    known = {key for key, value in flat.items() if value is not None or _has_truth(scores)}
    tables = [
        Table(
            caption=title,
            head=("score", "value", "meaning"),
            rows=tuple((one.name, one.text(flat.get(key)), one.words) for key, one in family.items() if key in known),
            words=frozenset({2}),
        )
        for title, family in FAMILIES.items()
    ]
    first, *others = [table for table in (*tables[1:], tables[0]) if table.rows]
    return Section(
        key="scores",
        title="Scores and what they mean",
        lead="A number that cannot be computed is told by a dash. Purity alone is worth nothing: read it beside "
        "inverse purity and coverage; an error is worth nothing without its recall."
        if _has_truth(scores)
        else "The recording holds no truth: these are the numbers that need none.",
        blocks=(first, *(Fold(title=other.caption, blocks=(other,)) for other in others)),
    )


def _has_truth(scores: Scores) -> bool:
    return scores["objects"] is not None


def _summary_section(case: Solved, scores: Scores) -> Section:
    tiles = Tiles(items=tuple(_headlines(scores) if _has_truth(scores) else _bare_headlines(case, scores)))
    blocks: list[Block] = [tiles]
    if not case.motions.motion_ids:
        blocks.append(Text(words=f"No motions: {why_no_motions(case.recording, case.motions)}."))
    return Section(key="summary", title="Summary", blocks=tuple(blocks))


def _headlines(scores: Scores) -> list[Tile]:
    """Numbers that the truth gives; none that cannot be computed, as where nothing is hidden."""
    flat = dotted(scores)
    tiles = []
    for key in HEADLINES:
        meaning, value = meaning_of(key), flat.get(key)
        if value is None:
            continue
        text, whole = meaning.text(value), 1.0
        if key == "motions.found":
            text, whole = f"{value} of {flat['objects']}", flat["objects"]
        tiles.append(Tile(name=meaning.name, value=text, bad=value < _BAD_BELOW.get(key, -math.inf) * whole))
    if flat["holes"] is not None:
        tiles.append(Tile(name="holes", value=meaning_of("holes").text(flat["holes"]), note=_longest(flat)))
    return tiles


def _bare_headlines(case: Solved, scores: Scores) -> list[Tile]:
    """What was found, where nothing says how good it is."""
    flat, motions = dotted(scores), case.motions
    tiles = [Tile(name=meaning_of(key).name, value=meaning_of(key).text(flat[key])) for key in HEADLINES_WITHOUT_TRUTH]
    tiles.append(Tile(name="links", value=str(len(motions.links))))
    if len(motions):
        tiles.append(Tile(name="points completed", value=f"{100 * float((~motions.observed).mean()):.0f} %"))
    return tiles


def _longest(flat: Scores) -> str:
    longest = flat.get("longest_hole_frames")
    return f"the longest {longest} frames" if longest else ""
