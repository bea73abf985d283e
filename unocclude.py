"""Unocclude: simulate crowds before a depth camera, find what moves together, complete what was hidden.

The command line (`unocclude --help`) and the public names. In Python the verbs are the same, on values
instead of files:

    import unocclude

    recording = unocclude.simulate("wall", seed=1)
    motions = unocclude.solve(recording)
    print(unocclude.evaluate(recording, motions)["completion"]["centre_mean_m"])
"""

import json
import os
import re
import sys
import tomllib
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

from cyclopts import App, CycloptsError, Parameter
from cyclopts.validators import Number
from rich.console import Console

from algorithm.depth_image import depth_range
from algorithm.pipeline import solve
from algorithm.settings import Preset, Settings, changed_settings, preset_settings, settings_from_file
from evaluation.compare import compared
from evaluation.compare_tables import comparison_document, comparison_text, write_comparison
from evaluation.contact_sheet import draw_contact_sheet
from evaluation.doctor import diagnosis
from evaluation.figures.catalogue import FIGURES, chosen_figures, draw_figures
from evaluation.kept import Kept
from evaluation.methods import METHODS
from evaluation.picture import draw_overview
from evaluation.scores import check_belongs, evaluate, scores
from evaluation.summary import summary
from evaluation.table1 import PRESETS, measured_rows
from evaluation.table1_text import require_no_tables, tables_of, text_of, write_tables
from recording.atomic import whole_file
from recording.causes import causes_of
from recording.correspondence import flow_between, places_of, track
from recording.errors import InputError
from recording.importing import Calibration, import_images
from recording.manifest import MANIFEST, load_manifest, recordings_of
from recording.motions import Motions
from recording.parquet import load_motions, save_motions
from recording.progress import progress_shown
from recording.recording import Recording
from recording.store import load_recording, save_recording
from recording.verify import Report, verify
from recording.verify_set import SetReport, verify_set
from recording.version import VERSION
from recording.visibility import visibility_of
from simulator.family import family_names, load_family
from simulator.generate import generate
from simulator.order import Order
from simulator.resense import resense, write_resensed
from simulator.scene import scene_names
from simulator.simulate import prepared, simulate, write_simulation

__all__ = [
    "InputError",
    "Motions",
    "Order",
    "Recording",
    "Settings",
    "causes_of",
    "evaluate",
    "flow_between",
    "generate",
    "load_family",
    "load_manifest",
    "load_motions",
    "load_recording",
    "places_of",
    "preset_settings",
    "recordings_of",
    "resense",
    "save_motions",
    "save_recording",
    "simulate",
    "solve",
    "track",
    "verify",
    "visibility_of",
]

messages = Console(stderr=True, soft_wrap=True, highlight=False)
app = App(
    name="unocclude",
    help="Simulate crowds before a depth camera, find what moves together, complete what was hidden.",
    version=VERSION,
    help_format="markdown",
)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Common:
    """What every command takes."""

    quiet: Annotated[bool, Parameter(negative="")] = False
    """No messages and no progress bar; results are printed all the same."""

    def say(self, message: str) -> None:
        """A message on standard error, unless it is to be quiet."""
        if not self.quiet:
            messages.print(message, markup=False)

    def progress(self) -> AbstractContextManager[None]:
        """Within this block long work shows a progress bar, unless it is to be quiet."""
        return nullcontext() if self.quiet else progress_shown(messages)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Writing(Common):
    """What every command takes that writes files."""

    overwrite: Annotated[bool, Parameter(negative="")] = False
    """Replace results that exist already, with everything in their folders."""


COMMON, WRITING = Common(), Writing()
SETTINGS_HELP = "\n".join(
    ["Settings for `--set` and `--settings`, with the values of the preset `default`:", ""]
    + [f"- `{name}` = {field.default}: {field.description}" for name, field in Settings.model_fields.items()]
)
Backend = Literal["auto", "llvm", "scalar"]
Output = Annotated[Path, Parameter(name=["--output", "-o"])]


@app.command
def demo(*, output: Output = Path("demo"), seed: int = 0, common: Writing = WRITING) -> None:
    """Run the main job on the scene `wall`: simulate, solve, evaluate, draw.

    Example: `unocclude demo -o demo`

    Args:
        output: Folder for the recording, the motions, the scores and the picture.
        seed: 0 is the scene itself; any other number is the same scene on another day.
    """
    simulation = prepared("wall", seed=seed)
    place = output / simulation.scene.name
    with common.progress():
        write_simulation(simulation, place, overwrite=common.overwrite)
    common.say(f"simulated {place}: {simulation.scene.frames} frames, {simulation.clearance.sentence}")
    solve_command(place, common=common)
    recording, motions = load_recording(place), load_motions(place / "motions.parquet")
    found = evaluate(recording, motions)
    with whole_file(output / "scores.json", overwrite=common.overwrite) as partial:
        partial.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    draw_overview(recording, motions, output / "overview.png", overwrite=common.overwrite)
    print(summary(found))
    print(f"pictures: {output / 'overview.png'}")


@app.command(name="simulate", help_epilogue="Scenes: " + ", ".join(scene_names()))
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
        sensor: Sensor preset in place of the scene's own.
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


@app.command(name="generate", help_epilogue="Families: " + ", ".join(family_names()))
def generate_command(
    family: str,
    *,
    count: Annotated[int, Parameter(validator=Number(gte=1))],
    output: Output,
    seed: Annotated[int, Parameter(validator=Number(gte=0))] = 1,
    size: str | None = None,
    sensor: str | None = None,
    workers: Annotated[int | None, Parameter(validator=Number(gte=1))] = None,
    backend: Backend = "auto",
    common: Writing = WRITING,
) -> None:
    """Make a data set of random scenes: recordings `OUTPUT/<family>-<seed>/`, and `OUTPUT/manifest.json`.

    Example: `unocclude generate crowded --count 20 -o data`

    The same call again keeps the recordings that are there and makes the others. Seeds 1 to 999 are for development,
    1000 to 1999 for reporting.

    Args:
        family: Name of a shipped family, or path of a TOML file.
        count: How many recordings, of as many seeds in a row.
        output: Folder for the recordings.
        seed: The first seed.
        size: Picture size in pixels, `640x480`, or `2x` for twice the family's own.
        sensor: Sensor preset in place of the family's own.
        workers: Processes that make recordings, one for each core by default; the files are the same for any number.
        backend: Ray caster: compiled (`llvm`), interpreted (`scalar`), or what works here.
    """
    order = Order(family=load_family(family), folder=output, sensor=sensor, size=size, overwrite=common.overwrite)
    processes = workers or os.cpu_count() or 1
    with common.progress():
        done = generate(order, seeds=range(seed, seed + count), workers=processes, backend=backend)
    if done.recordings:
        common.say(f"generated {output}: {done.sentence}")
    if done.refusal is not None:
        raise InputError(done.refusal)


@app.command(name="resense")
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
    with common.progress():
        write_resensed(load_recording(recording), sensor, output, seed=seed, overwrite=common.overwrite)
    common.say(f"sensed {output} with {sensor}")


@app.command(name="import")
def import_command(
    source: Path,
    *,
    output: Output,
    fx: float,
    fy: float,
    cx: float,
    cy: float,
    fps: float,
    scale: float = 0.001,
    pixel_centre: float = 0.0,
    pattern: str = "*.png",
    masks: str | None = None,
    common: Writing = WRITING,
) -> None:
    """Make a recording of a folder of 16-bit depth images.

    Example: `unocclude import depth/ --scale 0.001 --fx 365 --fy 365 --cx 256 --cy 212 --fps 30 -o recording`

    Args:
        source: Folder of the images; they are taken in the order of the numbers in their names.
        output: The recording to make.
        fx: Focal length along the columns, pixels.
        fy: Focal length along the rows, pixels.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        fps: Frames a second.
        scale: Metres of one unit of the stored numbers; TUM RGB-D has 0.0002.
        pixel_centre: Where the calibration has the centre of pixel (0, 0): 0, as most do, or 0.5.
        pattern: Names of the depth images.
        masks: Names of images of object ids, one for each depth image, for the evaluation.
    """
    calibration = Calibration(fx=fx, fy=fy, cx=cx, cy=cy, fps=fps, scale=scale, pixel_centre=pixel_centre)
    overwrite = common.overwrite
    with common.progress():
        made = import_images(source, output, calibration=calibration, pattern=pattern, masks=masks, overwrite=overwrite)
    first = load_recording(output).frames[0]
    low, high = depth_range([first.depth])
    common.say(
        f"imported {made.frames} frames of {made.width}x{made.height} to {output}; the first has depths from "
        f"{low:.2f} to {high:.2f} m and no return at {1 - first.seen.mean():.0%} of its pixels"
    )


@app.command(name="solve", help_epilogue=SETTINGS_HELP)
def solve_command(
    recording: Path,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    preset: Literal["default", "paper"] = "default",
    settings: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="")] = (),
    common: Writing = WRITING,
) -> None:
    """Find the motions in a recording and complete them where they were hidden.

    Example: `unocclude solve recordings/wall --preset paper --set eps3=5`

    Args:
        recording: The recording's folder.
        output: The Parquet file to write; `motions.parquet` in the recording's folder by default.
        preset: Settings to start from: the best that we know, or the paper's.
        settings: TOML file with settings that replace the preset's.
        set_: `KEY=VALUE`, a setting that replaces the others'; may be given several times.
    """
    place = output or recording / "motions.parquet"
    if place.exists() and not common.overwrite:
        raise InputError(f"{place} exists already: choose another place, or pass --overwrite to replace it")
    found = load_recording(recording)
    chosen = preset_settings(preset, of_scene=(found.metadata.scene or {}).get("paper"))
    if settings is not None:
        chosen = settings_from_file(chosen, settings)
    chosen = changed_settings(chosen, dict(map(_key_and_value, set_)), source="--set")
    with common.progress():
        motions = solve(found, chosen)
    save_motions(motions, place, overwrite=common.overwrite)
    total = motions.making.seconds["total"]
    common.say(f"solved {place}: {len(motions.motion_ids)} motions in {total:.1f} s")


@app.command(name="evaluate")
def evaluate_command(
    recording: Path,
    motions: Path | None = None,
    *,
    json_: Annotated[bool, Parameter(name="--json")] = False,
    common: Common = COMMON,
) -> None:
    """Score motions against the truth.

    Example: `unocclude evaluate recordings/wall --json`

    Args:
        recording: The recording's folder.
        motions: The Parquet file; `motions.parquet` in the recording's folder by default.
        json_: One JSON object in place of a table.
    """
    truth, answer = load_recording(recording), load_motions(motions or recording / "motions.parquet")
    warning = check_belongs(truth, answer)
    if warning is not None:
        common.say(f"warning: {warning}")
    if all(frame.labels is None for frame in truth.frames[:1]):
        common.say("warning: the recording holds no truth to score against: import it with --masks")
    with common.progress():
        found = scores(truth, answer)
    print(json.dumps(found, allow_nan=False) if json_ else summary(found))


@app.command(name="verify")
def verify_command(
    recording: Path,
    *,
    workers: Annotated[int | None, Parameter(validator=Number(gte=1))] = None,
    common: Common = COMMON,
) -> None:
    """Check a simulated recording, or a whole data set, against itself; exit status 1 where a bound is passed.

    Example: `unocclude verify recordings/wall`

    Args:
        recording: The recording's folder, or that of a data set with its `manifest.json`.
        workers: Processes that verify the recordings of a data set, one for each core by default.
    """
    with common.progress():
        if (recording / MANIFEST).is_file():
            found: Report | SetReport = verify_set(recording, workers=workers or os.cpu_count() or 1)
        else:
            found = verify(load_recording(recording))
    print(found.text)
    if not found.passes:
        sys.exit(1)


@app.command(name="draw")
def draw_command(recording: Path, motions: Path | None = None, *, output: Output, common: Writing = WRITING) -> None:
    """Draw a solved recording: frames, segments, representatives, completed motion.

    Example: `unocclude draw recordings/wall -o wall.png`

    Args:
        recording: The recording's folder.
        motions: The Parquet file; `motions.parquet` in the recording's folder by default.
        output: The picture, PNG or SVG by its ending.
    """
    truth, answer = load_recording(recording), load_motions(motions or recording / "motions.parquet")
    check_belongs(truth, answer)
    draw_overview(truth, answer, output, overwrite=common.overwrite)
    common.say(f"drawn {output}")


@app.command(name="contact-sheet")
def contact_sheet_command(recording: Path, *, output: Output, common: Writing = WRITING) -> None:
    """Draw six frames of a recording: depth, objects, and why returns are missing.

    Example: `unocclude contact-sheet recordings/wall -o sheet.png`

    Args:
        recording: The recording's folder.
        output: The picture, PNG or SVG by its ending.
    """
    draw_contact_sheet(load_recording(recording), output, overwrite=common.overwrite)
    common.say(f"drawn {output}")


@app.command(name="table1")
def table1_command(
    *,
    scenes: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = ("all",),
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    preset: Preset | None = None,
    counts_only: Annotated[bool, Parameter(negative="")] = False,
    size: str | None = None,
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    common: Writing = WRITING,
) -> None:
    """Print Table 1 of the paper beside ours: what the scenes hold, and what is found in them.

    Example: `unocclude table1 --scenes wall house -o table1`

    Args:
        scenes: Names of scenes, or `all`.
        output: Folder for `table1.csv`, `table1.md` and `table1.tex`, and to keep recordings and motions in: the next
            call with the same folder uses them again.
        preset: Settings to solve with; both presets, one after the other, by default.
        counts_only: Count what the recordings hold and solve nothing.
        size: Picture size in place of the scenes' own, such as `2x`.
        workers: Processes that cast, or that solve; with several, the times are those of scenes that share the machine.
    """
    presets = () if counts_only else (preset,) if preset else PRESETS
    if output is not None:
        require_no_tables(output, overwrite=common.overwrite)
    with common.progress(), TemporaryDirectory() as passing:
        kept = Kept(folder=output or Path(passing), size=size, workers=workers, overwrite=common.overwrite)
        rows = measured_rows(scenes, kept, presets)
    if output is not None:
        write_tables(rows, output, overwrite=common.overwrite)
    print(text_of(tables_of(rows)))


@app.command(name="compare", help_epilogue="Methods: " + ", ".join(METHODS))
def compare_command(
    *recordings: Path,
    methods: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = tuple(METHODS),
    motions: Annotated[tuple[str, ...], Parameter(negative="")] = (),
    output: Output = Path("comparison"),
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    json_: Annotated[bool, Parameter(name="--json")] = False,
    common: Writing = WRITING,
) -> None:
    """Score methods side by side: our presets, the baselines, and ours with one stage that knows the truth.

    Example: `unocclude compare recordings/wall recordings/house --methods default,tracker -o comparison`

    Args:
        recordings: Folders of recordings, or of data sets with a `manifest.json`.
        methods: Names of methods, separated by commas or blanks.
        motions: `NAME=FOLDER`, a method from elsewhere: the folder holds `<recording>.parquet` or
            `<recording>/motions.parquet` for every recording. May be given several times.
        output: Folder for the tables, the plot, and every outcome: the same call again goes on where it ended, and
            makes again what depends on something that has changed. With `--overwrite` all is made again.
        workers: Processes at work at the same time.
        json_: One JSON object in place of tables.
    """
    elsewhere = {name: Path(folder) for name, folder in map(_name_and_folder, motions)}
    names = [name for text in methods for name in text.split(",") if name]
    with common.progress():
        outcomes = compared(
            recordings, output, methods=names, elsewhere=elsewhere, workers=workers, overwrite=common.overwrite
        )
    write_comparison(outcomes, output)
    print(json.dumps(comparison_document(outcomes), allow_nan=False) if json_ else comparison_text(outcomes))
    for outcome in outcomes:
        if outcome.failure is not None:
            common.say(f"warning: {outcome.method} failed on {outcome.recording}: {outcome.failure}")


@app.command(name="figure", help_epilogue="Figures: " + ", ".join(FIGURES))
def figure_command(
    *numbers: str,
    output: Output,
    preset: Preset = "default",
    size: str | None = None,
    frames: int | None = None,
    workers: Annotated[int, Parameter(validator=Number(gte=1))] = 1,
    common: Writing = WRITING,
) -> None:
    """Draw figures of the paper from our recordings and motions, as PNG and SVG.

    Example: `unocclude figure 3 10 -o figures`

    Args:
        numbers: The paper's numbers, or `all`.
        output: Folder for the pictures, and to keep recordings and motions in: the next call with the same folder, of
            `table1` too, uses them again.
        preset: Settings to solve with.
        size: Picture size in place of the scenes' own, such as `2x`.
        frames: Number of frames in place of the scenes' own.
        workers: Processes that cast, or that solve.
    """
    if not numbers:
        raise InputError("expected at least one figure, got none: try 'unocclude figure 3 -o figures'")
    with common.progress():
        kept = Kept(folder=output, size=size, frames=frames, workers=workers, overwrite=common.overwrite)
        drawn = draw_figures(chosen_figures(numbers), kept, preset, folder=output, overwrite=common.overwrite)
    common.say(f"drawn {', '.join(map(str, drawn))}")


@app.command
def doctor(*, common: Common = COMMON) -> None:
    """Tell what this machine has: versions, rendering backend, cores, and what is missing.

    Example: `unocclude doctor`
    """
    print(diagnosis())


def main(arguments: list[str] | None = None) -> None:
    """Run the command line: exit status 0 done, 1 a check failed, 2 the input or the arguments are wrong."""
    try:
        app(arguments, exit_on_error=False, print_error=False)
    except (InputError, CycloptsError) as error:
        messages.print("unocclude: " + " ".join(str(error).split()), markup=False)
        sys.exit(2)
    except KeyboardInterrupt:
        messages.print("unocclude: interrupted; nothing half-written is left")
        sys.exit(130)


def _name_and_folder(text: str) -> tuple[str, str]:
    """A method from elsewhere as the command line has it."""
    name, _, folder = text.partition("=")
    if not re.fullmatch(r"[A-Za-z0-9][\w.-]*", name) or not folder:
        raise InputError(f"--motions: expected NAME=FOLDER with a name of letters, digits, '_', '-', got {text!r}")
    return name, folder


def _key_and_value(text: str) -> tuple[str, Any]:
    """A setting as the command line has it: numbers and booleans as in TOML, else text."""
    key, separator, value = text.partition("=")
    if not separator:
        raise InputError(f"--set: expected KEY=VALUE, got {text!r}")
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key, value


if __name__ == "__main__":
    main()
