"""Crowds that keep apart: people who walk to their goals and evade one another and what stands in the way.

The social force model of Helbing and Molnár ("Social force model for pedestrian dynamics", Physical Review E, 1995):
everybody is driven to the own goal at the own speed, and pushed off others. What pushes is not where others are but
where they will be when they come nearest, the more the sooner, as in Zanlungo, Ikeda and Kanda ("Social force model
with explicit collision prediction", Europhysics Letters, 2011); Karamouzas, Skinner and Guy measured that people do so
("Universal power law governing pedestrian interactions", Physical Review Letters, 2014). Round what stands, they take
the free direction next to the goal's (Moussaïd, Helbing and Theraulaz, "How simple rules determine pedestrian behavior
and crowd disasters", PNAS, 2011). That a force turns and speeds up a walker within bounds only is our own, so that
feet can follow; so are the constants, searched for on random crowds of six and of twelve.

Places are complex numbers here, x + iy: with conj(a) b the real part is the dot product, the imaginary part the
cross product, and a product with a unit number turns.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from recording.errors import InputError
from simulator.crowds import Crowds
from simulator.path import FASTEST_WALK

QUICKEST = 0.98 * FASTEST_WALK
"""Metres a second; nobody walks faster, hurrying included."""
SPEEDING_UP, BRAKING, SWERVING = 1.2, 2.0, 2.0
"""The strongest accelerations forwards, backwards and sideways, metres a second squared."""
TURNING = 1.5
"""The quickest turn, radians a second."""

_STEP_S = 0.05  # At most, from force to force.
_HURRY = 1.3  # Times the own speed.
_DRIVE_S = 0.7  # Helbing's relaxation time.
_FORESIGHT_S = 2.5
_URGENCY_S = 0.5  # A meeting so far ahead pushes half as much as one that happens.
_STIFFNESS = 10.0  # Of the push, m/s^2 for a metre too near in a second.
_SOFTNESS_M = 0.15  # Over so much the push sets in.
_MARGIN_M = 0.1  # Added to the distance that is to be kept.
_CONTACT = 0.3  # The push is across the way at 0, and from where they touch, hence a brake too, at 1.
_SIDEWAYS = 2.0  # People evade by turning rather than by waiting.
_LEAST_SPEED = 0.35  # Who is slower turns as if he were not, m/s.
_REACTION_S = 0.1
_LOOKAHEAD_M = 2.0  # Who is off the line to the goal comes back to it so far ahead.
_HEAD_ON_M = 1e-6  # A meeting so exact has no sides: both pass on the right.
_FAR_M = 1e6  # Where nobody is.

Places = Complex[np.ndarray, "crowd person"]
Amounts = Float[np.ndarray, "crowd person"]
Others = Complex[np.ndarray, "crowd person other"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Wishes:
    """What people want and do not change; nobody and no disc are far away."""

    goal: Places
    course: Places
    """Unit numbers from start to goal; 0 for who stands."""
    speed: Amounts
    disc: Complex[np.ndarray, "crowd other"]
    radius: Float[np.ndarray, "crowd other"]
    people_m: float
    obstacles_m: float


@dataclass(frozen=True, kw_only=True, eq=False)
class _Moment:
    """Everybody at one time."""

    place: Places
    heading: Places
    """Unit numbers; 0 for who stands."""
    speed: Amounts
    gain: Amounts
    """Of speed, m/s^2."""
    turning: Amounts
    """To the left, radians a second."""


def social_force_walks(
    crowds: Crowds,
    *,
    seconds: float,
    step_s: float = 0.1,
    clearance_m: float = 0.6,
    obstacle_clearance_m: float = 0.3,
) -> Float[np.ndarray, "crowd person time 2"]:
    """Everybody's centre at 0, `step_s`, ... up to `seconds` at least, metres; NaN for nobody.

    People try to keep `clearance_m` between their centres, and `obstacle_clearance_m` from a centre to a disc's edge;
    where there is no room they fail, so whoever must be sure measures it (`clearance.smallest_clearance`). Everybody
    sets out at the own speed, straight to the goal or round what stands before it. The same crowd walks the same way,
    alone or among other crowds.
    """
    _check(crowds, seconds, step_s)
    wishes = _wishes(crowds, clearance_m, obstacle_clearance_m)
    moment = _first(wishes, _complex(crowds.starts))
    parts = int(np.ceil(step_s / _STEP_S - 1e-9))
    walked = [moment.place]
    for _ in range(int(np.ceil(seconds / step_s - 1e-9))):
        for _ in range(parts):
            moment = _later(moment, _force(moment, wishes), wishes, step_s / parts)
        walked.append(moment.place)
    places = np.stack(walked, axis=-1)
    walks = np.stack([places.real, places.imag], axis=-1)
    walks[_absent(crowds)] = np.nan
    return walks


def _check(crowds: Crowds, seconds: float, step_s: float) -> None:
    """Raise unless people can walk so."""
    if not (seconds >= 0 and step_s > 0):
        raise InputError(f"expected 0 seconds or more, in steps above 0, got {seconds} s in steps of {step_s} s")
    speeds = crowds.speeds[~_absent(crowds)]
    if not ((speeds > 0) & (speeds <= QUICKEST)).all():
        raise InputError(f"expected speeds above 0 and up to {QUICKEST:g} m/s, got {speeds.min()} to {speeds.max()}")


def _absent(crowds: Crowds) -> np.ndarray:
    """Mark who is nobody."""
    return np.isnan(crowds.starts).any(axis=-1) | np.isnan(crowds.goals).any(axis=-1) | np.isnan(crowds.speeds)


def _complex(places: Float[np.ndarray, "crowd other 2"]) -> Complex[np.ndarray, "crowd other"]:
    """The places as complex numbers, each of nobody's far away from everybody else's."""
    nowhere = _FAR_M * (2.0 + np.arange(places.shape[1]))
    return np.where(np.isnan(places).any(axis=-1), nowhere, places[..., 0] + 1j * places[..., 1])


def _wishes(crowds: Crowds, people_m: float, obstacles_m: float) -> _Wishes:
    goal = _complex(crowds.goals)
    way = goal - _complex(crowds.starts)
    course = np.where(_absent(crowds), 0.0, way / np.maximum(np.abs(way), 1e-9))
    return _Wishes(
        goal=goal,
        course=course,
        speed=np.where(course == 0, 0.0, crowds.speeds),
        disc=_complex(np.where(np.isnan(crowds.discs[..., 2:]), np.nan, crowds.discs[..., :2])),
        radius=np.nan_to_num(crowds.discs[..., 2]),
        people_m=people_m,
        obstacles_m=obstacles_m,
    )


def _first(wishes: _Wishes, starts: Places) -> _Moment:
    """Everybody under way."""
    still = np.zeros(starts.shape)
    return _Moment(place=starts, heading=_direction(starts, wishes), speed=wishes.speed, gain=still, turning=still)


def _force(moment: _Moment, wishes: _Wishes) -> Places:
    """The acceleration that everybody wants, m/s^2."""
    velocity = moment.speed * moment.heading
    drive = (wishes.speed * _direction(moment.place, wishes) - velocity) / _DRIVE_S
    towards = moment.place[:, None, :] - moment.place[:, :, None]
    towards[:, np.eye(towards.shape[1], dtype=bool)] = _FAR_M  # From oneself.
    closing = velocity[:, :, None] - velocity[:, None, :]
    off_people = _push(towards, closing, np.array(wishes.people_m))
    towards = wishes.disc[:, None, :] - moment.place[:, :, None]
    closing = np.broadcast_to(velocity[:, :, None], towards.shape)
    off_discs = _push(towards, closing, (wishes.radius + wishes.obstacles_m)[:, None, :])
    return drive + off_people.sum(axis=-1) + off_discs.sum(axis=-1)


def _push(towards: Others, closing: Others, distance_m: Float[np.ndarray, "..."]) -> Others:
    """The push off others that are `towards` and come nearer at the velocity `closing`, m/s^2.

    With t the time until they are nearest (now, if they part), and m the vector to them then, which is too short by
    p = `distance_m` + margin - |m|, it is stiffness * softplus(p) / (t + urgency), away from where they are a little
    before: sideways from who would be passed too near, and a brake before who stands in the way.
    """
    pace_squared = np.abs(closing) ** 2 + 1e-9
    until = np.clip((towards * closing.conj()).real / pace_squared, 0.0, _FORESIGHT_S)
    miss = towards - closing * until
    miss = np.where(np.abs(miss) < _HEAD_ON_M, _HEAD_ON_M * 1j * closing / np.sqrt(pace_squared), miss)
    nearest, wanted = np.abs(miss), distance_m + _MARGIN_M
    strength = _STIFFNESS * _SOFTNESS_M * np.logaddexp(0.0, (wanted - nearest) / _SOFTNESS_M) / (until + _URGENCY_S)
    touching = np.sqrt(np.maximum(wanted**2 - nearest**2, 0.0) / pace_squared)
    meeting = miss + closing * np.minimum(_CONTACT * touching, until)
    return -strength * meeting / np.maximum(np.abs(meeting), 1e-12)


def _direction(place: Places, wishes: _Wishes) -> Places:
    """Unit numbers to where everybody wants to walk: on the line to the goal, or back to it, round what stands."""
    to_goal = (wishes.goal - place) * wishes.course.conj()
    aim = np.maximum(to_goal.real, _LOOKAHEAD_M) + 1j * to_goal.imag
    return wishes.course * np.exp(1j * (np.angle(aim) + _way_round(place, aim * wishes.course, wishes)))


def _way_round(place: Places, aim: Places, wishes: _Wishes) -> Amounts:
    """By which angle everybody turns off the aim (a vector) to pass the discs before it, radians.

    A disc closes the angles in which its edge is nearer than allowed. Where the aim is closed, the open edge of a
    closed range that is nearest to it is taken; where everything is closed, the aim.
    """
    turn = np.zeros(place.shape)
    towards = wishes.disc[:, None, :] - place[:, :, None]
    distance = np.abs(towards)
    reach = wishes.radius[:, None, :] + wishes.obstacles_m + _MARGIN_M
    before = distance < np.abs(aim)[:, :, None]
    half = np.where(before, np.arcsin(np.minimum(reach / np.maximum(distance, reach), 1.0)), 0.0)
    middle = np.angle(towards * aim.conj()[:, :, None])
    blocked = (np.abs(middle) < half).any(axis=-1)
    middle, half = middle[blocked], half[blocked]
    edges = np.concatenate([middle - half, middle + half], axis=-1)  # Right edges first: of two equals they win.
    off = np.abs((edges[:, :, None] - middle[:, None, :] + np.pi) % (2 * np.pi) - np.pi)
    closed = (off < half[:, None, :] - 1e-9).any(axis=-1) | np.tile(half == 0, 2)
    cost = np.where(closed, np.inf, np.round(np.abs(edges), 9))
    if len(cost):
        chosen = np.take_along_axis(edges, cost.argmin(axis=-1)[:, None], axis=-1)[:, 0]
        turn[blocked] = np.where(np.isinf(cost).all(axis=-1), 0.0, chosen)
    return turn


def _later(moment: _Moment, force: Places, wishes: _Wishes, step_s: float) -> _Moment:
    """Everybody a step later: speed and heading follow the force as far and as quickly as people can."""
    pushed = force * moment.heading.conj()
    pace = np.maximum(moment.speed, _LEAST_SPEED)
    quickest = np.minimum(TURNING, SWERVING / pace)
    share = min(step_s / _REACTION_S, 1.0)
    gain = moment.gain + share * (np.clip(pushed.real, -BRAKING, SPEEDING_UP) - moment.gain)
    turning = moment.turning + share * (np.clip(_SIDEWAYS * pushed.imag / pace, -quickest, quickest) - moment.turning)
    speed = np.clip(moment.speed + gain * step_s, 0.0, np.minimum(_HURRY * wishes.speed, QUICKEST))
    half_turn = np.exp(0.5j * turning * step_s)
    return _Moment(
        place=moment.place + 0.5 * (moment.speed + speed) * step_s * moment.heading * half_turn,
        heading=moment.heading * half_turn**2,
        speed=speed,
        gain=gain,
        turning=turning,
    )
