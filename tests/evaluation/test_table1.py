"""Table 1: ours beside the paper's."""

from dataclasses import replace
from pathlib import Path

import pytest

from evaluation.kept import Kept
from evaluation.paper_rows import PAPER, PaperRow
from evaluation.table1 import OwnRow, measured_rows, misses, points_deviation
from recording.errors import InputError
from simulator.scene import load_scene


def exact(paper: PaperRow) -> OwnRow:
    return OwnRow(
        frames=paper.frames,
        points=float(paper.points[0]),
        objects=paper.objects,
        static=paper.static,
        holes=paper.holes,
        longest=paper.longest,
    )


@pytest.mark.parametrize("paper", PAPER, ids=lambda row: row.scene)
def test_the_papers_own_numbers_miss_nothing(paper: PaperRow) -> None:
    assert misses(paper, exact(paper)) == []


def test_what_lies_outside_the_tolerances_is_named() -> None:
    wall = next(row for row in PAPER if row.scene == "wall")
    own = exact(wall)
    assert misses(wall, replace(own, points=4800 * 1.14, longest=37)) == []
    changed = replace(own, frames=99, points=4800 * 1.16, objects=3, static=0, holes=3, longest=38)
    assert misses(wall, changed) == ["Fr", "Pts", "Obj", "Stat", "Occ", "Max Occ"]


def test_more_holes_are_welcome_only_where_the_paper_says_so() -> None:
    crowd = next(row for row in PAPER if row.at_least)
    assert misses(crowd, replace(exact(crowd), holes=40)) == []
    assert misses(crowd, replace(exact(crowd), holes=24)) == ["Occ"]


def test_points_within_a_range_do_not_deviate() -> None:
    scan = next(row for row in PAPER if row.scene == "scan1")
    low, high = scan.points
    assert points_deviation(scan, replace(exact(scan), points=(low + high) / 2)) == 0
    assert points_deviation(scan, replace(exact(scan), points=low * 0.9)) == pytest.approx(-0.1)
    assert points_deviation(scan, replace(exact(scan), points=high * 1.2)) == pytest.approx(0.2)


def test_recordings_are_kept_and_measured_again(tmp_path: Path) -> None:
    kept = Kept(folder=tmp_path, size="67x50")
    first = measured_rows(["house"], kept)
    written = (tmp_path / "house" / "recording.json").stat().st_mtime_ns
    assert measured_rows(["house"], kept) == first
    assert (tmp_path / "house" / "recording.json").stat().st_mtime_ns == written
    assert first[0].own.frames == 30
    assert first[0].results == ()


@pytest.mark.parametrize("paper", PAPER, ids=lambda row: row.scene)
def test_the_papers_epsilons_are_those_of_the_scenes(paper: PaperRow) -> None:
    stated = load_scene(paper.scene).paper
    assert tuple(getattr(stated, f"eps{number}") for number in range(1, 6)) == paper.epsilons


def test_an_unknown_scene_is_refused_with_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown scene 'hous', did you mean 'house'"):
        measured_rows(["hous"], Kept(folder=tmp_path))
