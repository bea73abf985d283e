"""The methods that can be compared: ours, the baselines, and ours with one stage that knows the truth."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from algorithm.given import NOTHING_GIVEN, Given
from algorithm.pipeline import solve
from algorithm.settings import Preset, Settings, preset_settings
from evaluation.gap_closing import GapClosingSettings, gap_closing_motions
from evaluation.oracles import true_flow, true_links, true_segments
from evaluation.tracker import TrackerSettings, track_motions
from recording.motions import Motions
from recording.recording import Recording, stripped


@dataclass(frozen=True, kw_only=True)
class Method:
    """A way from a recording to motions."""

    settings: Callable[[Recording], dict[str, Any]]
    """All its settings for the recording; told before it sees the recording."""
    solver: Callable[[Recording, dict[str, Any]], Motions]
    """From what it sees of the recording, and its settings."""
    sees_truth: bool = False
    """Whether it sees the whole recording; any other sees what a real sensor gives."""

    def motions(self, recording: Recording) -> Motions:
        """What it makes of the recording."""
        seen = recording if self.sees_truth else stripped(recording)
        return self.solver(seen, self.settings(recording))


def settings_of(recording: Recording, preset: Preset) -> Settings:
    """The settings of a preset for a recording; `paper` has the epsilons that the recording's scene states."""
    return preset_settings(preset, of_scene=(recording.metadata.scene or {}).get("paper"))


def _ours(preset: Preset, truth: Callable[[Recording], Given] | None = None) -> Method:
    """A preset; with `truth` one of its stages knows it."""

    def solver(recording: Recording, settings: dict[str, Any]) -> Motions:
        return solve(recording, Settings.model_validate(settings), truth(recording) if truth else NOTHING_GIVEN)

    return Method(
        settings=lambda recording: settings_of(recording, preset).model_dump(mode="json"),
        solver=solver,
        sees_truth=truth is not None,
    )


METHODS: Mapping[str, Method] = {
    "default": _ours("default"),
    "paper": _ours("paper"),
    "tracker": Method(
        settings=lambda recording: TrackerSettings().model_dump(mode="json"),
        solver=lambda recording, settings: track_motions(recording, TrackerSettings.model_validate(settings)),
    ),
    "gap_closing": Method(
        settings=lambda recording: GapClosingSettings().model_dump(mode="json"),
        solver=lambda recording, settings: gap_closing_motions(recording, GapClosingSettings.model_validate(settings)),
    ),
    "true_flow": _ours("default", true_flow),
    "true_segments": _ours("default", true_segments),
    "true_links": _ours("default", true_links),
}
"""By the names that `--methods` takes, in the order of the tables."""
