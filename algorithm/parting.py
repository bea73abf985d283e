"""A segment that holds several objects, parted between points of which somebody says to whom they belong.

What keeps together stays together as in step 5; where that joins the points themselves, a random walker decides [Grady,
"Random walks for image segmentation", PAMI 2006]: everything belongs to the point that a walk from it, along what
keeps together, likeliest meets first.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from algorithm.affinity import neighbour_pairs
from algorithm.grouping import separations
from algorithm.settings import Settings
from algorithm.trajectories import Trajectories

_SEED_M = 0.15
"""What is seen so near a marked point belongs to the same object."""
_CLOSEST_M = 1e-3
"""No two keep together better than this."""
_LEAK = 1e-9
"""So that no walk is endless."""


def parted(
    trajectories: Trajectories,
    marks: Int[np.ndarray, "mark"],
    label: Int[np.ndarray, "mark"],
    settings: Settings,
    *,
    fps: float,
) -> Int[np.ndarray, "trajectory"]:
    """The label of each trajectory of a segment; marks are rows of the trajectories, labels count from 0.

    A part that nothing joins to a mark gets the label whose parts it keeps nearest to, the longest together first.
    """
    pairs = neighbour_pairs(trajectories, neighbours=settings.neighbours, radius_m=settings.neighbour_radius_m)
    separation = separations(trajectories, pairs, fps=fps, loosest_m=settings.loosest_m)
    together = np.isfinite(separation)
    ends = pairs[0][together], pairs[1][together]
    weight = np.maximum(separation[together], _CLOSEST_M) ** -2.0
    joints = sparse.coo_array((weight, ends), shape=(trajectories.count, trajectories.count)).tocsr()
    part = connected_components(joints, directed=False)[1]
    found = _walked(joints + joints.T, _seeds(trajectories, marks, label), part)
    return _with_loose_parts(found, part, trajectories)


def _seeds(
    trajectories: Trajectories, marks: Int[np.ndarray, "mark"], label: Int[np.ndarray, "mark"]
) -> Int[np.ndarray, "trajectory"]:
    """The label of what is seen beside a mark, of several the nearest one's; -1 elsewhere."""
    found, nearest = np.full(trajectories.count, -1), np.full(trajectories.count, np.inf)
    for row, name in zip(marks.tolist(), label.tolist(), strict=True):
        now = np.flatnonzero(trajectories.frame == trajectories.frame[row])
        distance = np.linalg.norm(trajectories.position[now] - trajectories.position[row], axis=1)
        number = trajectories.trajectory[now]
        nearer = (distance <= _SEED_M) & (distance < nearest[number])
        found[number[nearer]], nearest[number[nearer]] = name, distance[nearer]
    return found


def _walked(
    joints: sparse.csr_array, seed: Int[np.ndarray, "trajectory"], part: Int[np.ndarray, "trajectory"]
) -> Int[np.ndarray, "trajectory"]:
    """The label that a walk from each trajectory likeliest meets first; -1 where it meets none."""
    reached = np.isin(part, part[seed >= 0])
    free = np.flatnonzero(reached & (seed < 0))
    fixed = np.flatnonzero(seed >= 0)
    is_label = np.eye(int(seed.max()) + 1)[seed[fixed]]
    found = seed.copy()
    if len(free):
        degree = np.asarray(joints.sum(axis=1)).reshape(-1) + _LEAK
        laplacian = sparse.diags_array(degree[free]) - joints[free][:, free]
        met = splu(laplacian.tocsc()).solve(joints[free][:, fixed] @ is_label)
        found[free] = met.argmax(axis=1)
    return found


def _with_loose_parts(
    label: Int[np.ndarray, "trajectory"], part: Int[np.ndarray, "trajectory"], trajectories: Trajectories
) -> Int[np.ndarray, "trajectory"]:
    """The labels, those of the parts that have none as well."""
    found = label.copy()
    while (found < 0).any():
        paths = [_path(trajectories, found == name) for name in range(int(found.max()) + 1)]
        loose = {number: _path(trajectories, part == number) for number in np.unique(part[found < 0]).tolist()}
        common = {
            number: max(len(np.intersect1d(path[0], other[0])) for other in paths) for number, path in loose.items()
        }
        number = max(common, key=lambda each: common[each])
        found[part == number] = int(np.argmin([_distance_m(loose[number], path) for path in paths]))
    return found


_Path = tuple[Int[np.ndarray, "moment"], Float[np.ndarray, "moment 3"]]


def _path(trajectories: Trajectories, which: Bool[np.ndarray, "trajectory"]) -> _Path:
    """The frames in which any of the trajectories is seen, and their mean place in each."""
    rows = which[trajectories.trajectory]
    frame, index = np.unique(trajectories.frame[rows], return_inverse=True)
    total = np.zeros((len(frame), 3))
    np.add.at(total, index, trajectories.position[rows])
    return frame, total / np.bincount(index)[:, None]


def _distance_m(one: _Path, other: _Path) -> float:
    """The mean distance of one path from another, which rests before its first frame and after its last, metres."""
    frame, place = one
    beside = np.stack([np.interp(frame, other[0], other[1][:, axis]) for axis in range(3)], axis=1)
    return float(np.linalg.norm(place - beside, axis=1).mean())
