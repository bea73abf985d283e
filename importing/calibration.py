"""What is known of a camera, from options, from a file, or from the source itself; none of it has to be."""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float
from pydantic import Field, PositiveInt, field_validator

from recording.camera import PIXEL_CENTRE, Camera
from recording.checks import Frozen
from recording.errors import InputError

Positive = Annotated[float, Field(gt=0)]
Row = tuple[float, float, float, float]
INTRINSICS = ("fx", "fy", "cx", "cy")


class Calibration(Frozen):
    """The camera as calibrations have it. What is None is not known."""

    fx: Positive | None = None
    """Focal length along the columns, pixels."""
    fy: Positive | None = None
    """Focal length along the rows, pixels."""
    cx: float | None = None
    """Column of the principal point, pixels."""
    cy: float | None = None
    """Row of the principal point, pixels."""
    width: PositiveInt | None = None
    """Picture width, pixels."""
    height: PositiveInt | None = None
    """Picture height, pixels."""
    pixel_centre: float | None = None
    """Where the calibration has the centre of pixel (0, 0): 0, as most do (the default), or 0.5."""
    distortion: tuple[float, ...] | None = None
    """Coefficients of the lens in OpenCV's order; none of them, or zeros, is no distortion."""
    distortion_model: Literal["plumb_bob", "rational_polynomial", "equidistant"] | None = None
    """OpenCV's polynomial, under either of its names (the default), or its model of fisheye lenses."""
    fps: Positive | None = None
    """Frames a second; by default what the time stamps say."""
    scale: Positive | None = None
    """Metres of one unit of the stored numbers; by default a thousandth for whole numbers and 1 for others."""
    world_from_camera: tuple[Row, Row, Row, Row] | None = None
    """Rigid 4x4 transform, OpenCV axes, metres; by default the world is the camera."""

    @field_validator("pixel_centre")
    @classmethod
    def _one_of_two(cls, centre: float | None) -> float | None:
        if centre not in (None, 0.0, 0.5):
            raise ValueError("expected 0 or 0.5")
        return centre

    @field_validator("distortion")
    @classmethod
    def _of_a_model(cls, coefficients: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if coefficients is not None and len(coefficients) not in (0, 4, 5, 8, 12, 14):
            raise ValueError("expected 0, 4, 5, 8, 12 or 14 coefficients in OpenCV's order")
        return coefficients

    @field_validator("world_from_camera")
    @classmethod
    def _rigid(cls, rows: tuple[Row, Row, Row, Row] | None) -> tuple[Row, Row, Row, Row] | None:
        return None if rows is None else _as_rows(rigid(np.array(rows)))

    def under(self, other: "Calibration") -> "Calibration":
        """This calibration, overridden by all that the other one knows."""
        return self.model_copy(update=other.model_dump(exclude_none=True))

    def camera(self, width: int, height: int, *, source: str) -> Camera:
        """The camera in the recording's pixel convention, without its distortion; InputError where it is not known."""
        missing = [name for name in INTRINSICS if getattr(self, name) is None]
        if missing:
            raise InputError(
                f"{source}: expected the camera's fx, fy, cx and cy, but {', '.join(missing)} came from nowhere: pass "
                f"--{' --'.join(missing)}, or a calibration file by --camera"
            )
        for name, known, came in (("width", self.width, width), ("height", self.height, height)):
            if known is not None and known != came:
                raise InputError(
                    f"{source}: expected images {known} pixels in {name}, as the calibration says, got {came}: pass "
                    "the calibration of these images"
                )
        for name, side in (("cx", width), ("cy", height)):
            if not -0.5 * side <= getattr(self, name) <= 1.5 * side:
                raise InputError(f"{name}: expected about {side / 2:g} for {side} pixels, got {getattr(self, name):g}")
        shift = PIXEL_CENTRE - (self.pixel_centre or 0.0)
        return Camera(
            width=width,
            height=height,
            fx=self.fx or np.nan,
            fy=self.fy or np.nan,
            cx=(self.cx or 0.0) + shift,
            cy=(self.cy or 0.0) + shift,
            world_from_camera=np.eye(4) if self.world_from_camera is None else np.array(self.world_from_camera),
        )


def rigid(matrix: Float[np.ndarray, "4 4"]) -> Float[np.ndarray, "4 4"]:
    """The rigid transform that a matrix with rounded numbers means; ValueError where it is none.

    Written with three digits a rotation is off by a thousandth; so much is accepted, and the nearest rotation taken.
    """
    if not (np.isfinite(matrix).all() and np.allclose(matrix[3], [0, 0, 0, 1])):
        raise ValueError("expected (0, 0, 0, 1) as the last row")
    left, stretch, right = np.linalg.svd(matrix[:3, :3])
    if np.abs(stretch - 1).max() > 2e-3 or np.linalg.det(left @ right) < 0:
        raise ValueError("expected a rotation and a translation, without scale or mirroring")
    nearest = matrix.astype(np.float64)
    nearest[:3, :3] = left @ right
    nearest[3] = [0, 0, 0, 1]
    return nearest


def _as_rows(matrix: np.ndarray) -> tuple[Row, Row, Row, Row]:
    a, b, c, d = (tuple(map(float, row)) for row in matrix)
    return a, b, c, d  # type: ignore[return-value]  # mypy does not count the columns.
