"""The paper's figures: each is drawn from any recording, whatever was found in it, as PNG and SVG."""

from pathlib import Path
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
from matplotlib.figure import Figure
from small_scenes import CROSSING

from algorithm.pipeline import solve
from algorithm.settings import Settings, preset_settings
from evaluation.figures.catalogue import FIGURES, chosen_figures, draw_figures, figure_paths
from evaluation.figures.panels import ELEVATION, PLAN, moments_of, plane_of
from evaluation.figures.stages import Solved
from evaluation.figures.style import styled, write_figure
from evaluation.figures.views import front_view, raised_view
from evaluation.kept import Kept
from recording.errors import InputError
from recording.recording import Recording
from simulator.scene import Scene, load_scene
from simulator.simulate import simulate


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """Two people cross behind a small wall."""
    path = tmp_path_factory.mktemp("scene") / "small.toml"
    path.write_text(CROSSING, encoding="utf-8")
    scene = load_scene(path)
    assert isinstance(scene, Scene)
    return simulate(scene)


@pytest.fixture(scope="module")
def solved(recording: Recording) -> Solved:
    """The same, with what was found in it."""
    return Solved(recording=recording, motions=solve(recording, Settings(eps4=5)))


@pytest.fixture(scope="module")
def empty(recording: Recording) -> Solved:
    """The same, in which nothing was found."""
    return Solved(recording=recording, motions=solve(recording, Settings(clustering="graph_merging", eps4=1e6)))


def drawn(number: str, case: Solved, folder: Path) -> list[Path]:
    entry = FIGURES[number]
    paths = figure_paths([number], folder)
    with styled():
        figure = entry.draw([case] * len(entry.scenes))
        assert isinstance(figure, Figure)
        for path in paths:
            write_figure(figure, path)
    return paths


@pytest.mark.parametrize("number", FIGURES)
def test_every_figure_is_drawn_as_png_and_svg(number: str, solved: Solved, tmp_path: Path) -> None:
    png, svg = drawn(number, solved, tmp_path)
    picture = cv2.imread(str(png), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    assert picture.shape[1] > 900
    assert (picture < 200).mean() > 0.003
    assert svg.stat().st_size < 3e6
    assert ElementTree.parse(svg).getroot().tag.endswith("svg")
    assert sorted(tmp_path.iterdir()) == [png, svg]


NOTHING_FOUND = {
    "1": "(b) 0 segments (grey: noise)",
    "3": "(d) curves of 0 motions (dotted: completed; grey: truth)",
    "4": "(d) {} trajectories",
    "6": "no segment was found",
    "7": "no trajectory was completed within a segment",
    "8": "no segment may follow another",
    "9": "no segments were matched",
    "10": "0 segments",
    "11": "0 motions",
    "12": "0 motions",
    "13": "no motion was completed across a hole",
    "14": "0 motions",
    "15": "no motion was completed within a segment, or none across a hole",
}
"""What each figure says then. Figure 4 shows what comes before the segments."""


@pytest.mark.parametrize("number", FIGURES)
def test_every_figure_says_so_where_nothing_was_found(number: str, empty: Solved, tmp_path: Path) -> None:
    png, svg = drawn(number, empty, tmp_path)
    sentence = NOTHING_FOUND[number].format(empty.trajectories.count)
    assert f"<!-- {sentence} -->" in svg.read_text(encoding="utf-8")  # Letters are drawn as curves.
    picture = cv2.imread(str(png), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    assert (picture < 200).mean() > 0.001


def test_a_figure_is_the_same_bytes_again(solved: Solved, tmp_path: Path) -> None:
    first = [path.read_bytes() for path in drawn("3", solved, tmp_path / "first")]
    assert [path.read_bytes() for path in drawn("3", solved, tmp_path / "second")] == first


def test_a_figure_that_fails_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        (tmp_path / ".figure03.png.partial").write_text("half", encoding="utf-8")
        raise KeyboardInterrupt

    figure = Figure()
    monkeypatch.setattr(figure, "savefig", broken)
    with pytest.raises(KeyboardInterrupt):
        write_figure(figure, tmp_path / "figure03.png")
    assert not list(tmp_path.iterdir())


def test_trajectories_are_those_before_completion(solved: Solved) -> None:
    found = solved.trajectories
    assert len(found.frame) == solved.motions.observed.sum()
    same = found.trajectory[1:] == found.trajectory[:-1]
    assert (np.diff(found.frame)[same] == 1).all()
    assert len(solved.segment) == found.count
    for number, curve in solved.curves.items():
        own = np.isin(found.trajectory, np.flatnonzero(solved.segment == number))
        assert (curve.first, curve.last) == (found.frame[own].min(), found.frame[own].max())


def test_the_candidates_hold_the_chosen_links(solved: Solved) -> None:
    assert solved.links
    for link in solved.motions.links:
        before, after = solved.curves[link.before], solved.curves[link.after]
        assert after.first <= before.last or (link.before, link.after) in solved.candidates


def test_walkers_are_told_apart_from_above_and_balls_from_the_front(recording: Recording) -> None:
    walker = np.array([[-1.0, 0.0, 1.0], [1.0, 2.0, 1.0]])
    ball = np.array([[0.0, 0.0, 1.0], [0.3, 0.1, 2.0]])
    assert plane_of(recording, [walker]) == PLAN
    assert plane_of(recording, [ball]) == ELEVATION
    assert plane_of(recording, []) == PLAN


def test_views_hold_what_they_are_to_show(recording: Recording) -> None:
    places = np.random.default_rng(0).uniform((-2, -1, 0), (2, 2, 2), (100, 3))
    for view in (front_view(recording, places), raised_view(recording, places)):
        column, row = view.picture(places).T
        assert view.left < column.min() < column.max() < view.right
        assert view.top < row.min() < row.max() < view.bottom


def test_moments_are_spread_over_the_recording() -> None:
    assert moments_of(101, 3, margin=0.1) == [10, 50, 90]
    assert moments_of(1, 4) == [0]


def test_figures_are_chosen_by_the_papers_numbers() -> None:
    assert chosen_figures(["10", "3", "3"]) == ["3", "10"]
    assert chosen_figures(["all"]) == list(FIGURES)
    with pytest.raises(InputError, match=r"expected figures among 1, 3, 4, .* got '2'"):
        chosen_figures(["2"])


def test_scenes_are_simulated_and_solved_on_demand_and_used_again(tmp_path: Path) -> None:
    kept = Kept(folder=tmp_path, size="64x48", frames=8)
    assert [path.name for path in draw_figures(["11"], kept, "default", folder=tmp_path)] == [
        "figure11.png",
        "figure11.svg",
    ]
    motions = kept.motions_path("scan1", "default")
    written = motions.stat().st_mtime_ns
    with pytest.raises(InputError, match=r"figure11.png exists already: .* --overwrite"):
        draw_figures(["11"], kept, "default", folder=tmp_path)
    draw_figures(["11"], kept, "default", folder=tmp_path, overwrite=True)
    assert motions.stat().st_mtime_ns == written


def test_paper_settings_make_figures_too(recording: Recording, tmp_path: Path) -> None:
    quick = preset_settings("paper").model_copy(update={"flow": "dis", "eps4": 3.0, "eps5": 2})
    case = Solved(recording=recording, motions=solve(recording, quick))
    for number in ("6", "7", "8", "9", "13", "15"):
        assert all(path.stat().st_size > 1000 for path in drawn(number, case, tmp_path))
