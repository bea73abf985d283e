"""Recorded people as the crowd of a random scene: only what stands before them is left to choose."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from simulator.casting import Surroundings
from simulator.family_drawing import Walks
from simulator.family_setting import Setting
from simulator.recorded_crowd import RecordedCrowd, crowd_tracks, recorded_walks
from simulator.silhouette import silhouettes
from simulator.tracks import STEP_S


def recorded_setting(setting: Setting, crowd: RecordedCrowd, generator: np.random.Generator) -> tuple[Setting, Walks]:
    """The setting with as many people as were found in some window of the file, and where they walk."""
    people = setting.family.people
    around = Surroundings(
        camera=setting.camera,
        seconds=setting.seconds,
        people_m=people.clearance_m,
        obstacles_m=people.obstacle_clearance_m,
    )
    wanted = crowd.model_copy(update={"people": people.count})
    places = recorded_walks(wanted, crowd_tracks(wanted), around, generator=generator)
    numbers = np.array([silhouettes().bodies.index(name) for name in people.bodies])
    walks = Walks(
        place=_at_moments(setting, places),
        body=generator.choice(numbers, len(places)),
        phase=np.round(generator.uniform(0.0, 1.0, len(places)), 3),
    )
    return replace(setting, people=len(places)), walks


def _at_moments(setting: Setting, places: Float[np.ndarray, "walk sample 2"]) -> Float[np.ndarray, "walk time 2"]:
    """The places, known from the first frame on, at the setting's moments: straight on before and after."""
    before = round(-float(setting.moments[0]) / STEP_S)
    after = max(len(setting.moments) - before - places.shape[1], 0)
    ahead, behind = places[:, 1] - places[:, 0], places[:, -1] - places[:, -2]
    early = places[:, :1] + np.arange(-before, 0)[:, None] * ahead[:, None]
    late = places[:, -1:] + np.arange(1, after + 1)[:, None] * behind[:, None]
    return np.concatenate([early, places, late], axis=1)[:, : len(setting.moments)]
