"""Work shared out among processes: all of it is reported, and whatever goes wrong is said once."""

import os
import signal
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from recording.errors import InputError
from recording.workers import reported


@dataclass(frozen=True)
class Counting:
    """Counts up, and may come to a bad end."""

    first: int
    end: str = ""

    def reports(self) -> Iterator[tuple[int, int]]:
        """Each number, and who says it."""
        print("a library's chatter", flush=True)
        for number in range(self.first, self.first + 3):
            yield number, os.getpid()
        if self.end == "refuse":
            raise InputError("expected little,\n got much")
        if self.end == "die":
            os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize(("at_once", "processes"), [(1, 1), (2, 5), (9, 5)])
def test_every_task_reports_from_a_process_of_its_own_unless_it_is_alone(at_once: int, processes: int) -> None:
    found = list(reported([Counting(10 * number) for number in range(5)], at_once=at_once))
    assert sorted(number for number, _ in found) == [10 * task + step for task in range(5) for step in range(3)]
    assert len({process for _, process in found}) == processes
    assert (os.getpid() in {process for _, process in found}) == (at_once == 1)


def test_nothing_to_do_is_done() -> None:
    assert list(reported([], at_once=3)) == []


@pytest.mark.parametrize(("end", "message"), [("refuse", "^expected little, got much$"), ("die", "ended by signal 9")])
def test_what_ends_a_task_ends_the_work(end: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        list(reported([Counting(0), Counting(10, end)], at_once=2))
