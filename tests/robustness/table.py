"""The table of wrong inputs as it stands in docs/robustness.md; run as a program, this writes it there."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "robustness.md"
BEGIN, END = "<!-- table: tests/robustness/table.py writes it -->", "<!-- end of the table -->"


def table_text() -> str:
    """A section for each group of cases, with a row a case."""
    from cases import GROUPS  # noqa: PLC0415 - when this is a program, the path is set first.

    lines = []
    for group, cases in GROUPS.items():
        lines += ["", f"### {group}", "", "| input | what happens |", "|---|---|"]
        for case in cases:
            said = case.says.replace("|", "\\|")
            lines.append(f"| {case.input} | {f'refused: `{said}`' if case.status == 2 else case.becomes} |")
    return "\n".join([*lines, ""])


def page_with(table: str) -> str:
    """The page with the table in its place."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    return before + BEGIN + "\n" + table + "\n" + END + rest.partition(END)[2]


if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]
    PAGE.write_text(page_with(table_text()), encoding="utf-8")
