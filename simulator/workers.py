"""The frames of a scene, shared out among processes that cast them and write them.

A worker is a Python of its own that reads its share from standard input: it imports the caster, not the program
that asked for it, and a key that interrupts the program does not reach it.
"""

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

from recording.errors import InputError
from recording.metadata import Metadata
from recording.store import write_picture
from simulator.backend import Backend
from simulator.pictures import Stage, pictures

_COMMAND = "from simulator.workers import main; main()"
_REFUSED = "refused: "


@dataclass(frozen=True, kw_only=True, eq=False)
class Share:
    """The frames that one worker makes: every so many-th."""

    stage: Stage
    """With these frames alone."""
    first: int
    """The number of the first of them in the recording."""
    step: int
    """How much further the number of the next one is."""
    folder: Path
    """Of the new recording."""
    metadata: Metadata
    backend: Backend


def written_pictures(
    stage: Stage, folder: Path, *, metadata: Metadata, backend: Backend, workers: int
) -> Generator[int]:
    """The number of each frame when it has been written, in any order.

    Whatever ends this iterator ends the workers first: a failure of one of them, which is an error here, or
    that no more is asked for.
    """
    count = min(workers, stage.frames)
    shares = [
        Share(
            stage=stage.every(count, begin=first),
            first=first,
            step=count,
            folder=folder,
            metadata=metadata,
            backend=backend,
        )
        for first in range(count)
    ]
    if count == 1:
        yield from _make(shares[0])
        return
    with _team(shares) as lines:
        yield from _reported(lines, count)


def main() -> None:
    """What a worker does: it makes the share that it reads, and writes a line for each frame."""
    share: Share = pickle.load(sys.stdin.buffer)
    try:
        for number in _make(share):
            print(number, flush=True)
    except InputError as error:
        print(_REFUSED + " ".join(str(error).split()), flush=True)
    except BrokenPipeError:  # Whoever asked is gone.
        os._exit(1)


def _make(share: Share) -> Iterator[int]:
    for count, (frame, xray) in enumerate(pictures(share.stage, share.backend)):
        number = share.first + count * share.step
        write_picture(share.folder, number, frame, xray, metadata=share.metadata)
        yield number


@contextlib.contextmanager
def _team(shares: list[Share]) -> "Iterator[queue.Queue[str | int]]":
    """Workers on the shares, and what they say as it comes; none is left after the block."""
    lines: queue.Queue[str | int] = queue.Queue()
    running: list[subprocess.Popen[bytes]] = []
    listeners = []
    try:
        for share in shares:
            running.append(_started())
            listeners.append(threading.Thread(target=_attend, args=(running[-1], share, lines)))
            listeners[-1].start()
        yield lines
    finally:
        for worker in running:
            worker.kill()
        for listener in listeners:
            listener.join()


def _started() -> "subprocess.Popen[bytes]":
    search_path = os.pathsep.join(path or os.getcwd() for path in sys.path)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", _COMMAND],
        env=os.environ | {"PYTHONPATH": search_path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
    )


def _attend(worker: "subprocess.Popen[bytes]", share: Share, lines: "queue.Queue[str | int]") -> None:
    """Hand the worker its share, then pass on what it says, and at last its exit status."""
    if worker.stdin is None or worker.stdout is None:
        raise ValueError("expected a worker with pipes")
    with worker.stdout:
        with contextlib.suppress(BrokenPipeError), worker.stdin:  # One that is dead says so by its status.
            pickle.dump(share, worker.stdin)
        for line in worker.stdout:
            lines.put(line.decode().strip())
        lines.put(worker.wait())


def _reported(lines: "queue.Queue[str | int]", at_work: int) -> Iterator[int]:
    """The numbers that the workers report, until all of them are done."""
    while at_work:
        line = lines.get()
        if isinstance(line, int):
            _check_ended_well(line)
            at_work -= 1
        elif line.startswith(_REFUSED):
            raise InputError(line.removeprefix(_REFUSED))
        else:
            yield int(line)


def _check_ended_well(status: int) -> None:
    if status < 0:
        raise InputError(f"a worker was ended by signal {-status}: is there memory for so many? pass fewer workers")
    if status > 0:
        raise RuntimeError(f"a worker failed with exit status {status}")
