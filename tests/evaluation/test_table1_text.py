"""Table 1 as text, Markdown, LaTeX and CSV: what is written reads back, and agrees with the scores."""

import io
import re
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from evaluation.kept import Kept
from evaluation.table1 import Result, Row, measured_rows
from evaluation.table1_text import FILES, csv_of, latex_of, markdown_of, tables_of, text_of, write_tables
from recording.errors import InputError


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> list[Row]:
    """A small house and a small scan under both presets."""
    kept = Kept(folder=tmp_path_factory.mktemp("kept"), size="64x48", frames=8)
    return measured_rows(["house", "scan1"], kept, ("paper", "default"))


@pytest.fixture(scope="module")
def failed(rows: list[Row]) -> list[Row]:
    """The same, the last solve of which failed."""
    result = replace(rows[1].results[1], scores=None, failure="ValueError: 3 % of a_b & more")
    return [rows[0], replace(rows[1], results=(rows[1].results[0], result))]


def result_of(rows: list[Row], test: str, preset: str) -> Result:
    row = next(row for row in rows if row.paper.test == test)
    return next(result for result in row.results if result.preset == preset)


def test_csv_has_a_line_a_scene_and_preset_that_agrees_with_the_scores(rows: list[Row]) -> None:
    table = pd.read_csv(io.StringIO(csv_of(rows)))
    assert list(zip(table.scene, table.preset, strict=True)) == [
        *(("house", "paper"), ("house", "default"), ("scan1", "paper"), ("scan1", "default")),
    ]
    for line in table.itertuples():
        result = result_of(rows, line.test, line.preset)
        assert result.scores is not None
        assert line.segments == result.scores["segments"]["count"]
        assert line.total_s == pytest.approx(result.scores["seconds"]["total"])
        assert (line.eps1, line.eps2, line.eps3, line.eps4, line.eps5) == result.epsilons
        for column, value in (
            ("purity", result.scores["motions"]["purity"]),
            ("centre_mean_m", result.scores["completion"]["centre_mean_m"]),
        ):
            found = getattr(line, column)
            assert pd.isna(found) if value is None else found == pytest.approx(value)


def test_every_table_of_the_markdown_has_as_many_cells_in_each_line(rows: list[Row]) -> None:
    for part in markdown_of(tables_of(rows)).split("## ")[1:]:
        lines = [line for line in part.splitlines() if line.startswith("|")]
        assert len(lines) == 2 + len(rows)
        assert len({line.count("|") for line in lines}) == 1


def test_latex_is_balanced_and_escaped(failed: list[Row]) -> None:
    text = latex_of(tables_of(failed))
    assert "booktabs" in text.splitlines()[0]
    body = re.sub(r"(?m)(?<!\\)%.*$", "", text)
    assert body.count("{") == body.count("}")
    begun = re.findall(r"\\begin\{([a-z*]+)\}", body)
    assert sorted(begun) == sorted(re.findall(r"\\end\{([a-z*]+)\}", body))
    assert begun.count("tabular") == 3
    assert r"3 \% of a\_b \& more" in body
    for table in re.findall(r"(?s)\\toprule(.*?)\\bottomrule", body):
        lines = [line for line in table.splitlines() if line.endswith("\\\\")]
        assert len({len(re.findall(r"(?<!\\)&", line)) for line in lines}) == 1


def test_cells_have_the_papers_number_and_ours(rows: list[Row]) -> None:
    counts, paper, default = tables_of(rows)
    assert counts.rows[0]["Fr"] == "30 / 8"
    assert counts.rows[0]["missed"].startswith("Fr, Pts")
    assert [paper.rows[0][f"e{number}"] for number in range(1, 6)] == ["0.5", "0.1", "10", "20", "10"]
    scores = result_of(rows, "real scan 1", "default").scores
    assert scores is not None
    assert default.rows[1]["Seg"] == f"3 / {scores['segments']['count']}"
    assert default.rows[1]["found"] == f"{scores['motions']['found']} of 2"


def test_a_missing_number_is_a_dash_and_in_csv_an_empty_cell(failed: list[Row]) -> None:
    table = tables_of(failed)[2]
    for column in ("purity", "inverse", "centre mean", "centre max", "points mean", "motions"):
        assert table.rows[1][column] == "-"
    assert table.rows[1]["Seg"] == "3 / -"
    assert pd.isna(pd.read_csv(io.StringIO(csv_of(failed))).purity.iloc[-1])


def test_a_failure_stands_in_its_row_and_the_others_are_whole(failed: list[Row]) -> None:
    _, paper, default = tables_of(failed)
    assert "failure" not in paper.rows[0]
    assert [row["failure"] for row in default.rows] == ["-", "ValueError: 3 % of a_b & more"]
    assert "ValueError: 3 % of a_b & more" in text_of([default])


def test_counts_alone_have_no_results(rows: list[Row]) -> None:
    bare = [replace(row, results=()) for row in rows]
    assert len(tables_of(bare)) == 1
    assert len(pd.read_csv(io.StringIO(csv_of(bare)))) == 2


def test_files_are_written_and_not_overwritten_unless_asked_for(rows: list[Row], tmp_path: Path) -> None:
    write_tables(rows, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(FILES)
    with pytest.raises(InputError, match="exists already"):
        write_tables(rows, tmp_path)
    write_tables(rows, tmp_path, overwrite=True)
