"""Step 7: one curve for each segment (paper, section 4, Motion segmentation, figure 6)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import gaussian_filter1d

from algorithm.trajectories import Trajectories


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """The place of a segment or motion over consecutive frames."""

    first: int
    """Its first frame."""
    position: Float[np.ndarray, "moment 3"]
    """World axes, metres."""
    points: Float[np.ndarray, "moment"]
    """Number of observed points behind each place; 0 where it was completed."""

    @property
    def last(self) -> int:
        """Its last frame."""
        return self.first + len(self.position) - 1

    @property
    def frames(self) -> Int[np.ndarray, "moment"]:
        """Its frames."""
        return np.arange(self.first, self.last + 1)

    @property
    def observed(self) -> Bool[np.ndarray, "moment"]:
        """Where points stand behind the place."""
        return self.points > 0

    def between(self, first: int, last: int) -> "Curve":
        """The part from frame `first` to frame `last`, both included."""
        part = slice(first - self.first, last - self.first + 1)
        return Curve(first=first, position=self.position[part], points=self.points[part])


def representative(trajectories: Trajectories, *, drift_frames: float = 0.0) -> Curve:
    """The representative of a segment: its mean displacement summed from a trusted place.

    The place is the centre of mass of the densest frame; from there the mean displacement vector of the
    segment's points leads forward and backward. (The paper prints a mean of norms; it is a mean of
    vectors.) Frames between which no point was followed take the displacement of their neighbours.

    Summed displacements drift. With `drift_frames` above 0 the curve is drawn to the centres of mass of
    the frames with more than half as many points as the densest, where it is the body's and not that of
    what is left in sight: the difference is smoothed with a Gaussian of that many frames and added.
    """
    first, last = int(trajectories.frame.min()), int(trajectories.frame.max())
    moment = trajectories.frame - first
    count = np.bincount(moment, minlength=last - first + 1)
    centre = _mean_by(moment, trajectories.position, len(count))
    step = _steps(trajectories, moment, len(count))
    curve = np.concatenate([np.zeros((1, 3)), np.cumsum(step, axis=0)])
    anchor = int(np.argmax(count))
    curve += centre[anchor] - curve[anchor]
    if drift_frames > 0:
        curve += _smoothed_difference(centre - curve, count.astype(float), drift_frames)
    return Curve(first=first, position=curve, points=count.astype(float))


def _steps(trajectories: Trajectories, moment: np.ndarray, moments: int) -> Float[np.ndarray, "step 3"]:
    """The mean displacement from each frame to the next."""
    followed = np.flatnonzero(trajectories.trajectory[1:] == trajectories.trajectory[:-1])
    displacement = trajectories.position[followed + 1] - trajectories.position[followed]
    mean = _mean_by(moment[followed], displacement, moments - 1)
    known = np.flatnonzero(np.isfinite(mean[:, 0]))
    if not len(known):
        return np.zeros((moments - 1, 3))
    step = np.arange(moments - 1)
    return np.stack([np.interp(step, known, mean[known, axis]) for axis in range(3)], axis=1)


def _mean_by(group: np.ndarray, value: np.ndarray, groups: int) -> np.ndarray:
    """The mean of the values of each group; NaN for an empty one."""
    count = np.bincount(group, minlength=groups)
    total = np.stack([np.bincount(group, value[:, axis], groups) for axis in range(3)], axis=1)
    return np.where(count[:, None] > 0, total / np.maximum(count, 1)[:, None], np.nan)


def _smoothed_difference(difference: np.ndarray, count: np.ndarray, sigma: float) -> np.ndarray:
    weight = np.clip(2.0 * count / count.max() - 1.0, 0.0, 1.0) ** 2
    known = np.where(np.isfinite(difference), difference, 0.0) * weight[:, None]
    total = gaussian_filter1d(weight, sigma, mode="constant")
    smooth = gaussian_filter1d(known, sigma, axis=0, mode="constant") / np.maximum(total, 1e-12)[:, None]
    moment = np.arange(len(count))
    near = np.flatnonzero(total > 1e-3)  # Far from every well seen frame, what was known last goes on.
    return np.stack([np.interp(moment, near, smooth[near, axis]) for axis in range(3)], axis=1)
