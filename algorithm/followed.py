"""What the first steps leave to the later ones: the points that move, followed, and what is known beside them."""

from dataclasses import dataclass

from algorithm.patches import Patches
from algorithm.trajectories import Trajectories
from recording.camera import Camera


@dataclass(frozen=True, kw_only=True, eq=False)
class Followed:
    """A recording's moving points over time."""

    trajectories: Trajectories
    patches: Patches
    spacing_m: float
    """The recording's mean point spacing."""
    camera: Camera
    fps: float
    frames: int
    """Of the recording."""
