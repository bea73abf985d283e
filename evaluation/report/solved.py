"""The page of a solved recording."""

from evaluation.figures.stages import Solved
from evaluation.holes import hole_rows
from evaluation.report.cloud import view_of
from evaluation.report.definitions import FAMILIES, HEADLINES, dotted, meaning_of
from evaluation.report.failures import failures_section
from evaluation.report.gaps import error_section, holes_section
from evaluation.report.making import making_section, seconds_section
from evaluation.report.page import Fold, Page, Section, Table, Tile, Tiles
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
        Section(key="summary", title="Summary", blocks=(_headlines(found),)),
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
    """All scores with their meaning, the most telling family first."""
    flat = dotted(scores)
    tables = tuple(
        Table(
            caption=title,
            head=("score", "value", "meaning"),
            rows=tuple((one.name, one.text(flat.get(key)), one.words) for key, one in family.items()),
            words=frozenset({2}),
        )
        for title, family in FAMILIES.items()
    )
    first, *others = tables[1:], tables[0]
    return Section(
        key="scores",
        title="Scores and what they mean",
        lead="A number that cannot be computed is told by a dash. Purity alone is worth nothing: read it beside "
        "inverse purity and coverage; an error is worth nothing without its recall.",
        blocks=(*first, *(Fold(title=other.caption, blocks=(other,)) for other in others)),
    )


def _headlines(scores: Scores) -> Tiles:
    flat = dotted(scores)
    tiles = []
    for key in HEADLINES:
        meaning, value = meaning_of(key), flat.get(key)
        text = meaning.text(value)
        objects = flat.get("objects")
        if key == "motions.found" and value is not None:
            text = f"{value} of {objects}"
        whole = objects if key == "motions.found" else 1.0
        bad = value is not None and key in _BAD_BELOW and value < _BAD_BELOW[key] * (whole or 0)
        tiles.append(Tile(name=meaning.name, value=text, bad=bad))
    tiles.append(Tile(name="holes", value=meaning_of("holes").text(flat["holes"]), note=_longest(flat)))
    return Tiles(items=tuple(tiles))


def _longest(flat: Scores) -> str:
    longest = flat.get("longest_hole_frames")
    return f"the longest {longest} frames" if longest else ""
