"""The page of a solved recording: one file that loads nothing, with all holes, and the worst things first."""

import gzip
import json
import re
from base64 import b64decode
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from known import FRAMES, LEFT, RIGHT, crossing, empty, masks_only, perfect

from evaluation.figures.stages import Solved
from evaluation.holes import hole_rows
from evaluation.report import cloud
from evaluation.report.cloud import display_from_world, view_of
from evaluation.report.definitions import FAMILIES, NOTHING, dotted, meaning_of
from evaluation.report.page import Card, Cards, Page, Section, Table, Text, Tiles, View, html_of, write_page
from evaluation.report.solved import solved_page
from evaluation.report.worst import unbridged_holes, worst_holes, worst_links, worst_segments
from evaluation.scores import evidence_of, scores_of
from recording.motions import Link, Motions
from recording.recording import Recording, stripped

MOST_BYTES = 3_000_000
BYTES_A_POINT = 9 * 4 / 3  # As base64, if nothing could be compressed.
MOST_BYTES_OF_ALL = 10_000_000
VOID = {"meta", "link", "img", "input"}


class Outline(HTMLParser):
    """What stands in a page: its open and closed elements, their ids, pictures, and what it would load."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.alts: list[str | None] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note an element that begins."""
        known = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if tag == "img":
            self.alts.append(known.get("alt"))
        self.ids += [value for name, value in attrs if name == "id" and value]
        self.loaded += [known[name] or "" for name in ("src", "href") if name in known]

    def handle_endtag(self, tag: str) -> None:
        """Check that what ends is what began last."""
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return perfect(recording)


@pytest.fixture(scope="module")
def page(recording: Recording, motions: Motions) -> Page:
    return solved_page(recording, motions)


def outline_of(page: Page) -> Outline:
    outline = Outline()
    outline.feed(html_of(page))
    outline.close()
    return outline


def section(page: Page, key: str) -> Section:
    return next(one for one in page.sections if one.key == key)


def cards(one: Section) -> list[Card]:
    return [card for block in one.blocks if isinstance(block, Cards) for card in block.items]


def test_a_page_is_one_file_that_loads_nothing_and_is_small(page: Page, tmp_path: Path) -> None:
    write_page(page, tmp_path / "page.html")
    outline = outline_of(page)
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    assert (tmp_path / "page.html").stat().st_size < MOST_BYTES
    assert outline.loaded
    assert all(one.startswith(("data:", "#")) for one in outline.loaded)
    text = re.sub(r"base64,[^\"]*", "", html_of(page))
    assert not re.search(r"https?://|@import|url\(", text)


def test_a_page_is_balanced_html_with_ids_of_its_own_and_words_for_each_picture(page: Page) -> None:
    outline = outline_of(page)
    assert outline.open == []
    assert len(set(outline.ids)) == len(outline.ids)
    assert outline.alts
    assert all(outline.alts)


def test_foreign_words_are_no_html() -> None:
    hostile = Page(title="<script>alert(1)</script>", subtitle="a & b", sections=())
    text = html_of(hostile)
    assert "<script>alert" not in text
    assert "&lt;script&gt;" in text
    assert "a &amp; b" in text


def test_each_hole_is_shown_once_the_largest_error_first(page: Page, recording: Recording, motions: Motions) -> None:
    evidence = evidence_of(recording, motions)
    rows = worst_holes(hole_rows(evidence))
    shown = cards(section(page, "holes"))
    assert len(rows) == len(shown) == scores_of(evidence)["holes"]
    assert [card.title.split(",")[0] for card in shown] == [row.name for row in rows]
    errors = [row.centre_mean_m for row in rows if row.centre_mean_m is not None]
    assert errors == sorted(errors, reverse=True)
    assert all(card.picture is not None for card in shown)


def test_every_score_has_a_meaning_and_is_told(page: Page, recording: Recording, motions: Motions) -> None:
    flat = dotted(scores_of(evidence_of(recording, motions)))
    timed = {key for key in flat if key.startswith("seconds.")}
    known = {key for family in FAMILIES.values() for key in family}
    assert set(flat) - timed <= known
    assert all(meaning_of(key).words for key in known)
    text = html_of(page)
    for key in set(flat) - timed:
        assert f">{meaning_of(key).text(flat[key])}</td>" in text


def test_wrong_links_come_first_the_surest_before_the_others(recording: Recording, motions: Motions) -> None:
    links = (
        Link(before=10, after=11, confidence=0.6),
        Link(before=10, after=21, confidence=0.4),
        Link(before=20, after=11, confidence=0.9),
        Link(before=20, after=21, confidence=0.3),
    )
    rows = worst_links(evidence_of(recording, replace(motions, links=links)))
    assert [(row.right, row.link.confidence) for row in rows] == [
        (False, 0.9),
        (False, 0.4),
        (True, 0.3),
        (True, 0.6),
    ]


def test_the_segment_with_most_wrong_points_comes_first(recording: Recording, motions: Motions) -> None:
    segment = motions.segment.copy()
    of_right = np.flatnonzero((motions.segment == 20) & motions.observed)
    segment[of_right[:7]] = 10
    rows = worst_segments(evidence_of(recording, replace(motions, segment=segment)))
    assert (rows[0].segment, rows[0].wrong, rows[0].objectid) == (10, 7, LEFT)
    assert [row.wrong for row in rows[1:]] == [0] * (len(rows) - 1)


def test_a_motion_cut_in_two_leaves_its_hole_unbridged(recording: Recording, motions: Motions) -> None:
    assert unbridged_holes(evidence_of(recording, motions)) == []
    motion = np.where(motions.segment == 21, 9, motions.motion).astype(np.int32)
    cut = replace(motions, motion=motion, representatives=())
    assert [hole.objectid for hole in unbridged_holes(evidence_of(recording, cut))] == [RIGHT]


def test_the_view_holds_every_layer_frame_by_frame(recording: Recording, motions: Motions) -> None:
    view = view_of(Solved(recording=recording, motions=motions))
    header = json.loads(view.header)
    columns = gzip.decompress(b64decode(view.points))
    counts = {name: starts[-1] for name, starts in header["layers"].items()}
    assert len(columns) == 9 * sum(counts.values())
    assert counts["observed"] == int(motions.observed.sum())
    assert counts["completed"] == int((~motions.observed).sum())
    assert all(len(starts) == FRAMES + 1 for starts in header["layers"].values())
    places = np.frombuffer(columns, "<u2", 3 * sum(counts.values())).reshape(-1, 3)
    restored = np.array(header["low"]) + places / 65535 * np.array(header["span"])
    rows = np.flatnonzero(motions.observed)
    rows = rows[np.argsort(motions.frame[rows], kind="stable")]
    expected = motions.position[rows] @ display_from_world(recording).T
    np.testing.assert_allclose(restored[: counts["observed"]], expected, atol=1e-3)


def test_the_view_stays_small_whatever_was_found(
    recording: Recording, motions: Motions, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = ("MOST_OBSERVED", "MOST_COMPLETED", "MOST_TRUE", "MOST_STILL")
    assert sum(getattr(cloud, name) for name in limits) * BYTES_A_POINT < MOST_BYTES_OF_ALL
    for name in limits:
        monkeypatch.setattr(cloud, name, 300)
    header = json.loads(view_of(Solved(recording=recording, motions=motions)).header)
    assert all(0 < starts[-1] <= 1.5 * 300 for starts in header["layers"].values())


def test_a_rotation_to_the_view_keeps_lengths_and_hands(recording: Recording) -> None:
    turn = display_from_world(recording)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) > 0


@pytest.mark.parametrize("what", ["masks", "depth"])
def test_a_recording_without_truth_has_a_page(what: str, recording: Recording, motions: Motions) -> None:
    bare = masks_only(recording) if what == "masks" else stripped(recording)
    page = solved_page(bare, motions)
    assert cards(section(page, "holes"))
    assert ("no truth" in html_of(page)) == (what == "depth")
    assert outline_of(page).open == []


def test_a_page_without_truth_speaks_of_none_and_has_no_empty_tile(recording: Recording, motions: Motions) -> None:
    page = solved_page(stripped(recording), motions)
    (tiles,) = section(page, "summary").blocks
    assert isinstance(tiles, Tiles)
    assert {tile.name: tile.value for tile in tiles.items}["motions"] == "2"
    assert all(tile.value != NOTHING for tile in tiles.items)
    text = html_of(page).partition("<script>")[0]  # Scripts are those of all pages.
    assert re.findall("[^.<>]*truth[^.<>]*", text) == [
        "The recording holds no truth to judge by: these are the links that the solver is least sure of",
        "The recording holds no truth: these are the numbers that need none",
    ]


def test_where_nothing_failed_the_page_says_so_first(page: Page, recording: Recording, motions: Motions) -> None:
    first = section(page, "failures").blocks[0]
    assert isinstance(first, Text)
    assert first.words.startswith("No failures: ")
    links = (Link(before=10, after=21, confidence=0.4),)
    wrong = section(solved_page(recording, replace(motions, links=links)), "failures")
    assert "1 of 1 links wrong" in html_of(Page(title="", subtitle="", sections=(wrong,)))
    titles = [block.title for block in wrong.blocks if isinstance(block, Cards)]
    assert titles == ["Worst links", "Segments, none of which mixes objects"]


def test_nothing_found_has_a_page_that_says_why(recording: Recording) -> None:
    page = solved_page(recording, empty())
    assert "2 of 2 objects not found" in html_of(page)
    assert "No motions: what moves is too small" in html_of(page)


def test_settings_that_differ_from_the_presets_are_told(recording: Recording, motions: Motions) -> None:
    making = replace(motions.making, settings={"preset": "default", "eps1": 1.25})
    page = solved_page(recording, replace(motions, making=making))
    tables = [block for block in section(page, "making").blocks if isinstance(block, Table)]
    assert tables[-1].rows[0][:3] == ("eps1", "1.25", "1.5")


def test_a_page_with_a_view_has_its_script_and_one_without_has_none(page: Page) -> None:
    assert any(isinstance(block, View) for block in section(page, "scene").blocks)
    assert "class Drawing" in html_of(page)
    assert "<script" not in html_of(Page(title="a", subtitle="b", sections=()))
