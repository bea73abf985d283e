"""Walking: how pelvis, feet and arms move when somebody follows a path.

Stride length and frequency follow Boulic, Thalmann and Thalmann, "A global human walking model with real-time
kinematic personification" (The Visual Computer, 1990): with v the speed in thigh heights a second, a stride is
1.346 sqrt(v) thigh heights long. The article prescribes joint angles, and feet slide; here feet are planted: each
stance has a footprint beside the path, the foot rolls over it from heel to toe, and the legs reach for it by
two-bone inverse kinematics. The curves of foot pitch, pelvis and arms are our own.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter1d

from simulator.path import Path

RATE = 120.0
"""Moments a second at which a walk is planned."""
STRIDE_FACTOR = 1.346
_STANCE = 0.62
"""Share of the cycle that a foot is down."""
_UNDER_HIP = 0.42
"""Share of the stance after which the hip is above the footprint's ankle."""
_CALM_SECONDS = 0.12
_STEADY_SECONDS = 0.6
_STEADIED_BELOW = 0.4
"""Metres a second below which a direction is taken over a longer time: who sways on the spot does not spin."""
_EASE_SECONDS = 0.2
_CLOSING_SECONDS = 1.3
_CLOSING_SPEED = 0.6
_SLOWEST = 0.05
"""Metres a second below which somebody stands."""
_LIFT_METRES = 0.035
_LIFTED_FROM = 0.04
"""Metres a second above which a swinging foot has all of its lift: a swing that slows down must not scrape the ground,
and one that ends half-way, because its owner stands, must come down."""
_TURNING_RADIUS = 0.4
"""Metres from the turning axis to the feet, were a turn on the spot walked at its rate; more makes more steps."""
_TURN_SECONDS = 1.2
"""How long a turn on the spot takes, if the pause allows."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Walk:
    """The plan of a walk at evenly spaced moments."""

    time: Float[np.ndarray, "moment"]
    """Seconds."""
    place: Float[np.ndarray, "moment 2"]
    """Below the pelvis on the ground, world axes, metres."""
    heading: Float[np.ndarray, "moment"]
    """Radians from x towards y, continuous."""
    speed: Float[np.ndarray, "moment"]
    """Metres a second; who turns on the spot or closes his feet counts as walking, for his feet step."""
    phase: Float[np.ndarray, "moment"]
    """Gait cycles; at whole numbers the left foot comes down, half a cycle later the right."""

    def at_phase(self, phase: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape 3"]:
        """Place and heading where the walk passes a phase; at its ends before and after."""
        rising = self.phase + 1e-9 * np.arange(len(self.phase))  # Standing keeps the phase.
        columns = (self.place[:, 0], self.place[:, 1], self.heading)
        return np.stack([np.interp(phase, rising, column) for column in columns], axis=-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Step:
    """One foot at some moments."""

    ground: Float[np.ndarray, "moment 2"]
    """Where the ankle of the flat foot would stand, world axes, metres."""
    yaw: Float[np.ndarray, "moment"]
    """Direction of the foot, radians."""
    pitch: Float[np.ndarray, "moment"]
    """Radians; positive: heel up, over the ball; negative: toes up, over the heel."""
    lift: Float[np.ndarray, "moment"]
    """Height above the ground, metres."""
    stance: Bool[np.ndarray, "moment"]
    """Whether the foot is down."""


def planned_walk(path: Path, *, thigh_height: float, phase: float, begin: float, end: float) -> Walk:
    """The walk along the path from `begin` to `end`, both seconds, with the gait's phase at `begin`.

    Who is under way at `begin` is so before as well: the path is continued straight backwards.
    """
    time = np.arange(begin - 1.5, end + 1.5, 1 / RATE)
    place = path.positions(time)
    if path.begin <= begin:
        early = time < path.begin
        ahead = (path.positions(np.array([path.begin + 0.05]))[0] - path.places[0]) / 0.05
        place[early] = path.places[0] + (time[early] - path.begin)[:, None] * ahead
    place = _eased(place, time, path.end)
    if path.begin > begin:
        place = _eased(place, time, path.begin)
    calm = _CALM_SECONDS * RATE
    velocity = gaussian_filter1d(np.gradient(place, 1 / RATE, axis=0), calm, axis=0, mode="nearest")
    speed = np.linalg.norm(velocity, axis=1)
    heading = _headings(*_steadied(velocity, speed))
    speed = speed + _pace_on_the_spot(speed, heading)
    frequency = np.sqrt(speed / thigh_height) / STRIDE_FACTOR  # Speed over stride length.
    cycles = np.cumsum(frequency) / RATE
    cycles += phase - np.interp(begin, time, cycles)
    return Walk(time=time, place=place, heading=heading, speed=speed, phase=cycles)


def _pace_on_the_spot(
    speed: Float[np.ndarray, "moment"], heading: Float[np.ndarray, "moment"]
) -> Float[np.ndarray, "moment"]:
    """The speed, m/s, at which feet step though the body stands: to follow a turn, and to come together after a stop.

    The closing bell's height and length make about half a cycle, which is one step of the foot left behind.
    """
    standing = np.clip(1 - speed / _SLOWEST, 0.0, 1.0)
    turn = _TURNING_RADIUS * standing * np.abs(np.gradient(heading, 1 / RATE))
    moment = np.arange(len(speed))
    last_walking = np.maximum.accumulate(np.where(speed > _SLOWEST, moment, -len(speed)))
    since = np.clip((moment - last_walking) / (_CLOSING_SECONDS * RATE), 0.0, 1.0)
    close = _CLOSING_SPEED * np.sin(np.pi * since) ** 2
    return gaussian_filter1d(np.maximum(turn, close), 0.5 * _CALM_SECONDS * RATE, mode="nearest")


def _eased(
    place: Float[np.ndarray, "moment 2"], time: Float[np.ndarray, "moment"], change: float
) -> Float[np.ndarray, "moment 2"]:
    """The places, with the sudden start or stop at the time `change` spread over most of a second."""
    smooth = gaussian_filter1d(place, _EASE_SECONDS * RATE, axis=0, mode="nearest")
    away = np.clip(np.abs(time - change) / (6 * _EASE_SECONDS), 0.0, 1.0)[:, None]
    return place + (1 - away**2 * (3 - 2 * away)) * (smooth - place)


def planned_steps(walk: Walk, *, side: int, half_width: float) -> Step:
    """The left (0) or right (1) foot of a walk, with its footprints `half_width` metres beside the path."""
    own = walk.phase - 0.5 * side
    number = np.floor(own)
    share = own - number
    stance = share < _STANCE
    here, there = (_footprints(walk, number + later + 0.5 * side, side, half_width) for later in (0.0, 1.0))
    swing = np.clip((share - _STANCE) / (1 - _STANCE), 0.0, 1.0)
    carried = (swing**3 * (10 - 15 * swing + 6 * swing**2))[:, None]  # The smoothest way without a jerk.
    place = here + carried * (there - here)
    vigour = np.clip(walk.speed / 1.4, 0.0, 1.2)
    return Step(
        ground=place[:, :2],
        yaw=place[:, 2],
        pitch=_pitch(share / _STANCE, swing) * vigour,
        lift=_LIFT_METRES * np.sin(np.pi * swing) ** 2 * np.clip(walk.speed / _LIFTED_FROM, 0.0, 1.0),
        stance=stance,
    )


def _footprints(walk: Walk, phase: np.ndarray, side: int, half_width: float) -> Float[np.ndarray, "moment 3"]:
    """The footprint (x, y, yaw) of the stances that begin at the phases."""
    under = walk.at_phase(phase + _STANCE * _UNDER_HIP)
    left = np.stack([-np.sin(under[:, 2]), np.cos(under[:, 2])], axis=-1)
    sideways = (half_width if side == 0 else -half_width) * left
    return np.concatenate([under[:, :2] + sideways, under[:, 2:]], axis=-1)


def _pitch(stance: Float[np.ndarray, "moment"], swing: Float[np.ndarray, "moment"]) -> Float[np.ndarray, "moment"]:
    """The pitch of a foot at 1.4 m/s, radians: it comes down on the heel, lies flat, and leaves over the toes."""
    toes_up, heel_up = 0.30, 0.85
    strike = -toes_up * np.clip(1 - stance / 0.15, 0.0, 1.0)
    leave = heel_up * np.clip((stance - 0.5) / 0.5, 0.0, 1.0) ** 1.6
    recover = heel_up * np.clip(1 - swing / 0.65, 0.0, 1.0) ** 2
    reach = np.clip((swing - 0.45) / 0.55, 0.0, 1.0)
    return np.where(swing > 0, recover - toes_up * reach**2 * (3 - 2 * reach), strike + leave)


def _steadied(
    velocity: Float[np.ndarray, "moment 2"], speed: Float[np.ndarray, "moment"]
) -> tuple[Float[np.ndarray, "moment 2"], Float[np.ndarray, "moment"]]:
    """The velocity to face along, and its size: the slower somebody is, the more that of a longer time."""
    over_long = gaussian_filter1d(velocity, _STEADY_SECONDS * RATE, axis=0, mode="nearest")
    quick = np.clip(speed / _STEADIED_BELOW, 0.0, 1.0)[:, None]
    steady = over_long + quick**2 * (3 - 2 * quick) * (velocity - over_long)
    return steady, np.linalg.norm(steady, axis=1)


def _headings(velocity: np.ndarray, speed: np.ndarray) -> Float[np.ndarray, "moment"]:
    """The direction of walking; who stands keeps his own and turns to the next before he sets off."""
    walking = np.flatnonzero(speed > _SLOWEST)
    if not len(walking):
        return np.zeros(len(speed))
    direction = np.unwrap(np.arctan2(velocity[walking, 1], velocity[walking, 0]))
    moment = np.arange(len(speed))
    later = np.clip(np.searchsorted(walking, moment), 0, len(walking) - 1)
    before = np.clip(np.searchsorted(walking, moment, side="right") - 1, 0, None)
    pause = np.maximum(walking[later] - walking[before], 1)
    turned = 1 - (walking[later] - moment) / np.minimum(pause, _TURN_SECONDS * RATE)
    share = np.clip(turned, 0.0, 1.0)
    kept = direction[before] + share**2 * (3 - 2 * share) * (direction[later] - direction[before])
    return gaussian_filter1d(kept, _CALM_SECONDS * RATE, mode="nearest")
