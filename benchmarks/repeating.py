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
    number, frame = np.tile(one.trajectory, factor), np.tile(one.frame, factor)
    period = followed.frames + pause_frames
    position, centre = np.tile(one.position, (factor, 1)), np.tile(around.centre, (factor, 1))
    column_row = np.tile(one.column_row, (factor, 1))
    right, ahead, eye = (followed.camera.world_from_camera[:3, axis] for axis in (0, 2, 3))
    aside_px = followed.camera.fx * APART_M / ((one.position - eye) @ ahead)
    for copy in range(factor):  # In place, one by one: all at once they would take twice the memory.
        rows = slice(copy * len(one.frame), (copy + 1) * len(one.frame))
        number[rows] += copy * one.count
        if arm == "time":
            frame[rows] += copy * period
            continue
        column_row[rows, 0] += copy * aside_px
        position[rows] += APART_M * copy * right
        centre[rows] += APART_M * copy * right
    return replace(
        followed,
        trajectories=Trajectories(
            trajectory=number,
            frame=frame,
            position=position,
            column_row=column_row,
        ),
        patches=Patches(pixels=np.tile(around.pixels, factor), centre=centre),
        frames=factor * period if arm == "time" else followed.frames,
    )
