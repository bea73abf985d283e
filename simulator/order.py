"""A recording of a random family, from its seed to its place in a data set."""

from dataclasses import dataclass
from pathlib import Path

from recording.causes import tally_of
from recording.errors import InputError
from recording.manifest import Entry, Split, entry_of
from recording.metadata import Metadata
from recording.recording import DepthDigest
from recording.shelf import Shelf, shelf_at
from recording.store import load_recording, new_recording, write_metadata, write_picture
from simulator.backend import Backend
from simulator.family import DEVELOPMENT_SEEDS, REPORTING_SEEDS, Family
from simulator.family_scene import drawn_scene
from simulator.pictures import pictures
from simulator.recorded_crowd import crowd_tracks
from simulator.scene import Scene
from simulator.sensor import sensor_named
from simulator.simulate import Simulation, changed_scene, made_ready, picture_size


@dataclass(frozen=True, kw_only=True)
class Order:
    """What recordings of a family are to be like, and where they are to be."""

    family: Family
    folder: Path | str
    """Of the data set, or its URL; a recording's folder in it has the family's name and the seed."""
    sensor: str | None = None
    """A preset in place of the family's sensor."""
    size: str | None = None
    """A picture size in place of the family's own, as in `simulator.simulate.prepared`."""
    overwrite: bool = False
    """Whether recordings that are there are made again."""

    @property
    def shelf(self) -> Shelf:
        """Where the recordings stand."""
        return shelf_at(self.folder)

    def pixels(self) -> tuple[int, int] | None:
        """Width and height in place of the family's own."""
        own = self.family.camera.width, self.family.camera.height
        return None if self.size is None else picture_size(self.size, own)

    def check(self) -> None:
        """Raise an InputError where no seed can have a recording: for its sensor, its size or the crowd's file."""
        self.pixels()
        if self.sensor is not None:
            sensor_named(self.sensor)
        if self.family.crowd is not None:
            crowd_tracks(self.family.crowd)

    def scene(self, seed: int) -> Scene:
        """The scene of the seed as the family has it; an InputError where the family has none."""
        return drawn_scene(self.family, seed).model_copy(update={"name": f"{self.family.name}-{seed:06d}"})

    def ready(self, scene: Scene, seed: int) -> Simulation:
        """The scene, which is that of the seed, as it was ordered and ready to be cast."""
        return made_ready(changed_scene(scene, size=self.pixels(), frames=None, sensor=self.sensor), seed=seed)

    def simulation(self, seed: int) -> Simulation:
        """Both in one: the seed's scene, ready to be cast."""
        return self.ready(self.scene(seed), seed)


@dataclass(frozen=True, kw_only=True)
class Refused:
    """A seed whose scene cannot be had."""

    seed: int
    sentence: str
    """Why not."""


@dataclass(frozen=True, kw_only=True)
class Listed:
    """A recording is complete."""

    entry: Entry
    made: bool
    """Whether it was made just now, or was there already."""


def recorded(order: Order, seed: int, backend: Backend) -> Listed | Refused:
    """The recording of the seed, made unless it is there; InputError where another one is."""
    try:
        scene = order.scene(seed)
    except InputError as error:
        return Refused(seed=seed, sentence=str(error))
    simulation = order.ready(scene, seed)
    if order.shelf.holds(scene.name) and not order.overwrite:
        with order.shelf.fetched(scene.name) as place:
            return Listed(entry=_entry_there(place, simulation.metadata), made=False)
    with order.shelf.making(scene.name) as place:
        return Listed(entry=_made(simulation, place, backend), made=True)


def _made(simulation: Simulation, place: Path, backend: Backend) -> Entry:
    tallies, digest = [], DepthDigest(simulation.metadata)
    with new_recording(place, truth=simulation.truth) as partial:
        for number, (frame, xray) in enumerate(pictures(simulation.stage, backend)):
            write_picture(partial, number, frame, xray, metadata=simulation.metadata)
            tallies.append(tally_of(frame, xray, simulation.metadata))
            digest.add(frame)
        metadata = simulation.described(tallies)
        write_metadata(partial, metadata)
    return _entry(metadata, digest.hexdigest())


def split_of(seed: int) -> Split:
    """What the seed is for."""
    if seed in DEVELOPMENT_SEEDS:
        return "development"
    return "reporting" if seed in REPORTING_SEEDS else "none"


def _entry_there(place: Path, expected: Metadata) -> Entry:
    """The entry of a recording that is there already; an InputError where it is not the expected one."""
    recording = load_recording(place)
    found = recording.metadata
    if found.scene_digest != expected.scene_digest or found.seed != expected.seed or found.occlusion is None:
        raise InputError(
            f"{place}: expected the recording of seed {expected.seed} that was asked for, got one of another scene: "
            "choose another folder, or pass --overwrite to replace it"
        )
    return _entry(found, recording.digest())


def _entry(metadata: Metadata, digest: str) -> Entry:
    return entry_of(metadata, digest=digest, split=split_of(metadata.seed or 0))
