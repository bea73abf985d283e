"""The stages of Algorithm 1: what each reads, what it makes, and the key that its result is kept under.

A stage is a pure function of the recording, of the settings up to its own and of the stage before. So its key says all
that it was made of: the stage before's key (of the first: the recording's digest), its settings, its code.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Literal, get_args

import numpy as np
from jaxtyping import Int

from algorithm.followed import Followed
from algorithm.moving_flows import MovingFlows
from algorithm.settings import Settings
from recording.cache import key_of
from recording.code import code_digest

Stage = Literal["flow", "trajectories", "segments", "motions"]
STAGES: tuple[Stage, ...] = get_args(Stage)
FIRST_FIELD: Mapping[Stage, str] = {
    "flow": "remove_static",
    "trajectories": "chaining",
    "segments": "clustering",
    "motions": "completing",
}
"""The first setting of each stage: they stand in the order of the stages, and each belongs to one of them.

What stands before is a mere name.
"""
MODULES: Mapping[Stage, tuple[str, ...]] = {
    "flow": ("algorithm.at_hand", "algorithm.moving_flows", "algorithm.scene_flow", "algorithm.static"),
    "trajectories": (
        "algorithm.chaining",
        "algorithm.followed",
        "algorithm.following",
        "algorithm.matching",
        "algorithm.observations",
        "algorithm.patches",
        "algorithm.spacing",
        "algorithm.trajectories",
    ),
    "segments": ("algorithm.clustering", "algorithm.continued"),
    "motions": ("algorithm.bottom_up", "algorithm.continued", "algorithm.corrections", "algorithm.result"),
}
"""What each stage is made by: with all that these import, and the text of `_TOGETHER`, its code."""
_TOGETHER = (
    "algorithm.flow_parts",
    "algorithm.kept_stages",
    "algorithm.pipeline",
    "algorithm.staged",
    "algorithm.stages",
)
_TOLD = ("algorithm.settings",)
"""Its values stand in the keys; its text does not matter."""
_SHOWN = ("recording.drawing", "recording.markup", "recording.palette")
"""How values look when they are shown changes no result."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Flowing:
    """What the first stage makes of some consecutive frames."""

    flows: MovingFlows
    seconds: Mapping[str, float]
    """That it took to make, by step."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Observed:
    """What the second stage makes."""

    followed: Followed
    seconds: Mapping[str, float]
    """That this and all before took to make, by step."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Grouped:
    """What the third stage makes."""

    followed: Followed
    segments: Int[np.ndarray, "trajectory"]
    """-1 for noise."""
    seconds: Mapping[str, float]
    """That this and all before took to make, by step."""


class _Readable(Settings):
    """Settings of which only those of some stages can be read."""

    def __getattr__(self, name: str) -> object:
        """Told only of what is not there."""
        if name in Settings.model_fields:
            raise AttributeError(
                f"the setting {name!r} belongs to the stage {stage_of(name)!r}, but an earlier one reads it: "
                "move it up in algorithm/settings.py"
            )
        raise AttributeError(name)


def stage_of(field: str) -> Stage | None:
    """The stage that a setting belongs to: the first that reads it; None of the preset's name."""
    order = list(Settings.model_fields)
    begun = [stage for stage in STAGES if order.index(FIRST_FIELD[stage]) <= order.index(field)]
    return begun[-1] if begun else None


@cache
def fields_of(*stages: Stage) -> frozenset[str]:
    """The settings that belong to the stages."""
    return frozenset(name for name in Settings.model_fields if stage_of(name) in stages)


def readable(settings: Settings, stage: Stage) -> Settings:
    """The settings as the stage may read them: those of later stages are not there, and no key is wrong for them."""
    names = fields_of(*STAGES[: STAGES.index(stage) + 1])
    bare = _Readable.model_construct()
    bare.__dict__.clear()
    bare.__dict__.update({name: getattr(settings, name) for name in names})
    return bare


def keys_of(recording_digest: str, settings: Settings) -> dict[Stage, str]:
    """The key of each stage's result."""
    before, keys = recording_digest, {}
    for stage in STAGES:
        document = {
            "before": before,
            "settings": settings.model_dump(mode="json", include=set(fields_of(stage))),
            "code": code_digest(*MODULES[stage], alone=_TOGETHER, apart=_TOLD + _SHOWN),
        }
        keys[stage] = before = key_of(stage, document)
    return keys
