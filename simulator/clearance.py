"""How near people come to one another and to what stands in their way."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from jaxtyping import Bool, Float

from recording.crowd import HEADROOM_M
from simulator.things import Obstacle


@dataclass(frozen=True, kw_only=True)
class Clearance:
    """The smallest distances in all frames, on the ground, metres; infinite where there is nothing to measure."""

    people_m: float
    """Between the centres of two people."""
    obstacles_m: float
    """From a person's centre to the outline of an obstacle; 0 inside it."""

    @property
    def sentence(self) -> str:
        """The clearances in words; what there is nothing of is left out."""
        said = (("two people", self.people_m), ("a person and an obstacle", self.obstacles_m))
        parts = [f"{distance:.2f} m between {what}" for what, distance in said if np.isfinite(distance)]
        return "at least " + " and ".join(parts) if parts else "nobody near another"


def smallest_clearance(centres: Sequence[Float[np.ndarray, "frame 2"]], obstacles: Sequence[Obstacle]) -> Clearance:
    """The clearance of people whose centres are given in each frame, world axes, metres."""
    between = (np.linalg.norm(a - b, axis=-1).min() for a, b in combinations(centres, 2))
    in_the_way = [obstacle for obstacle in obstacles if obstacle.position[2] < HEADROOM_M]
    beside = (_outline_distance(obstacle, path).min() for obstacle, path in product(in_the_way, centres))
    return Clearance(
        people_m=float(min(between, default=np.inf)),
        obstacles_m=float(min(beside, default=np.inf)),
    )


def crowded(
    centres: Sequence[Float[np.ndarray, "frame 2"]],
    obstacles: Sequence[Obstacle],
    *,
    people_m: float,
    obstacles_m: float,
) -> Bool[np.ndarray, "person"]:
    """Mark who in some frame is nearer than `people_m` to another's centre or than `obstacles_m` to an obstacle."""
    marked = np.array([smallest_clearance([one], obstacles).obstacles_m < obstacles_m for one in centres])
    for a, b in combinations(range(len(centres)), 2):
        if np.linalg.norm(centres[a] - centres[b], axis=-1).min() < people_m:
            marked[[a, b]] = True
    return marked


def _outline_distance(obstacle: Obstacle, points: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, "point"]:
    """The distance of points on the ground from the obstacle's outline, metres; 0 inside."""
    towards = points - np.array(obstacle.position[:2])
    if obstacle.size is None:
        return np.maximum(np.linalg.norm(towards, axis=-1) - (obstacle.radius or 0.0), 0.0)
    yaw = np.radians(obstacle.yaw_deg)
    box_from_world = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    beyond = np.abs(towards @ box_from_world.T) - np.array(obstacle.size[:2]) / 2
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
