"""The X-ray twin: each moving object's depth as if nothing stood before it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

XRay = Mapping[int, Float32[np.ndarray, "row column"]]
"""Each moving object's depth as if nothing stood before it, metres; NaN where it is not."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cutout:
    """A rectangle of a depth picture; outside of it there is nothing."""

    row: int
    """The rectangle's first row in the picture."""
    column: int
    """The rectangle's first column in the picture."""
    depth: Float32[np.ndarray, "row column"]
    """Metres; NaN where there is nothing."""

    def picture(self, shape: tuple[int, int]) -> Float32[np.ndarray, "row column"]:
        """The whole picture of that many rows and columns."""
        whole = np.full(shape, np.float32(np.nan))
        rows, columns = self.depth.shape
        whole[self.row : self.row + rows, self.column : self.column + columns] = self.depth
        return whole

    def trimmed(self) -> "Cutout":
        """The smallest rectangle that has all depth; where there is none, the picture's first pixel."""
        there = np.isfinite(self.depth)
        rows, columns = np.flatnonzero(there.any(axis=1)), np.flatnonzero(there.any(axis=0))
        if not len(rows):
            return Cutout(row=0, column=0, depth=np.full((1, 1), np.float32(np.nan)))
        top, left = int(rows[0]), int(columns[0])
        depth = self.depth[top : int(rows[-1]) + 1, left : int(columns[-1]) + 1]
        return Cutout(row=self.row + top, column=self.column + left, depth=depth)


class CutoutXRay(Mapping[int, Float32[np.ndarray, "row column"]]):
    """An X-ray that keeps of each object only a rectangle, and makes the picture when it is asked for."""

    def __init__(self, cutouts: Mapping[int, Cutout], shape: tuple[int, int]) -> None:
        self.cutouts = dict(cutouts)
        self._shape = shape

    def __getitem__(self, objectid: int) -> Float32[np.ndarray, "row column"]:
        return self.cutouts[objectid].picture(self._shape)

    def __iter__(self) -> Iterator[int]:
        return iter(self.cutouts)

    def __len__(self) -> int:
        return len(self.cutouts)


def trimmed_cutouts(xray: XRay) -> dict[int, Cutout]:
    """The smallest cutout of each object, whatever the X-ray keeps."""
    if isinstance(xray, CutoutXRay):
        return {objectid: cutout.trimmed() for objectid, cutout in xray.cutouts.items()}
    return {objectid: Cutout(row=0, column=0, depth=depth).trimmed() for objectid, depth in xray.items()}
