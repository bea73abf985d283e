"""What is to be solved, settings and corrections by hand; and the command line that does the same."""

import json
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from algorithm.settings import Settings
from algorithm.staged import solve
from algorithm.stages import keys_of
from evaluation.methods import settings_of
from recording.cache import Cache
from recording.checks import validated
from recording.corrections import Corrections
from recording.errors import InputError
from recording.motions import Motions
from recording.recording import Recording


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What the solver is asked for."""

    settings: Settings
    corrections: Corrections

    def solved(self, recording: Recording, cache: Cache | None) -> Motions:
        """What comes of it; InputError where the corrections contradict themselves."""
        # With corrections, even if there are none, motions are kept, so that the next one changes a few of many;
        # the completing of the paper knows none, and is asked for none.
        known = bool(self.corrections.correction) or self.settings.completing == "continuation"
        return solve(recording, self.settings, cache=cache, corrections=self.corrections if known else None)

    def is_near(self, cache: Cache) -> bool:
        """Whether the cache holds what corrections begin with, the segments, so that seconds are enough."""
        key = keys_of(self.corrections.recording_digest, self.settings)["segments"]
        return self.settings.completing == "continuation" and cache.holds(key)


def wish_of(recording: Recording, motions: Motions | None, digest: str) -> Wish:
    """What motions were made of; of motions from elsewhere, or none, the default's settings and no corrections."""
    made = motions.making.corrections if motions is not None else None
    return Wish(settings=_settings(recording, motions), corrections=made or Corrections(recording_digest=digest))


def _settings(recording: Recording, motions: Motions | None) -> Settings:
    made = motions.making.settings if motions is not None else {}
    if not made:
        return settings_of(recording, "default")
    try:
        return validated(Settings, made, source="settings of the motions")
    except InputError:  # Made by another version.
        return settings_of(recording, "default")


def command(wish: Wish, recording: Recording, path: Path | None) -> str:
    """The command line that grants the wish, with the corrections where they are kept; RECORDING is the folder."""
    settings = wish.settings
    plain = settings_of(recording, settings.preset)
    words = ["unocclude", "solve", "RECORDING"]
    if settings.preset != "default":
        words += ["--preset", settings.preset]
    for name in Settings.model_fields:
        value = getattr(settings, name)
        if value != getattr(plain, name):
            words += ["--set", f"{name}={_text(value)}"]
    if wish.corrections.correction and path is not None:
        words += ["--corrections", str(path)]
    return shlex.join(words)


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)
