"""The trajectories of one recording over and over: a larger crowd, or a longer recording."""

from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Bool

from algorithm.followed import Followed
from algorithm.patches import Patches
from algorithm.trajectories import Trajectories

Arm = Literal["space", "time"]
ARMS: tuple[Arm, ...] = ("space", "time")
APART_M = 50.0
"""Between copies in space: nothing of one is near anything of another."""


def chosen(followed: Followed, which: Bool[np.ndarray, "trajectory"]) -> Followed:
    """The chosen trajectories with what belongs to them."""
    rows = which[followed.trajectories.trajectory]
    kept = Patches(pixels=followed.patches.pixels[rows], centre=followed.patches.centre[rows])
    return replace(followed, trajectories=followed.trajectories.chosen(which), patches=kept)


def repeated(followed: Followed, factor: int, arm: Arm, *, pause_frames: int) -> Followed:
    """So many copies: side by side across the camera's view, as it would see them, or one after the other."""
    one, around = followed.trajectories, followed.patches
    copy = np.repeat(np.arange(factor), len(one.frame))
    frame, period = np.tile(one.frame, factor), followed.frames + pause_frames
    position, centre = np.tile(one.position, (factor, 1)), np.tile(around.centre, (factor, 1))
    column_row = np.tile(one.column_row, (factor, 1))
    if arm == "time":
        frame += copy * period
    else:
        right, ahead, eye = (followed.camera.world_from_camera[:3, axis] for axis in (0, 2, 3))
        column_row[:, 0] += copy * (followed.camera.fx * APART_M / ((position - eye) @ ahead))
        aside_m = APART_M * copy[:, None] * right
        position, centre = position + aside_m, centre + aside_m
    return replace(
        followed,
        trajectories=Trajectories(
            trajectory=np.tile(one.trajectory, factor) + copy * one.count,
            frame=frame,
            position=position,
            column_row=column_row,
        ),
        patches=Patches(pixels=np.tile(around.pixels, factor), centre=centre),
        frames=factor * period if arm == "time" else followed.frames,
    )
