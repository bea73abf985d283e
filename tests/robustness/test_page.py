"""docs/robustness.md says what the tests hold."""

from cases import GROUPS
from table import PAGE, page_with, table_text


def test_the_page_has_every_case() -> None:
    assert PAGE.read_text(encoding="utf-8") == page_with(table_text())


def test_there_are_many_cases_and_each_has_a_name_of_its_own() -> None:
    names = [(group, case.input) for group, cases in GROUPS.items() for case in cases]
    assert len(names) == len(set(names)) >= 60


def test_what_is_not_refused_is_explained() -> None:
    assert all(bool(case.becomes) == (case.status != 2) for cases in GROUPS.values() for case in cases)
