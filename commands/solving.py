"""Solving recordings: solve."""

import time
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from algorithm.settings import Settings, changed_settings, settings_from_file
from algorithm.staged import solve
from commands.common import CACHING, WRITING, Caching, Writing
from evaluation.methods import settings_of
from recording.corrections import load_corrections
from recording.errors import InputError
from recording.parquet import save_motions
from recording.store import load_recording

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
    caching: Caching = CACHING,
    common: Writing = WRITING,
) -> None:
    """Find the motions in a recording and complete them where they were hidden.

    Example: `unocclude solve recordings/wall --preset paper --set eps3=5`

    `unocclude solve recordings/9men --corrections recordings/9men/corrections.toml`

    Results of its stages are kept: after another setting is changed, only what depends on that is made again.

    Args:
        recording: The recording's folder.
        output: The Parquet file to write; `motions.parquet` in the recording's folder by default.
        preset: Settings to start from: the best that we know, or the paper's.
        settings: TOML file with settings that replace the preset's.
        set_: `KEY=VALUE`, a setting that replaces the others'; may be given several times.
        corrections: TOML file with what was said by hand of segments and links, from `unocclude view` or written by
            hand (docs/corrections.md).
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
    begun = time.perf_counter()
    with common.progress():
        motions = solve(found, chosen, cache=caching.chosen(), corrections=said)
    spent = time.perf_counter() - begun
    save_motions(motions, place, overwrite=common.overwrite)
    total = motions.making.seconds["total"]
    again = f" ({total:.1f} s without the cache)" if total > 2 * spent else ""
    common.say(f"solved {place}: {len(motions.motion_ids)} motions in {spent:.1f} s{again}")


def _key_and_value(text: str) -> tuple[str, Any]:
    """A setting as the command line has it: numbers and booleans as in TOML, else text."""
    key, separator, value = text.partition("=")
    if not separator:
        raise InputError(f"--set: expected KEY=VALUE, got {text!r}")
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except (ValueError, RecursionError):  # No TOML; or too many digits or brackets, which the setting then refuses.
        return key, value
