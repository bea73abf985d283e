"""What benchmarks/generate.py compares with: recordings whose scenes are ready, cast and written, and no more."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from recording.store import new_recording, write_metadata, write_picture
from simulator.backend import Backend
from simulator.pictures import pictures
from simulator.simulate import Simulation


@dataclass(frozen=True, kw_only=True)
class Bare:
    """The recordings that one process casts and writes; a module of its own, for processes to import."""

    simulations: Sequence[Simulation]
    folder: Path
    backend: Backend

    def reports(self) -> Iterator[int]:
        """How many frames each recording has, when it is on disk."""
        for simulation in self.simulations:
            metadata = simulation.metadata
            with new_recording(self.folder / simulation.scene.name, truth=simulation.truth) as partial:
                for number, (frame, xray) in enumerate(pictures(simulation.stage, self.backend)):
                    write_picture(partial, number, frame, xray, metadata=metadata)
                write_metadata(partial, metadata)
            yield metadata.frames
