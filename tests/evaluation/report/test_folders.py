"""The pages of folders: a comparison, a sweep, Table 1; which is which, and what is none of them."""

import itertools
from html.parser import HTMLParser
from pathlib import Path

import pytest
from known import crossing, perfect

from evaluation.compare import compared
from evaluation.compare_tables import write_comparison
from evaluation.kept import Kept
from evaluation.report.page import Cards, Page, Table, html_of
from evaluation.report.report import report_page
from evaluation.sweeps.plan import Sweep, points_of
from evaluation.sweeps.plots import draw_curves
from evaluation.sweeps.summary import summary_of, write_summary
from evaluation.sweeps.table import write_results
from evaluation.table1 import measured_rows
from evaluation.table1_text import write_tables
from recording.errors import InputError
from recording.parquet import save_motions
from recording.store import save_recording


@pytest.fixture(scope="module")
def comparison(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two methods on two recordings."""
    folder = tmp_path_factory.mktemp("comparison")
    save_recording(crossing(), folder / "a" / "crossing")
    save_recording(crossing(lost=0.05), folder / "b" / "crossing")
    places = [folder / "a" / "crossing", folder / "b" / "crossing"]
    outcomes = compared(places, folder / "out", methods=("tracker", "gap_closing"))
    write_comparison(outcomes, folder / "out")
    return folder / "out"


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three values of one setting on two scenes, the worth of which grows with it; one result failed."""
    folder = tmp_path_factory.mktemp("sweep")
    plan = Sweep.model_validate({"name": "known", "scenes": ["wall", "forest"], "axes": {"eps1": [1.0, 2.0, 3.0]}})
    rows = []
    for point, scene in itertools.product(points_of(plan), plan.scenes):
        value = float(point.values["eps1"]) / 10
        own = {"point": point.number, "axis": point.axis, "recording": f"{scene}-1", "scene": scene, "seed": 1}
        made = {"key": f"{point.number}-{scene}", "settings.eps1": 10 * value, "worth": value, "error": 1 - value}
        rows.append({**own, "failure": None, **made})
    rows[-1] |= {"failure": "ValueError: no points", "worth": None, "error": None}
    write_results(plan, rows, folder)
    write_summary(summary_of(plan, rows), folder)
    draw_curves(plan, rows, folder / "curves.svg")
    return folder


@pytest.fixture(scope="module")
def table1(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small house under one preset."""
    folder = tmp_path_factory.mktemp("table1")
    rows = measured_rows(["house"], Kept(folder=folder, size="64x48", frames=8), ("default",))
    write_tables(rows, folder)
    return folder


class Balance(HTMLParser):
    """Fails where an element ends that did not begin last; notes what would be loaded."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note an element that begins."""
        if tag not in ("meta", "link", "img", "input"):
            self.open.append(tag)
        self.loaded += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        """Check that what ends is what began last."""
        assert self.open.pop() == tag


def sound(page: Page) -> str:
    """The page as HTML, which is balanced and loads nothing."""
    balance, text = Balance(), html_of(page)
    balance.feed(text)
    assert balance.open == []
    assert all(one.startswith(("data:", "#")) for one in balance.loaded)
    return text


def cards_of(page: Page) -> Cards:
    return next(block for block in page.sections[0].blocks + page.sections[1].blocks if isinstance(block, Cards))


def test_a_comparison_has_its_worst_outcomes_first_each_with_its_paths(comparison: Path) -> None:
    page = report_page(comparison)
    text, cards = sound(page), cards_of(page).items
    assert len(cards) == 4
    assert [card.title.split()[0] for card in cards[:2]] == ["tracker", "tracker"]  # It finds nobody here.
    assert all(card.picture is not None for card in cards)
    assert cards[0].bad
    assert "By the time hidden" in text
    assert "Settings of tracker" in text


def test_a_sweep_tells_failures_the_worst_points_and_the_best(sweep: Path) -> None:
    page = report_page(sweep)
    text = sound(page)
    assert "ValueError: no points" in text
    assert "eps1" in cards_of(page).items[0].title
    assert cards_of(page).items[0].bad
    assert "data:image/svg+xml;base64," in text
    assert len(page.sections[0].blocks) == 1


def test_table_1_has_a_picture_a_scene_and_both_numbers(table1: Path) -> None:
    page = report_page(table1)
    sound(page)
    assert [card.picture is not None for card in cards_of(page).items] == [True]
    tables = [block for section in page.sections for block in section.blocks if isinstance(block, Table)]
    assert tables[0].rows[0][:3] == ("house", "house", "30 / 8")
    assert [table.caption for table in tables] == ["The paper's number / ours", "Preset default", "Motions"]


def test_counts_alone_have_a_page(tmp_path: Path) -> None:
    rows = measured_rows(["house"], Kept(folder=tmp_path, size="64x48", frames=8), ())
    write_tables(rows, tmp_path)
    assert "nothing solved" in sound(report_page(tmp_path))


def test_a_folder_of_nothing_known_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"holds no recording\.json or comparison\.json"):
        report_page(tmp_path)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("comparison.json", "{}"),
        ("comparison.json", "[1]"),
        ("comparison.json", "{"),
        ("summary.json", "{}"),
        ("summary.json", '{"sweep": 3}'),
        ("table1.csv", "a,b\n1,2\n"),
        ("table1.csv", ""),
    ],
)
def test_a_damaged_folder_is_refused_with_its_file(name: str, content: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content, encoding="utf-8")
    (tmp_path / "comparison.csv").write_text("recording,method,failure\n", encoding="utf-8")
    with pytest.raises(InputError, match=name):
        report_page(tmp_path)


def test_a_recording_needs_motions_of_its_own(tmp_path: Path) -> None:
    save_recording(crossing(), tmp_path / "crossing")
    with pytest.raises(InputError, match="unocclude solve"):
        report_page(tmp_path / "crossing")
    save_motions(perfect(crossing(lost=0.1)), tmp_path / "other.parquet")
    with pytest.raises(InputError, match="motions of another"):
        report_page(tmp_path / "crossing", tmp_path / "other.parquet")
