"""What a sweep's rows say, on rows whose answer is known."""

import itertools
from pathlib import Path
from typing import Any

import cv2
import pytest

from evaluation.sweeps.levels import interval_of, levels_of
from evaluation.sweeps.plan import Sweep, points_of
from evaluation.sweeps.plots import draw_curves, draw_pairs, has_pairs, paper_values
from evaluation.sweeps.summary import summary_document, summary_of, summary_text
from evaluation.sweeps.table import Row
from evaluation.sweeps.worth import less_is_better, worth

AXES = {"eps1": [1.0, 2.0, 3.0], "eps2": [0.1, 0.2], "flow": ["dis", "range"]}


def sweep_of(axes: dict[str, Any] = AXES, **changes: Any) -> Sweep:
    return Sweep.model_validate({"name": "known", "scenes": ["wall", "forest"], "axes": axes, **changes})


def rows_of(sweep: Sweep, seeds: tuple[int, ...] = (1, 2), **known: Any) -> list[Row]:
    """Rows whose worth is eps1 / 10, 0.01 more with every seed, whatever the other axes are."""
    base = {"eps1": 1.0, "eps2": 0.1, "flow": "range"}
    rows = []
    for point, scene, seed in itertools.product(points_of(sweep), sweep.scenes, seeds):
        settings = {f"settings.{name}": value for name, value in {**base, **point.values}.items()}
        value = settings["settings.eps1"] / 10 + 0.01 * seed
        own = {"point": point.number, "axis": point.axis, "recording": f"{scene}-{seed}", "scene": scene, "seed": seed}
        rows.append({**own, "failure": None, **settings, "worth": value, "error": 1 - value, **known})
    return rows


def test_the_best_point_is_that_of_the_greatest_mean() -> None:
    sweep = sweep_of()
    best = summary_of(sweep, rows_of(sweep)).standings[0]
    assert best.values["eps1"] == 3.0
    assert best.goal.mean == pytest.approx(0.315)


def test_of_an_error_the_least_is_the_best() -> None:
    sweep = sweep_of(goal="error")
    assert summary_of(sweep, rows_of(sweep)).standings[0].values["eps1"] == 3.0
    assert [less_is_better(name) for name in ("error", "seconds.flow", "completion.mean_m", "worth", "coverage")] == [
        *(True, True, True, False, False)
    ]


def test_the_interval_is_over_seeds_not_over_recordings() -> None:
    sweep = sweep_of()
    rows = [row for row in rows_of(sweep, seeds=(1, 2, 3)) if row["point"] == 0]
    for row in rows:
        row["worth"] += 0.5 * (row["scene"] == "wall")  # Scenes differ by much, seeds by 0.01.
    interval = interval_of(rows, "worth")
    assert interval.count == 3
    assert interval.half_width == pytest.approx(0.01 * 4.302653 / 3**0.5, rel=1e-5)
    assert interval_of(rows[:1], "worth").half_width is None
    assert interval_of(rows, "nothing") is None


def test_only_the_parameter_that_matters_has_an_effect_and_explains_all() -> None:
    sweep = sweep_of()
    found = {one.axis: one for one in summary_of(sweep, rows_of(sweep)).sensitivities}
    assert found["eps1"].effect == pytest.approx(0.2)
    assert found["eps1"].share == pytest.approx(1.0)
    for axis in ("eps2", "flow"):
        assert found[axis].effect == pytest.approx(0.0)
        assert found[axis].share == pytest.approx(0.0)


def test_one_at_a_time_looks_along_each_axis_alone() -> None:
    sweep = sweep_of(design="one_at_a_time")
    rows = rows_of(sweep)
    assert [level.value for level in levels_of(sweep, rows, "eps1")] == [1.0, 2.0, 3.0]
    found = {one.axis: one for one in summary_of(sweep, rows).sensitivities}
    assert (found["eps1"].effect, found["eps1"].share) == (pytest.approx(0.2), None)
    assert not has_pairs(sweep)


def test_many_values_are_looked_at_in_parts() -> None:
    sweep = sweep_of({"eps1": {"from": 1, "to": 5}}, design="sobol", samples=40)
    levels = levels_of(sweep, rows_of(sweep), "eps1")
    assert len(levels) == 8
    assert sum(len(level.rows) for level in levels) == 160
    assert [level.value for level in levels] == sorted(level.value for level in levels)


def test_a_point_that_failed_comes_after_all_that_did_not() -> None:
    sweep = sweep_of()
    rows = rows_of(sweep)
    best = summary_of(sweep, rows).standings[0].point
    failed = next(row for row in rows if row["point"] == best)
    failed |= {"failure": "ValueError: no", "worth": None}
    summary = summary_of(sweep, rows)
    assert summary.standings[-1].point == best
    assert f"point {best} on wall-1: ValueError: no" in summary_text(summary)
    assert summary_document(summary)["failures"] == [f"point {best} on wall-1: ValueError: no"]


def test_worth_is_the_mean_of_what_is_known() -> None:
    assert worth({"identity.hota": 0.5, "completion.recall": 0.9}) == pytest.approx(0.7)
    assert worth({"identity.hota": 0.5, "completion.recall": None}) == 0.5
    assert worth({"identity.hota": None, "completion.recall": None}) is None


def test_the_papers_values_are_those_of_table_1_for_the_scenes() -> None:
    sweep = sweep_of()
    assert paper_values(sweep, "eps4", ["wall", "9men"]) == [5.0, 20.0]
    assert paper_values(sweep, "eps3", ["elsewhere"]) == [10.0]
    assert paper_values(sweep, "flow", ["wall"]) == ["classic_nl_fast"]


@pytest.mark.parametrize("design", ["grid", "one_at_a_time", "random"])
def test_pictures_show_a_panel_an_axis_and_a_pair(design: str, tmp_path: Path) -> None:
    sweep = sweep_of(design=design)
    rows = rows_of(sweep)
    draw_curves(sweep, rows, tmp_path / "curves.png")
    assert cv2.imread(str(tmp_path / "curves.png")).shape[1] > 1200
    if has_pairs(sweep):
        draw_pairs(sweep, rows, tmp_path / "pairs.png")
        assert cv2.imread(str(tmp_path / "pairs.png")).shape[1] > 1200
