"""Flows kept where something moves: a few megabytes in place of hundreds."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int32, Int64

from algorithm.lifting import SceneFlow
from algorithm.scene_flow import Depth, ThereAndBack


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingFlows:
    """The flows between consecutive frames, there and back, of the pixels with a depth that moves; exact."""

    shape: tuple[int, int]
    """Rows and columns of a frame."""
    begin: Int64[np.ndarray, "_flow"]
    """The row at which each flow begins, forward and backward in turn; and where the last one ends."""
    pixel: Int32[np.ndarray, "row"]
    """Flat number of the pixel that the flow leads away from."""
    flow: Float32[np.ndarray, "row 3"]
    """Motion in the picture (column, row), pixels, and change of depth, metres; NaN where it is not known."""

    def pairs(self) -> Iterator[ThereAndBack]:
        """The flows of one pair of frames after the other, NaN where nothing moves."""
        for forward in range(0, len(self.begin) - 1, 2):
            yield self._whole(forward), self._whole(forward + 1)

    def _whole(self, number: int) -> SceneFlow:
        part = slice(self.begin[number], self.begin[number + 1])
        every = np.full((*self.shape, 3), np.nan, np.float32)
        every.reshape(-1, 3)[self.pixel[part]] = self.flow[part]
        return SceneFlow(column_row=every[..., :2], depth=every[..., 2])


class FlowsBegun:
    """The flows of some pairs of frames, while they are being made."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self._shape = shape
        self._pixels = [np.zeros(0, np.int32)]
        self._values = [np.zeros((0, 3), np.float32)]

    def add(self, both: ThereAndBack, moving: tuple[Depth, Depth]) -> None:
        """Take the next pair's flows in, less what they say of pixels without a depth in `moving`."""
        for flow, depth in zip(both, moving, strict=True):
            pixel = np.flatnonzero(np.isfinite(depth))
            values = np.concatenate([flow.column_row, flow.depth[..., None]], axis=-1)
            self._pixels.append(pixel.astype(np.int32))
            self._values.append(values.reshape(-1, 3)[pixel].astype(np.float32))

    def ended(self) -> MovingFlows:
        """All that was added."""
        return MovingFlows(
            shape=self._shape,
            begin=np.cumsum([len(pixel) for pixel in self._pixels]),
            pixel=np.concatenate(self._pixels),
            flow=np.concatenate(self._values),
        )
