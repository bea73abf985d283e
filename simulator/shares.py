"""The frames of one scene, shared out among processes that cast them and write them."""

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

from recording.causes import Tally, tally_of
from recording.metadata import Metadata
from recording.store import write_picture
from recording.workers import reported
from simulator.backend import Backend
from simulator.pictures import Stage, pictures


@dataclass(frozen=True, kw_only=True, eq=False)
class Written:
    """A frame that is on disk."""

    number: int
    """In the recording."""
    tally: Tally


@dataclass(frozen=True, kw_only=True, eq=False)
class Share:
    """The frames that one worker makes: every so many-th, as the stage has them."""

    stage: Stage
    folder: Path
    """Of the new recording."""
    metadata: Metadata
    backend: Backend

    def reports(self) -> Iterator[Written]:
        """Each frame when it is written."""
        for count, (frame, xray) in enumerate(pictures(self.stage, self.backend)):
            number = self.stage.first + count * self.stage.step
            write_picture(self.folder, number, frame, xray, metadata=self.metadata)
            yield Written(number=number, tally=tally_of(frame, xray, self.metadata))


def written_pictures(
    stage: Stage, folder: Path, *, metadata: Metadata, backend: Backend, workers: int
) -> Generator[Written]:
    """Each frame when it is written, in any order.

    Whatever ends this iterator ends the workers first: a failure of one of them, which is an error here, or
    that no more is asked for.
    """
    count = min(workers, stage.frames)
    shares = [
        Share(stage=stage.every(count, begin=first), folder=folder, metadata=metadata, backend=backend)
        for first in range(count)
    ]
    return reported(shares, at_once=workers)
