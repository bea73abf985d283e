"""Recordings of scenes and the motions found in them, kept in a folder and used again while they hold."""

import json
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from algorithm.pipeline import solve
from algorithm.settings import Preset, Settings
from evaluation.methods import settings_of
from evaluation.outcome import FAILURES, code_digest
from recording.atomic import whole_file
from recording.errors import InputError
from recording.motions import Motions
from recording.parquet import load_motions, save_motions
from recording.progress import tracked
from recording.recording import Recording
from recording.store import load_recording
from recording.version import VERSION
from recording.workers import reported
from simulator.simulate import prepared, write_simulation

Job = tuple[str, Preset]
"""A scene, and what to solve it with."""


@dataclass(frozen=True, kw_only=True)
class Kept:
    """A folder of recordings `<scene>/`, each with its motions `<scene>/motions_<preset>.parquet`.

    Beside the motions stands the digest of the code that made them, `<scene>/motions_<preset>.code`.
    """

    folder: Path
    size: str | None = None
    """Picture size in place of the scenes' own, such as `2x`."""
    frames: int | None = None
    """Number of frames in place of the scenes' own."""
    workers: int = 1
    """Processes that cast, or that solve."""
    overwrite: bool = False
    """Whether recordings of something else may be replaced."""

    def recording(self, scene: str) -> Recording:
        """The recording of a scene, simulated unless the folder holds it.

        InputError where it holds another one under that name: of another size or length, or of the scene
        as it was before somebody changed it.
        """
        place = self.folder / scene
        simulation = prepared(scene, size=self.size, frames=self.frames)
        if (place / "recording.json").is_file():
            found = load_recording(place)
            if found.metadata.scene_digest == simulation.metadata.scene_digest:
                return found
            if not self.overwrite:
                raise InputError(
                    f"{place}: expected the scene {scene!r} as it was asked for, got a recording of another size, "
                    "length or scene: choose another folder, or pass --overwrite to replace it"
                )
        write_simulation(simulation, place, workers=self.workers, overwrite=self.overwrite)
        return load_recording(place)

    def motions(self, scene: str, preset: Preset) -> Motions:
        """The motions of a scene's recording under a preset, solved unless the folder holds them.

        Motions made of another recording, under other settings, by another version or other code are made again.
        """
        recording = self.recording(scene)
        settings = settings_of(recording, preset)
        place = self.motions_path(scene, preset)
        maker, code = place.with_suffix(".code"), code_digest()
        if place.is_file() and maker.is_file() and maker.read_bytes() == code.encode():
            found = load_motions(place)
            if _made_so(found, recording, settings):
                return found
        motions = solve(recording, settings)
        maker.unlink(missing_ok=True)  # So that no interruption leaves it beside motions of other code.
        save_motions(motions, place, overwrite=True)
        with whole_file(maker) as partial:
            partial.write_text(code, encoding="utf-8")
        return load_motions(place)

    def motions_path(self, scene: str, preset: Preset) -> Path:
        """Where the motions of a scene are kept."""
        return self.folder / scene / f"motions_{preset}.parquet"

    def solve_all(self, wanted: Sequence[Job]) -> dict[Job, str]:
        """Solve scenes under presets, several at once with more workers; what failed, and why."""
        for scene in dict.fromkeys(scene for scene, _ in wanted):
            self.recording(scene)
        done = reported([_Solving(kept=self, job=job) for job in wanted], at_once=self.workers)
        with closing(done):
            reasons = dict(tracked(done, "solving", total=len(wanted)))
        return {job: reason for job in wanted if (reason := reasons[job]) is not None}


@dataclass(frozen=True, kw_only=True)
class _Solving:
    """A scene to be solved under a preset, for a process of its own."""

    kept: Kept
    job: Job

    def reports(self) -> Iterator[tuple[Job, str | None]]:
        """Once: the job, and why it cannot be done, or None when it was."""
        try:
            self.kept.motions(*self.job)
        except FAILURES as error:
            yield self.job, " ".join(f"{type(error).__name__}: {error}".split())
        else:
            yield self.job, None


def _made_so(motions: Motions, recording: Recording, settings: Settings) -> bool:
    making = motions.making
    stored = json.loads(settings.model_dump_json())
    return making.version == VERSION and making.settings == stored and making.recording_digest == recording.digest()
