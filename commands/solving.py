"""Solving recordings: solve."""

import time
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from distributed.system import MEMORY_LIMIT
from pydantic import ByteSize, TypeAdapter, ValidationError

from algorithm.estimate import Estimate, estimated, is_long
from algorithm.settings import Settings, changed_settings, settings_from_file
from algorithm.staged import solve
from commands.common import CACHING, WRITING, Caching, Common, Writing
from evaluation.methods import settings_of
from evaluation.remarks import count_by_hand, why_no_motions
from recording.cache import GIGABYTE
from recording.corrections import load_corrections
from recording.errors import InputError
from recording.motions import Motions
from recording.parquet import save_motions
from recording.recording import Recording
from recording.store import load_recording

MEGABYTE = 10**6
SETTINGS_HELP = "\n".join(
    ["Settings for `--set` and `--settings`, with the values of the preset `default`:", ""]
    + [f"- `{name}` = {field.default}: {field.description}" for name, field in Settings.model_fields.items()]
)


def solve_command(
    recording: Path,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    preset: Literal["default", "paper"] = "default",
    settings: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative="")] = (),
    corrections: Path | None = None,
    max_memory: str | None = None,
    caching: Caching = CACHING,
    common: Writing = WRITING,
) -> None:
    """Find the motions in a recording and complete them where they were hidden.

    Example: `unocclude solve recordings/wall --preset paper --set eps3=5`

    `unocclude solve recordings/9men --corrections recordings/9men/corrections.toml`

    Results of its stages are kept: after another setting is changed, only what depends on that is made again; and what
    was interrupted goes on where it was. Before long work, what it will take is estimated.

    Args:
        recording: The recording's folder.
        output: The Parquet file to write; `motions.parquet` in the recording's folder by default.
        preset: Settings to start from: the best that we know, or the paper's.
        settings: TOML file with settings that replace the preset's.
        set_: `KEY=VALUE`, a setting that replaces the others'; may be given several times.
        corrections: TOML file with what was said by hand of segments and links, from `unocclude view` or written by
            hand (docs/corrections.md).
        max_memory: Such as `4GB`, as nearly as can be told before: depth images that do not fit are read when they are
            needed, and of more points than fit some are kept (`points_apart_px`). By default all that the machine has;
            what needs more is refused.
    """
    place = output or recording / "motions.parquet"
    if place.exists() and not common.overwrite:
        raise InputError(f"{place} exists already: choose another place, or pass --overwrite to replace it")
    found = load_recording(recording)
    chosen = settings_of(found, preset)
    if settings is not None:
        chosen = settings_from_file(chosen, settings)
    chosen = changed_settings(chosen, dict(map(_key_and_value, set_)), source="--set")
    said = load_corrections(corrections) if corrections is not None else None
    memory = _bytes(max_memory) if max_memory is not None else MEMORY_LIMIT
    if max_memory is not None or is_long(found.metadata):
        chosen = _within(memory, found, chosen, common, thin=max_memory is not None)
    begun = time.perf_counter()
    with common.progress():
        motions = solve(found, chosen, cache=caching.chosen(), corrections=said, memory_bytes=memory)
    spent = time.perf_counter() - begun
    save_motions(motions, place, overwrite=common.overwrite)
    common.say(f"solved {place}: {_outcome(found, motions, spent)}")


def _outcome(recording: Recording, motions: Motions, spent: float) -> str:
    """What was found, in how many seconds, and what `evaluate` will call them where stages came from the cache."""
    count, said, total = len(motions.motion_ids), count_by_hand(motions.making), motions.making.seconds["total"]
    took = f"{spent:.1f} s ({total:.1f} s without the cache)" if total > spent else f"{total:.1f} s"
    by_hand = f", with {said} correction{'s' * (said > 1)} by hand" if said else ""
    why = "" if count else f": {why_no_motions(recording, motions)}"
    return f"{count} motion{'s' * (count != 1)} in {took}{by_hand}{why}"


def _within(memory: int, recording: Recording, settings: Settings, common: Common, *, thin: bool) -> Settings:
    """The settings with which so much memory is enough; what solving will take is said. InputError where none are.

    Points are left out only if `thin`: else what is found would depend on the machine.
    """
    about, expected = recording.metadata, estimated(recording, settings, memory_bytes=memory)
    size = f"{about.frames:,} frames of {about.width}x{about.height} pixels"
    points = f"{expected.points / about.frames:,.0f} moving points in each"
    common.say(f"{size}, {points}: about {expected.seconds / 60:.1f} minutes and {_gigabytes(expected)} of memory")
    fitting, limit = expected.within(memory), f"{memory / GIGABYTE:.2f} GB"
    if fitting is None or not (thin or fitting == expected):
        remedy = "make it shorter or its pictures smaller"
        if fitting is not None:
            remedy += f", or pass --max-memory {int(memory / MEGABYTE)}MB to keep fewer points"
        name = about.name or "recording"
        raise InputError(
            f"{name}: expected to need {limit} of memory at most, got about {_gigabytes(expected)}: {remedy}"
        )
    if fitting == expected:
        return settings
    apart = fitting.points_apart_px
    common.say(f"one point in {apart**2} is kept (points_apart_px = {apart}): about {_gigabytes(fitting)} of memory")
    return changed_settings(settings, {"points_apart_px": apart}, source="--max-memory")


def _gigabytes(expected: Estimate) -> str:
    return f"{expected.memory_bytes / GIGABYTE:.1f} GB"


def _bytes(text: str) -> int:
    try:
        size = TypeAdapter(ByteSize).validate_python(text)
    except ValidationError:
        size = ByteSize(0)
    if size <= 0:
        raise InputError(f"--max-memory: expected a size such as 4GB or 500MB, got {text!r}")
    return size


def _key_and_value(text: str) -> tuple[str, Any]:
    """A setting as the command line has it: numbers and booleans as in TOML, else text."""
    key, separator, value = text.partition("=")
    if not separator:
        raise InputError(f"--set: expected KEY=VALUE, got {text!r}")
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except (ValueError, RecursionError):  # No TOML; or too many digits or brackets, which the setting then refuses.
        return key, value
