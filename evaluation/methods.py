"""The methods that can be compared: ours, the baselines, and ours with one stage that knows the truth."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from algorithm.given import Given
from algorithm.pipeline import solve
from algorithm.settings import Settings, preset_settings
from evaluation.gap_closing import GapClosingSettings, gap_closing_motions
from evaluation.oracles import true_flow, true_links, true_segments
from evaluation.tracker import TrackerSettings, track_motions
from recording.motions import Motions
from recording.recording import Recording


@dataclass(frozen=True, kw_only=True)
class Method:
    """A way from a recording to motions."""

    settings: Callable[[Recording], dict[str, Any]]
    """All its settings for the recording."""
    motions: Callable[[Recording], Motions]


def _default(recording: Recording) -> Settings:
    return preset_settings("default")


def _paper(recording: Recording) -> Settings:
    """The paper's preset, with the epsilons that the recording's scene states."""
    return preset_settings("paper", of_scene=(recording.metadata.scene or {}).get("paper"))


def _preset(settings: Callable[[Recording], Settings]) -> Method:
    return Method(
        settings=lambda recording: settings(recording).model_dump(mode="json"),
        motions=lambda recording: solve(recording, settings(recording)),
    )


def _oracle(given: Callable[[Recording], Given]) -> Method:
    return Method(
        settings=lambda recording: _default(recording).model_dump(mode="json"),
        motions=lambda recording: solve(recording, _default(recording), given(recording)),
    )


METHODS: Mapping[str, Method] = {
    "default": _preset(_default),
    "paper": _preset(_paper),
    "tracker": Method(settings=lambda recording: TrackerSettings().model_dump(mode="json"), motions=track_motions),
    "gap_closing": Method(
        settings=lambda recording: GapClosingSettings().model_dump(mode="json"), motions=gap_closing_motions
    ),
    "true_flow": _oracle(true_flow),
    "true_segments": _oracle(true_segments),
    "true_links": _oracle(true_links),
}
"""By the names that `--methods` takes, in the order of the tables."""
