"""Making recordings: simulate, generate, resense."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from cyclopts.validators import Number

from commands.common import SCALING, WRITING, Output, Scaling, Writing
from recording.errors import InputError
from recording.store import load_recording
from simulator.family import family_names, load_family
from simulator.generate import generate
from simulator.order import Order
from simulator.resense import write_resensed
from simulator.scene import scene_names
from simulator.simulate import prepared, write_simulation

Backend = Literal["auto", "llvm", "scalar"]
SCENES_HELP = "Scenes: " + ", ".join(scene_names())
FAMILIES_HELP = "Families: " + ", ".join(family_names())


def simulate_command(
    *scenes: str,
    output: Output,
    seed: int = 0,
    frames: int | None = None,
    size: str | None = None,
    sensor: str | None = None,
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    backend: Backend = "auto",
    common: Writing = WRITING,
) -> None:
    """Render scenes to recordings `OUTPUT/<name>/`, with the truth about everything hidden.

    Example: `unocclude simulate wall -o recordings --seed 1`

    Args:
        scenes: Names of shipped scenes, or paths of TOML files.
        output: Folder for the recordings.
        seed: 0 is the scene itself; any other number is the same scene on another day.
        frames: Number of frames in place of the scene's own.
        size: Picture size in pixels, `640x480`, or `2x` for twice the scene's own.
        sensor: Sensor preset in place of the scene's own: `ideal`, `kinect1`, `tof`, `structured_light` or `stereo`.
        workers: Processes that cast and write frames; the files are the same for any number.
        backend: Ray caster: compiled (`llvm`), interpreted (`scalar`), or what works here.
    """
    if not scenes:
        raise InputError("expected at least one scene, got none: try 'unocclude simulate wall -o recordings'")
    for name in scenes:
        simulation = prepared(name, seed=seed, size=size, frames=frames, sensor=sensor)
        place = output / simulation.scene.name
        with common.progress():
            write_simulation(simulation, place, backend=backend, workers=workers, overwrite=common.overwrite)
        common.say(f"simulated {place}: {simulation.scene.frames} frames, {simulation.clearance.sentence}")


def generate_command(
    family: str,
    *,
    count: Annotated[int, Parameter(validator=Number(gte=1))],
    output: Annotated[str, Parameter(name=["--output", "-o"])],
    seed: Annotated[int, Parameter(validator=Number(gte=0))] = 1,
    size: str | None = None,
    sensor: str | None = None,
    backend: Backend = "auto",
    scaling: Scaling = SCALING,
    common: Writing = WRITING,
) -> None:
    """Make a data set of random scenes: recordings `OUTPUT/<family>-<seed>/`, and `OUTPUT/manifest.json`.

    Example: `unocclude generate crowded --count 20 -o data`

    The same call again keeps the recordings that are there and makes the others. Seeds 1 to 999 are for development,
    1000 to 1999 for reporting.

    Args:
        family: Name of a shipped family, or path of a TOML file.
        count: How many recordings, of as many seeds in a row.
        output: Folder for the recordings, which all workers must see, or a URL that fsspec knows, `s3://bucket/data`.
        seed: The first seed.
        size: Picture size in pixels, `640x480`, or `2x` for twice the family's own.
        sensor: Sensor preset in place of the family's own, as for `simulate`.
        backend: Ray caster: compiled (`llvm`), interpreted (`scalar`), or what works where it is cast.
    """
    order = Order(
        family=load_family(family),
        folder=output if "://" in output else Path(output).absolute(),
        sensor=sensor,
        size=size,
        overwrite=common.overwrite,
    )
    seeds = range(seed, seed + count)
    try:
        with common.progress(), scaling.team_if_needed(common, tasks=count) as client:
            done = generate(order, seeds=seeds, backend=backend, client=client)
    finally:
        order.shelf.tidy()  # Once more: workers that were interrupted have ended only now.
    if done.recordings:
        common.say(f"generated {output}: {done.sentence}")
    if done.refusal is not None:
        raise InputError(done.refusal)


def resense_command(
    recording: Path,
    *,
    sensor: str,
    output: Output,
    seed: Annotated[int | None, Parameter(validator=Number(gte=0))] = None,
    common: Writing = WRITING,
) -> None:
    """See a simulated recording with another sensor: the same truth, other depths; no picture is cast again.

    Example: `unocclude resense recordings/wall --sensor tof -o recordings/wall-tof`

    Args:
        recording: The recording's folder.
        sensor: Sensor preset: `ideal`, `kinect1`, `tof`, `structured_light` or `stereo`.
        output: The recording to make.
        seed: Of the sensor's noise; the recording's own by default, as if the scene were simulated with the sensor.
    """
    if output.resolve().is_relative_to(recording.resolve()):
        raise InputError(f"{output}: expected another folder than the recording's, which it would replace or fill")
    with common.progress():
        write_resensed(load_recording(recording), sensor, output, seed=seed, overwrite=common.overwrite)
    common.say(f"sensed {output} with {sensor}")
