"""What the baselines have in common: from a recording over detections and tracks to motions."""

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated

from pydantic import Field

from algorithm.stopwatch import Stopwatch
from evaluation.carried import DetectionTrack, motions_of_tracks
from evaluation.detections import Detections, DetectorSettings, detections_of, moving_points
from recording.motions import Making, Motions
from recording.recording import Recording
from recording.version import VERSION

Seconds = Annotated[float, Field(ge=0)]


class BaselineSettings(DetectorSettings):
    """What every baseline has settings for."""

    shortest_seconds: Seconds = 0.2
    """Seconds with a detection: a track with less is noise."""
    carry_seconds: Seconds = 0.4
    """Seconds before a gap, of which the largest detection's points are carried through it; 0 = the last's."""


def baseline_motions(
    recording: Recording,
    settings: BaselineSettings,
    tracks_of: Callable[[Detections], list[DetectionTrack]],
    *,
    name: str,
) -> Motions:
    """The motions of the tracks that a baseline makes of a recording's detections; `name` is written as its preset."""
    watch = Stopwatch()
    with watch.stage("clustering"):
        detections = detections_of(moving_points(recording), settings)
    with watch.stage("trajectories"):
        tracks = tracks_of(detections)
    with watch.stage("completion"):
        motions = motions_of_tracks(
            detections, tracks, carry_frames=round(settings.carry_seconds * recording.fps), making=Making()
        )
    making = Making(
        settings={"preset": name, **settings.model_dump()},
        recording_digest=recording.digest(),
        version=VERSION,
        seconds=watch.by_stage(),
    )
    return replace(motions, making=making)
