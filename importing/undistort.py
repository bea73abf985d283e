"""Depth images as a lens without distortion would have seen them."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float32, Int, UInt32

from importing.calibration import Calibration
from recording.camera import PIXEL_CENTRE, Camera
from recording.errors import InputError
from recording.frame import Frame, Labels

_ONE_SURFACE = 0.05
"""Neighbours whose depths differ by less than this share of them lie on one surface."""
_CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))


@dataclass(frozen=True, kw_only=True, eq=False)
class Undistortion:
    """Where each pixel of the straight picture lies in the distorted one, pixel centres at integers."""

    column: Float32[np.ndarray, "row column"]
    row: Float32[np.ndarray, "row column"]

    def frame(self, frame: Frame) -> Frame:
        """The frame, straight. Depth along z is the same for any lens; only the pixels move."""
        labels = frame.labels and Labels(objectid=self.labels(frame.labels.objectid))
        return Frame(depth=self.depth(frame.depth), labels=labels)

    def labels(self, image: UInt32[np.ndarray, "row column"]) -> UInt32[np.ndarray, "row column"]:
        """The nearest pixel's number; 0 beyond the border."""
        inside, row, column = self._nearest(image.shape)
        return np.where(inside, image[row, column], np.uint32(0))

    def depth(self, depth: Float32[np.ndarray, "row column"]) -> Float32[np.ndarray, "row column"]:
        """The depth between the four pixels around, where all of them see one surface; else the nearest pixel's.

        Between a head and the wall behind it there is nothing, so depths of two surfaces are never mixed, nor are
        pixels without a return. On a plane 1/z is linear in the picture, so that is what is interpolated.
        """
        height, width = depth.shape
        inside, nearest_row, nearest_column = self._nearest(depth.shape)
        nearest = np.where(inside, depth[nearest_row, nearest_column], np.float32(np.nan))
        first_row, first_column = np.floor(self.row).astype(int), np.floor(self.column).astype(int)
        down, across = self.row - first_row, self.column - first_column
        corners, weights = [], []
        for step_row, step_column in _CORNERS:
            row, column = first_row + step_row, first_column + step_column
            known = (row >= 0) & (row < height) & (column >= 0) & (column < width)
            value = depth[row.clip(0, height - 1), column.clip(0, width - 1)]
            corners.append(np.where(known, value, np.float32(np.nan)))
            weights.append((down if step_row else 1 - down) * (across if step_column else 1 - across))
        four = np.stack(corners)
        one_surface = four.max(axis=0) - four.min(axis=0) < _ONE_SURFACE * four.min(axis=0)  # NaN: no.
        between = 1 / np.sum(np.stack(weights) / four, axis=0)
        return np.where(inside & one_surface, between, nearest).astype(np.float32)

    def _nearest(
        self, shape: tuple[int, ...]
    ) -> tuple[np.ndarray, Int[np.ndarray, "row column"], Int[np.ndarray, "row column"]]:
        row, column = np.rint(self.row).astype(int), np.rint(self.column).astype(int)
        inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
        return inside, row.clip(0, shape[0] - 1), column.clip(0, shape[1] - 1)


def undistortion(calibration: Calibration, camera: Camera) -> Undistortion | None:
    """How the camera's pictures are made straight, at the same size and focal length; None where they are already."""
    coefficients = np.array(calibration.distortion or ())
    if not coefficients.any():
        return None
    matrix = np.array([[camera.fx, 0, camera.cx - PIXEL_CENTRE], [0, camera.fy, camera.cy - PIXEL_CENTRE], [0, 0, 1]])
    size = (camera.width, camera.height)
    if calibration.distortion_model == "equidistant":
        if len(coefficients) != 4:
            raise InputError(f"distortion: expected 4 coefficients of a fisheye lens, got {len(coefficients)}")
        column, row = cv2.fisheye.initUndistortRectifyMap(matrix, coefficients, np.eye(3), matrix, size, cv2.CV_32FC1)
    else:
        column, row = cv2.initUndistortRectifyMap(matrix, coefficients, None, matrix, size, cv2.CV_32FC1)
    if not (np.isfinite(column).all() and np.isfinite(row).all()):
        raise InputError(f"distortion: expected coefficients of a lens, got {coefficients.tolist()}")
    far = 10 * max(size)  # Beyond it a float no longer fits into an index.
    return Undistortion(column=np.clip(column, -far, far), row=np.clip(row, -far, far))
