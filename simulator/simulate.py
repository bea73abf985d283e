"""From a scene to a recording: every picture with its truth, exact and repeatable."""

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from recording.achieved import achieved_occlusion
from recording.causes import Tally, tally_of
from recording.checks import finite, validated
from recording.errors import InputError
from recording.frame import Frame
from recording.metadata import CarriedRecord, Metadata, metadata_of
from recording.occlusion import Nearness, Occlusion
from recording.progress import tracked
from recording.recording import Recording
from recording.space import check_room
from recording.store import frame_name, new_recording, write_metadata
from recording.truth import Truth
from recording.version import VERSION
from recording.xray import XRay
from simulator.backend import Backend, BackendWish, find_backend
from simulator.carrying import carried_records
from simulator.clearance import Clearance, smallest_clearance
from simulator.pictures import Stage, pictures
from simulator.scene import Scene, load_scene
from simulator.sensor import on_another_day
from simulator.shares import Written, written_pictures
from simulator.stage import Actor, actors, frame_times, walkers_centres
from simulator.variation import varied


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulation:
    """A scene made ready: everything but its pictures."""

    scene: Scene
    """Resolved: after variation, at the size and length asked for."""
    metadata: Metadata
    """All that is known before the pictures are."""
    cast: tuple[Actor, ...]
    clearance: Clearance
    """How near people come to one another and to obstacles in these frames."""

    @property
    def truth(self) -> Truth:
        """Each object's mesh in every frame."""
        return {actor.record.id: actor.mesh for actor in self.cast}

    @property
    def stage(self) -> Stage:
        """What is to be cast."""
        return Stage(
            camera=self.metadata.as_camera(),
            moving={a.record.id: a.mesh for a in self.cast if a.record.moving},
            restless={a.record.id: a.mesh for a in self.cast if a.mesh.moving and not a.record.moving},
            still={a.record.id: a.mesh for a in self.cast if not (a.mesh.moving or a.record.moving)},
            frames=self.scene.frames,
            sensor=self.scene.sensor,
        )

    def pictures(self, backend: Backend) -> Iterator[tuple[Frame, XRay]]:
        """Each frame with its X-ray twin, one after the other, none kept."""
        return tracked(pictures(self.stage, backend), f"simulating {self.scene.name}", total=self.scene.frames)

    def described(self, tallies: Sequence[Tally]) -> Metadata:
        """The metadata with the occlusion that the frames, whose tallies these are in their order, have achieved."""
        people, obstacles = (round(value, 6) for value in (self.clearance.people_m, self.clearance.obstacles_m))
        nearness = Nearness(people=finite(people), obstacles=finite(obstacles))
        achieved = achieved_occlusion(tallies, self.metadata, clearance_m=nearness)
        wish = self.scene.occlusion
        wanted = None if wish is None else wish.model_dump(mode="json", exclude_none=True)
        return self.metadata.model_copy(update={"occlusion": Occlusion(wanted=wanted, achieved=achieved)})


def prepared(
    scene: str | Path | Scene,
    *,
    seed: int = 0,
    size: str | tuple[int, int] | None = None,
    frames: int | None = None,
    sensor: str | None = None,
) -> Simulation:
    """The scene under the seed, ready to be cast.

    `size`, in pixels, is (width, height), `640x480`, or `2x` for twice the scene's own; it changes the picture,
    not the horizontal field of view. `frames` cuts the scene short or lets it go on, `sensor` names another
    preset; what is None is as the scene says.
    """
    given = scene if isinstance(scene, Scene) else load_scene(scene)
    pixels = picture_size(size, (given.camera.width, given.camera.height)) if isinstance(size, str) else size
    changed = changed_scene(varied(given, seed), size=pixels, frames=frames, sensor=sensor)
    return made_ready(changed, seed=seed)


def made_ready(scene: Scene, *, seed: int) -> Simulation:
    """The scene as it is, ready to be cast: of the seed there is only the sensor's noise, and its number."""
    resolved = scene.model_copy(update={"sensor": on_another_day(scene.sensor, seed)})
    cast = actors(resolved)
    document = resolved.model_dump(mode="json")
    metadata = metadata_of(
        resolved.camera.as_camera(),
        frames=resolved.frames,
        fps=resolved.fps,
        name=resolved.name,
        sensor=resolved.sensor.model_dump(mode="json"),
        seed=seed,
        objects=tuple(actor.record for actor in cast),
        carried=_carried(resolved, cast),
        scene=document,
        scene_digest=digest_of(document),
        made_by=f"unocclude {VERSION}",
    )
    clearance = smallest_clearance(walkers_centres(resolved), resolved.obstacles)
    _require_room(resolved, clearance)
    return Simulation(scene=resolved, metadata=metadata, cast=cast, clearance=clearance)


def simulate(
    scene: str | Path | Scene,
    *,
    seed: int = 0,
    size: str | tuple[int, int] | None = None,
    frames: int | None = None,
    sensor: str | None = None,
    backend: BackendWish = "auto",
) -> Recording:
    """The recording of a scene (a name, a TOML file or a `Scene`), in memory."""
    simulation = prepared(scene, seed=seed, size=size, frames=frames, sensor=sensor)
    pictures = list(simulation.pictures(find_backend(backend)))
    tallies = [tally_of(frame, xray, simulation.metadata) for frame, xray in pictures]
    return Recording(
        metadata=simulation.described(tallies),
        frames=tuple(frame for frame, _ in pictures),
        truth=simulation.truth,
        xray=tuple(xray for _, xray in pictures),
    )


def write_simulation(
    simulation: Simulation,
    folder: Path,
    *,
    backend: BackendWish = "auto",
    workers: int = 1,
    overwrite: bool = False,
) -> None:
    """Cast the pictures straight to the folder: each worker has one in memory at a time.

    Workers are processes; their number changes no byte. More than there are cores make nothing faster.
    """
    scene, metadata = simulation.scene, simulation.metadata
    with new_recording(folder, truth=simulation.truth, overwrite=overwrite) as partial:
        written = written_pictures(
            simulation.stage, partial, metadata=metadata, backend=find_backend(backend), workers=workers
        )
        with closing(written):
            roomy = _with_room(written, partial, scene.frames)
            found = list(tracked(roomy, f"simulating {scene.name}", total=scene.frames))
        tallies = [each.tally for each in sorted(found, key=lambda each: each.number)]
        write_metadata(partial, simulation.described(tallies))


def _with_room(written: Iterable[Written], partial: Path, frames: int) -> Iterator[Written]:
    """The pictures as they are written; InputError after the first one where the disk has no room for so many."""
    for count, picture in enumerate(written):
        if not count:
            own = sum(file.stat().st_size for file in partial.glob(f"*/{frame_name(picture.number)}"))
            check_room(own * frames, partial.parent)
        yield picture


def picture_size(text: str, own: tuple[int, int]) -> tuple[int, int]:
    """Width and height in pixels that `640x480`, or `2x` for twice the scene's own, stands for."""
    if match := re.fullmatch(r"([1-9]\d*)x([1-9]\d*)", text):
        return int(match[1]), int(match[2])
    if match := re.fullmatch(r"([1-9]\d*)x", text):
        return int(match[1]) * own[0], int(match[1]) * own[1]
    raise InputError(f"expected a picture size such as 640x480 or 2x, got {text!r}")


def _carried(scene: Scene, cast: Sequence[Actor]) -> tuple[CarriedRecord, ...] | None:
    """Which ball lies in whose hand, and when; None where no ball does."""
    ids = [actor.record.id for actor in cast if actor.record.kind == "ball"]  # Juggled balls come first.
    balls = dict(zip(ids[len(ids) - len(scene.balls) :], scene.balls, strict=True))
    return carried_records(scene.people, balls, frame_times(scene)) or None


def _require_room(scene: Scene, clearance: Clearance) -> None:
    """Raise where somebody goes through another or through an obstacle, unless the scene is a stress test."""
    wanted = ((clearance.people_m, scene.vary.clearance_m), (clearance.obstacles_m, scene.vary.obstacle_clearance_m))
    if not scene.stress_test and any(found < least - 1e-9 for found, least in wanted):
        raise InputError(
            f"scene {scene.name!r}: expected {wanted[0][1]:g} m between the centres of people and {wanted[1][1]:g} m "
            f"to obstacles, got {clearance.sentence}: move the paths, lower [vary] clearance_m or "
            "obstacle_clearance_m, or call it a stress_test"
        )


def changed_scene(scene: Scene, *, size: tuple[int, int] | None, frames: int | None, sensor: str | None) -> Scene:
    """The scene with what was asked for in place of what it says, held against the schema again."""
    document = scene.model_dump() | {"people": scene.people}  # As they are: a dump forgets where motion files lie.
    if size is not None:
        document["camera"] |= {"width": size[0], "height": size[1]}
    if frames is not None:
        document["frames"] = frames
    if sensor is not None:
        document["sensor"] = {"preset": sensor}
    return validated(Scene, document, source=f"scene {scene.name!r}")


def digest_of(document: dict[str, object]) -> str:
    """SHA-256 of the document as canonical JSON: sorted keys, no spaces."""
    canonical = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()
