"""What a practitioner would write: detections by DBSCAN, Kalman filters of constant velocity, Hungarian, smoothed.

Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001: white-noise acceleration
(6.2.2), the filter (5.2.4), the smoother of Rauch, Tung and Striebel (8.6).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import linear_sum_assignment

from evaluation.baseline import BaselineSettings, Seconds, baseline_motions
from evaluation.carried import DetectionTrack
from evaluation.detections import Detections, Positive
from recording.motions import Motions
from recording.recording import Recording

_WALKING_M_PER_S = 1.5
"""The speed that a new track may have: its standard deviation along each axis."""


class TrackerSettings(BaselineSettings):
    """The settings of the practitioner's baseline; the values are those that `benchmarks/tune_baselines.py` found."""

    measurement_m: Positive = 0.25
    """Metres: standard deviation of a detection's centre from the track's place, along each axis."""
    acceleration_m_per_s2: Positive = 0.5
    """Metres a second squared: standard deviation of what a track's speed does unforeseen."""
    gate: Positive = 6.0
    """Standard deviations of the expected miss: a detection farther away is not the track's."""
    coast_seconds: Seconds = 1.5
    """Seconds that a track lives on without a detection."""


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Place and speed of a track; all axes and both have one covariance, for they are seen and accelerate alike."""

    mean: Float[np.ndarray, "2 3"]
    """Place in metres and speed in metres a second, world axes."""
    covariance: Float[np.ndarray, "2 2"]
    """Of place and speed along each axis."""

    def miss_deviation(self, measurement_m: float) -> float:
        """The standard deviation of a detection from the expected place along each axis, metres."""
        return float(np.sqrt(self.covariance[0, 0] + measurement_m**2))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Track:
    """A track while it is filtered: what was expected and what was believed in each frame since its first."""

    first: int
    expected: tuple[State, ...]
    believed: tuple[State, ...]
    detections: tuple[int, ...]
    """-1 where it coasted."""

    @property
    def coasting(self) -> int:
        """Frames since the last detection."""
        return int(np.argmax(np.array(self.detections[::-1]) >= 0))


def track_motions(recording: Recording, settings: TrackerSettings | None = None) -> Motions:
    """The motions of the practitioner's baseline. A motion's place is its track's state, also while it coasts.

    A track that coasted and was never seen again ends with its last detection.
    """
    chosen = settings or TrackerSettings()
    frames, fps = recording.metadata.frames, recording.fps
    return baseline_motions(
        recording,
        chosen,
        lambda detections: tracked_detections(detections, chosen, frames=frames, fps=fps),
        name="tracker",
    )


def tracked_detections(
    detections: Detections, settings: TrackerSettings, *, frames: int, fps: float
) -> list[DetectionTrack]:
    """The tracks of the detections, in the order in which they begin, smoothed."""
    alive: list[_Track] = []
    ended: list[_Track] = []
    for frame in range(frames):
        here = np.flatnonzero(detections.moment == frame)
        alive = _advanced(alive, here, detections.centre, settings, fps)
        taken = {track.detections[-1] for track in alive}
        alive += [_begun(frame, one, detections.centre[one], settings) for one in here.tolist() if one not in taken]
        ended += [track for track in alive if track.coasting > settings.coast_seconds * fps]
        alive = [track for track in alive if track.coasting <= settings.coast_seconds * fps]
    everyone = sorted(ended + alive, key=lambda track: (track.first, track.detections[0]))
    shortest = max(settings.shortest_seconds * fps, 1)
    return [_smoothed(track, fps) for track in everyone if np.sum(np.array(track.detections) >= 0) >= shortest]


def predicted(state: State, *, seconds: float, acceleration_m_per_s2: float) -> State:
    """The state after some time with the same speed, give or take an acceleration that is constant meanwhile."""
    motion = np.array([[1.0, seconds], [0.0, 1.0]])
    push = acceleration_m_per_s2 * np.array([seconds**2 / 2, seconds])
    return State(mean=motion @ state.mean, covariance=motion @ state.covariance @ motion.T + np.outer(push, push))


def updated(state: State, place: Float[np.ndarray, "3"], *, measurement_m: float) -> State:
    """The state after a detection at the place."""
    gain = state.covariance[:, 0] / state.miss_deviation(measurement_m) ** 2
    return State(
        mean=state.mean + np.outer(gain, place - state.mean[0]),
        covariance=state.covariance - np.outer(gain, state.covariance[0]),
    )


def smoothed(expected: tuple[State, ...], believed: tuple[State, ...], *, seconds: float) -> list[State]:
    """What is believed of each frame after the last one (Rauch, Tung and Striebel)."""
    motion = np.array([[1.0, seconds], [0.0, 1.0]])
    states = [believed[-1]]
    for now, ahead in zip(believed[-2::-1], expected[:0:-1], strict=True):
        gain = now.covariance @ motion.T @ np.linalg.inv(ahead.covariance)
        later = states[-1]
        covariance = now.covariance + gain @ (later.covariance - ahead.covariance) @ gain.T
        states.append(State(mean=now.mean + gain @ (later.mean - ahead.mean), covariance=covariance))
    return states[::-1]


def _advanced(
    tracks: list[_Track],
    here: Int[np.ndarray, "candidate"],
    centre: Float[np.ndarray, "detection 3"],
    settings: TrackerSettings,
    fps: float,
) -> list[_Track]:
    """The tracks one frame on, each with the detection that the likeliest assignment gives it."""
    push = settings.acceleration_m_per_s2
    expected = [predicted(track.believed[-1], seconds=1 / fps, acceleration_m_per_s2=push) for track in tracks]
    chosen = _assigned(expected, centre[here], settings)
    advanced = []
    for track, state, choice in zip(tracks, expected, chosen, strict=True):
        believed = state
        if choice >= 0:
            believed = updated(state, centre[here[choice]], measurement_m=settings.measurement_m)
        advanced.append(
            _Track(
                first=track.first,
                expected=(*track.expected, state),
                believed=(*track.believed, believed),
                detections=(*track.detections, int(here[choice]) if choice >= 0 else -1),
            )
        )
    return advanced


def _assigned(
    expected: list[State], place: Float[np.ndarray, "candidate 3"], settings: TrackerSettings
) -> Int[np.ndarray, "track"]:
    """The detection of each track, -1 for none: the assignment of greatest likelihood within the gates.

    The cost is twice the negative logarithm of the likelihood, miss^2 / s^2 + 3 ln s^2; a track without a detection
    pays what one at its gate would.
    """
    count = len(expected)
    if not count or not len(place):
        return np.full(count, -1)
    deviation = np.array([state.miss_deviation(settings.measurement_m) for state in expected])
    foreseen = np.stack([state.mean[0] for state in expected])
    distance = np.linalg.norm(foreseen[:, None] - place[None], axis=2) / deviation[:, None]
    spread = 6.0 * np.log(deviation)[:, None]
    alone = np.where(np.eye(count, dtype=bool), settings.gate**2 + spread, np.inf)
    cost = np.concatenate([np.where(distance <= settings.gate, distance**2 + spread, np.inf), alone], axis=1)
    row, column = linear_sum_assignment(cost)
    return np.where(column < len(place), column, -1)[np.argsort(row)]


def _begun(frame: int, detection: int, place: Float[np.ndarray, "3"], settings: TrackerSettings) -> _Track:
    state = State(
        mean=np.stack([place, np.zeros(3)]),
        covariance=np.diag([settings.measurement_m**2, _WALKING_M_PER_S**2]),
    )
    return _Track(first=frame, expected=(state,), believed=(state,), detections=(detection,))


def _smoothed(track: _Track, fps: float) -> DetectionTrack:
    """The track up to its last detection."""
    length = len(track.detections) - track.coasting
    states = smoothed(track.expected[:length], track.believed[:length], seconds=1 / fps)
    detections = np.array(track.detections[:length])
    return DetectionTrack(
        detections=detections[detections >= 0],
        first=track.first,
        position=np.stack([state.mean[0] for state in states]),
    )
