"""Depth images that are in memory already, as a recording."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float32

from recording.camera import Camera
from recording.errors import InputError
from recording.frame import FARTHEST_M, NEAREST_M, Frame
from recording.metadata import metadata_of
from recording.recording import Recording


def depth_recording(
    depths: Sequence[np.ndarray], *, camera: Camera, fps: float, name: str | None = None, **known: Any
) -> Recording:
    """The recording of depth images in metres along the camera's z axis, one a frame.

    A pixel without a return is NaN or 0. `known` are further keys of `recording.json`, such as `timestamps`.
    """
    if not len(depths):
        raise InputError("expected depth images, got none")
    if not (np.isfinite(fps) and fps > 0):
        raise InputError(f"fps: expected a positive number of frames a second, got {fps:g}")
    frames = tuple(Frame(depth=_metres(depth, camera, number)) for number, depth in enumerate(depths))
    return Recording(metadata=metadata_of(camera, frames=len(frames), fps=fps, name=name, **known), frames=frames)


def _metres(depth: np.ndarray, camera: Camera, number: int) -> Float32[np.ndarray, "row column"]:
    """The depth of a frame, NaN where nothing returned; InputError where it cannot be one."""
    image = np.asarray(depth)
    if image.dtype.kind != "f":
        raise InputError(
            f"depth image {number}: expected metres as floating-point numbers, got {image.dtype}: multiply by "
            "the unit, such as 0.001 for millimetres"
        )
    if image.shape != (camera.height, camera.width):
        raise InputError(
            f"depth image {number}: expected {camera.height} rows and {camera.width} columns, as the camera has, "
            f"got shape {image.shape}"
        )
    if np.any(image < 0):
        raise InputError(f"depth image {number}: expected metres before the camera, got {np.nanmin(image):g}")
    present = image[np.isfinite(image) & (image > 0)]
    strange = present[(present < NEAREST_M) | (present > FARTHEST_M)]
    if strange.size:
        raise InputError(
            f"depth image {number}: expected metres from {NEAREST_M:g} to {FARTHEST_M:g}, got {strange[0]:g}: "
            "multiply by the unit"
        )
    return np.where(np.isfinite(image) & (image > 0), image, np.nan).astype(np.float32)
