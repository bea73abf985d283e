"""Trajectories made by hand."""

from collections.abc import Sequence

import numpy as np
from scipy import sparse

from algorithm.followed import Followed
from algorithm.patches import Patches
from algorithm.segment_frames import SegmentFrames, segment_frames
from algorithm.trajectories import Trajectories
from recording.camera import Camera, looking_at


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


def body(
    first: int, start: Sequence[float], step: Sequence[float], frames: int, *, half: Sequence[float], count: int = 60
) -> list[tuple[int, np.ndarray]]:
    """The paths of points of a box about a centre that moves at constant velocity, the same points every time."""
    offsets = np.random.default_rng(0).uniform(-1.0, 1.0, (count, 3)) * np.asarray(half, float)
    return [(first, line(np.asarray(start, float) + offset, step, frames)) for offset in offsets]


def person(
    first: int, start: Sequence[float], step: Sequence[float], frames: int, *, count: int = 200
) -> list[tuple[int, np.ndarray]]:
    """A body of a person's size."""
    return body(first, start, step, frames, half=(0.2, 0.15, 0.85), count=count)


def walker(
    start: Sequence[float], step: Sequence[float], seen: Sequence[tuple[int, int]], *, count: int = 40
) -> list[tuple[int, np.ndarray]]:
    """The paths of a person who is at the start in frame 0, seen in some spans of frames (first, stop)."""
    paths = []
    for first, stop in seen:
        paths += person(first, np.asarray(start) + first * np.asarray(step), step, stop - first, count=count)
    return paths


def crossing() -> tuple[list[tuple[int, np.ndarray]], np.ndarray]:
    """Two who look alike and cross behind a wall for 1.3 s, and their segments: 0 goes on as 1, 2 as 3."""
    seen = ((0, 40), (80, 121))
    paths = walker((-2.4, 0, 0), (0.04, 0, 0), seen) + walker((2.4, 0.8, 0), (-0.04, 0, 0), seen)
    return paths, np.repeat(np.arange(4), 40)


def bare_patches(trajectories: Trajectories) -> Patches:
    """One pixel for every observed point, at its place."""
    return Patches(pixels=np.ones(len(trajectories.frame)), centre=trajectories.position)


def rows_of(trajectories: Trajectories, segment: Sequence[int]) -> SegmentFrames:
    """The segments' frames, seen from far away, so that every point has about the same area."""
    return segment_frames(
        trajectories, np.asarray(segment), bare_patches(trajectories), camera_position=np.array([0.0, -1000.0, 0.0])
    )


def followed_of(trajectories: Trajectories, *, fps: float = 30.0) -> Followed:
    """What the first steps would leave, of a camera 6 m before the origin that looks along y, z up."""
    camera = Camera(
        width=320,
        height=240,
        fx=200.0,
        fy=200.0,
        cx=160.0,
        cy=120.0,
        world_from_camera=looking_at((0.0, -6.0, 0.0), (0.0, 0.0, 0.0)),
    )
    return Followed(
        trajectories=trajectories,
        patches=bare_patches(trajectories),
        spacing_m=0.05,
        camera=camera,
        fps=fps,
        frames=int(trajectories.frame.max(initial=-1)) + 1,
    )
