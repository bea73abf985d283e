"""Trajectories made by hand."""

from collections.abc import Sequence

import numpy as np
from scipy import sparse

from algorithm.trajectories import Trajectories


def trajectories_of(paths: Sequence[tuple[int, np.ndarray]]) -> Trajectories:
    """Trajectories from their first frames and places (frame, 3)."""
    lengths = [len(path) for _, path in paths]
    position = np.concatenate([np.zeros((0, 3)), *(np.asarray(path, float) for _, path in paths)])
    frame = np.concatenate([np.zeros(0, int), *(first + np.arange(len(path)) for first, path in paths)])
    return Trajectories(
        trajectory=np.repeat(np.arange(len(paths)), np.array(lengths, int)),
        frame=frame,
        position=position,
        column_row=np.zeros((len(position), 2)),
    )


def line(start: Sequence[float], step: Sequence[float], frames: int) -> np.ndarray:
    """Places at constant velocity."""
    return np.asarray(start, float) + np.arange(frames)[:, None] * np.asarray(step, float)


def random_paths(seed: int, count: int = 8, frames: int = 12) -> list[tuple[int, np.ndarray]]:
    """Random walks that begin and last as they like."""
    generator = np.random.default_rng(seed)
    return [
        (int(generator.integers(0, frames)), generator.normal(size=(int(generator.integers(1, frames)), 3)).cumsum(0))
        for _ in range(count)
    ]


def random_rotation(seed: int, *, mirrored: bool = False) -> np.ndarray:
    """A rotation, or a rotation with a mirror."""
    matrix = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    if (np.linalg.det(matrix) < 0) != mirrored:
        matrix[:, 0] *= -1
    return matrix


def blobs(sizes: list[int], bridge: float, seed: int = 0) -> sparse.csr_array:
    """Dense groups, each tied to the next by one edge of the bridge's weight."""
    weight = np.random.default_rng(seed).uniform(0.5, 1.0, (sum(sizes), sum(sizes)))
    label = np.repeat(np.arange(len(sizes)), sizes)
    weight *= label[:, None] == label
    ends = np.cumsum(sizes)
    for end in ends[:-1]:
        weight[end - 1, end] = bridge
    weight = np.triu(weight, 1)
    return sparse.csr_array(weight + weight.T)


def same_partition(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether the labels part alike, whatever their names."""
    return bool(((one[:, None] == one) == (other[:, None] == other)).all())
