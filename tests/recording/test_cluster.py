"""Work shared out: all of it comes back, and what goes wrong takes nothing else with it."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from recording.cluster import Client, Finished, Task, TaskRef, cluster, finished, require_code
from recording.errors import InputError


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    with cluster(workers=2) as own:
        yield own


def begun(mark: str) -> int:
    with Path(mark).open("a") as file:
        file.write("begun\n")
    return 10


def added(first: int, second: int) -> int:
    if second == 3:
        raise ValueError("three")
    return first + second


def died(first: int, second: int) -> int:
    if second == 4:
        os._exit(1)
    return first + second


def threads() -> list[str]:
    return [os.environ[name] for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")]


def by_key(done: Iterator[Finished]) -> dict[str, Finished]:
    return {one.key: one for one in done}


def test_what_tasks_share_is_made_once_and_a_failure_stops_no_other(client: Client, tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    tasks = {"first": Task("first", begun, str(mark))}
    tasks |= {f"sum-{number}": Task(f"sum-{number}", added, TaskRef("first"), number) for number in range(9)}
    done = by_key(finished(client, tasks, [f"sum-{number}" for number in range(9)]))
    assert mark.read_text() == "begun\n"
    assert done.pop("sum-3") == Finished(key="sum-3", failure="ValueError: three")
    assert {one.value for one in done.values()} == {10, 11, 12, 14, 15, 16, 17, 18}


def test_a_task_that_brings_its_workers_down_fails_alone(client: Client) -> None:
    names = [f"deadly-{number}" for number in range(12)]
    tasks = {name: Task(name, died, 10, number) for number, name in enumerate(names)}
    done = by_key(finished(client, tasks, names))
    assert done.pop("deadly-4").failure.startswith("KilledWorker: ")
    assert [one for one in done.values() if one.failure] == []
    assert sorted(one.value for one in done.values()) == [10, 11, 12, 13, *range(15, 22)]


def test_a_few_at_a_time_come_to_the_same(client: Client) -> None:
    tasks = {f"few-{number}": Task(f"few-{number}", added, 1, number + 4) for number in range(20)}
    done = list(finished(client, tasks, list(tasks), at_once=3))
    assert sorted(one.value for one in done) == list(range(5, 25))


def test_nothing_wanted_is_nothing_done(client: Client) -> None:
    assert list(finished(client, {}, [])) == []


def test_a_worker_of_its_own_has_one_thread(client: Client) -> None:
    client.wait_for_workers(2, timeout=60)  # Another test has brought them down.
    assert set(map(tuple, client.run(threads).values())) == {("1", "1", "1")}


def test_a_scheduler_that_is_not_there_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recording.cluster._PATIENCE_SECONDS", 0.3)
    with pytest.raises(InputError, match=r"--scheduler: expected a Dask scheduler at 'tcp://127\.0\.0\.1:1'"):
        cluster("tcp://127.0.0.1:1").__enter__()


def test_other_code_is_refused() -> None:
    with pytest.raises(InputError, match="other code than the client"):
        require_code("0", "recording.code")
