"""Every wrong input of the table: one line and exit status 2 with nothing left behind, or what the table says."""

import shutil
from pathlib import Path

import pytest
from case import Case, bench
from cases import GROUPS

import unocclude

CASES = [pytest.param(each, id=f"{group}: {each.input}") for group in GROUPS for each in GROUPS[group]]


@pytest.fixture(scope="session")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("bench")
    bench(place)
    return place


def tree(place: Path) -> dict[str, int]:
    return {str(path.relative_to(place)): path.lstat().st_size for path in place.rglob("*")}


def ended(arguments: list[str]) -> int:
    """The exit status of a command line."""
    try:
        unocclude.main(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


@pytest.mark.usefixtures("_without_type_checks")
@pytest.mark.parametrize("case", CASES)
def test_a_wrong_input_ends_as_the_table_says(
    case: Case, original: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    place = tmp_path / "copy"
    shutil.copytree(original, place)
    case.damage(place)
    before = tree(place)
    status = ended(case.command.format(place=place).split())
    output = capfd.readouterr()
    assert status == case.status, output.err
    if status != 2:
        assert case.says in output.out + output.err
        return
    assert output.err.startswith("unocclude: ")
    assert output.err.count("\n") == 1
    assert case.says in output.err
    assert output.out == ""
    assert tree(place) == before
