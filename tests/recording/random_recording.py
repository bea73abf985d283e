"""A recording with random numbers in every place that a recording has."""

from dataclasses import replace

import numpy as np
from worlds import small_camera

from recording.camera import looking_at
from recording.frame import Frame, Labels
from recording.metadata import ObjectRecord, metadata_of
from recording.recording import Recording
from recording.truth import MeshSequence

FRAMES, HEIGHT, WIDTH = 3, 4, 5


def full_recording() -> Recording:
    """Random numbers in every place that a recording has."""
    generator = np.random.default_rng(1)
    camera = replace(small_camera(WIDTH, HEIGHT), world_from_camera=looking_at((1.0, 2.0, 3.0), (0.0, 5.0, 1.0)))
    objects = (
        ObjectRecord(id=2, name="walker", kind="person", moving=True),
        ObjectRecord(id=7, name="wall", kind="box", moving=False),
    )
    return Recording(
        metadata=metadata_of(
            camera, frames=FRAMES, fps=12.5, name="full", objects=objects, seed=3, timestamps=(0.0, 0.1, 0.3)
        ),
        frames=tuple(random_frame(generator) for _ in range(FRAMES)),
        truth={2: random_mesh(generator, FRAMES), 7: random_mesh(generator, 1)},
        xray=tuple({2: random_depth(generator)} for _ in range(FRAMES)),
    )


def random_depth(generator: np.random.Generator) -> np.ndarray:
    depth = generator.uniform(0.5, 9.0, (HEIGHT, WIDTH)).astype(np.float32)
    depth[generator.random(depth.shape) < 0.3] = np.nan
    return depth


def random_frame(generator: np.random.Generator) -> Frame:
    labels = Labels(
        objectid=generator.integers(0, 8, (HEIGHT, WIDTH), np.uint32),
        face=generator.integers(0, 2**32 - 1, (HEIGHT, WIDTH), np.uint32),  # More than a float32 could hold.
        u=generator.random((HEIGHT, WIDTH), np.float32),
        v=generator.random((HEIGHT, WIDTH), np.float32),
    )
    reason = generator.integers(0, 4, (HEIGHT, WIDTH), np.uint32)
    return Frame(depth=random_depth(generator), labels=labels, clean_depth=random_depth(generator), reason=reason)


def random_mesh(generator: np.random.Generator, frames: int) -> MeshSequence:
    return MeshSequence(
        faces=generator.integers(0, 6, (4, 3), np.int32),
        vertices=generator.normal(size=(frames, 6, 3)).astype(np.float32),
    )
