"""The recordings of a sweep."""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from algorithm.settings import Preset, Settings, preset_settings
from evaluation.compare import labelled
from evaluation.sweeps.plan import Sweep
from recording.cluster import Client, Task, finished
from recording.errors import InputError
from recording.progress import tracked
from recording.store import load_recording
from simulator.simulate import prepared, write_simulation


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A recording, and all that tells it from others."""

    label: str
    """Its name in the results."""
    place: str
    """Its folder, which every worker must see."""
    scene: str
    seed: int | None
    digest: str
    """Of what the sensor saw, as `Recording.digest`."""
    files: str
    """SHA-256 of all its files, the truth among them."""
    of_scene: Mapping[str, float] | None
    """The epsilons that its scene states for the preset `paper`."""

    def settings(self, preset: Preset) -> Settings:
        """The preset's settings for it."""
        return preset_settings(preset, of_scene=self.of_scene)


@dataclass(frozen=True, kw_only=True)
class _Wish:
    """A scene to be simulated."""

    scene: str
    seed: int
    frames: int | None
    size: str | None
    sensor: str | None
    folder: str
    """Of the recordings."""


def subjects_of(client: Client, sweep: Sweep, folder: Path) -> list[Subject]:
    """The recordings of the sweep: those given, and those of its scenes, simulated into the folder unless they are.

    Workers simulate and read them. InputError where one of them cannot be had.
    """
    tasks = dict(_tasks(sweep, folder.resolve()))
    done = tracked(finished(client, tasks, list(tasks)), "recordings", total=len(tasks))
    found: dict[str, Subject] = {}
    for one in done:
        if one.failure is not None:
            raise InputError(f"{one.key}: {one.failure.removeprefix('InputError: ')}")
        found[one.key] = one.value
    return [found[key] for key in tasks]


def _tasks(sweep: Sweep, folder: Path) -> Iterator[tuple[str, Task]]:
    for scene in sweep.scenes:
        path = Path(scene)
        name = str(path.resolve()) if path.suffix == ".toml" else scene
        for seed in sweep.seeds:
            wish = _Wish(
                scene=name,
                seed=seed,
                frames=sweep.frames,
                size=sweep.size,
                sensor=sweep.sensor,
                folder=str(folder),
            )
            label = f"{path.stem}-{seed:06d}"
            yield label, Task(label, _simulated, label, wish)
    if sweep.recordings:
        for label, place in labelled([Path(place) for place in sweep.recordings]).items():
            yield label, Task(label, _subject, label, str(place))


def _simulated(label: str, wish: _Wish) -> Subject:
    simulation = prepared(wish.scene, seed=wish.seed, frames=wish.frames, size=wish.size, sensor=wish.sensor)
    place = Path(wish.folder) / f"{label}-{str(simulation.metadata.scene_digest)[:8]}"
    if not (place / "recording.json").is_file():
        write_simulation(simulation, place)
    return _subject(label, str(place))


def _subject(label: str, place: str) -> Subject:
    recording = load_recording(place)
    metadata = recording.metadata
    return Subject(
        label=label,
        place=place,
        scene=metadata.name or label,
        seed=metadata.seed,
        digest=recording.digest(),
        files=digest_of_files(Path(place)),
        of_scene=(metadata.scene or {}).get("paper"),
    )


def digest_of_files(place: Path) -> str:
    """SHA-256 of a recording's own files and their names; motions and pictures beside them do not count."""
    content = hashlib.sha256()
    own = [place / "recording.json", place / "truth.npz", *(place / "frames").iterdir(), *place.glob("xray/*")]
    for path in sorted(path for path in own if path.is_file()):
        content.update(path.relative_to(place).as_posix().encode())
        content.update(hashlib.sha256(path.read_bytes()).digest())
    return content.hexdigest()
