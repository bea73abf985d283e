"""Progress: the items pass unchanged, with a display and without."""

import io
from collections.abc import Iterator

import pytest
from rich.console import Console

from recording import progress
from recording.progress import progress_shown, tracked


def console(*, terminal: bool) -> Console:
    return Console(file=io.StringIO(), force_terminal=terminal, width=80)


def written(console: Console) -> str:
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def test_the_items_pass_in_order_without_a_display() -> None:
    assert list(tracked(iter("abc"), "letters", total=3)) == ["a", "b", "c"]


def test_items_are_fetched_only_as_they_are_asked_for() -> None:
    fetched = []

    def items() -> Iterator[int]:
        for number in range(5):
            fetched.append(number)
            yield number

    stream = tracked(items(), "numbers", total=5)
    assert fetched == []
    next(stream)
    assert fetched == [0]


def test_long_work_shows_a_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "PATIENCE_SECONDS", -1.0)
    screen = console(terminal=True)
    with progress_shown(screen):
        assert list(tracked(range(3), "counting", total=3)) == [0, 1, 2]
    assert "counting" in written(screen)


def test_short_work_shows_none() -> None:
    screen = console(terminal=True)
    with progress_shown(screen):
        assert list(tracked(range(3), "counting", total=3)) == [0, 1, 2]
    assert "counting" not in written(screen)


def test_nothing_is_drawn_into_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "PATIENCE_SECONDS", -1.0)
    screen = console(terminal=False)
    with progress_shown(screen):
        assert list(tracked(range(3), "counting", total=3)) == [0, 1, 2]
    assert written(screen) == ""


def test_loops_within_loops_are_both_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "PATIENCE_SECONDS", -1.0)
    screen = console(terminal=True)
    with progress_shown(screen):
        for _ in tracked(range(2), "outside", total=2):
            assert list(tracked(range(2), "within", total=2)) == [0, 1]
    assert "outside" in written(screen)
    assert "within" in written(screen)


def test_no_display_outlives_its_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "PATIENCE_SECONDS", -1.0)
    screen = console(terminal=True)
    with pytest.raises(ZeroDivisionError), progress_shown(screen):
        list(1 // number for number in tracked(range(3), "failing", total=3))
    before = written(screen)
    assert list(tracked(range(3), "afterwards", total=3)) == [0, 1, 2]
    assert written(screen) == before
