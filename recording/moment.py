"""One frame of a simulated recording with all that is said about it, as `verify` compares it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Float64

from recording.camera import Camera
from recording.correspondence import exact_labels, material_places
from recording.frame import Frame, Labels
from recording.recording import Recording
from recording.sight import DepthRange, first_depths
from recording.truth import Truth
from recording.xray import XRay


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """A frame, its labels and X-ray twin, and what truth and camera make of them."""

    number: int
    frame: Frame
    camera: Camera
    truth: Truth
    depth: Float[np.ndarray, "row column"]
    """Before the sensor, metres; NaN where there is nothing."""
    measured: Float64[np.ndarray, "row column 3"]
    """The points by depth and camera, world axes, metres; NaN where there is nothing."""
    labels: Labels
    material: Float64[np.ndarray, "row column 3"]
    """The labels' material points by the truth, world axes, metres; NaN where there is none."""
    cast: Mapping[int, DepthRange]
    """Where each object's mesh, alone, lies behind the pixels."""
    xray: XRay
    """Empty where there is none."""
    known: tuple[int, ...]
    """The ids of `recording.json`."""
    moving: tuple[int, ...]
    """Those of them that move."""
    before: "Moment | None"
    """The frame before; it knows none before itself."""


def moment_of(recording: Recording, truth: Truth, frame: Frame, *, number: int, before: Moment | None = None) -> Moment:
    """The moment of the frame of that number. What stands still is cast for the first frame only."""
    labels = exact_labels(frame, number)
    depth = frame.depth if frame.clean_depth is None else frame.clean_depth
    return Moment(
        number=number,
        frame=frame,
        camera=recording.camera,
        truth=truth,
        depth=depth,
        measured=recording.camera.world_points(depth),
        labels=labels,
        material=material_places(labels, truth, at=number),
        cast={
            objectid: before.cast[objectid]
            if before is not None and not mesh.moving
            else first_depths(mesh, recording.camera, frame=number)
            for objectid, mesh in truth.items()
        },
        xray={} if recording.xray is None else dict(recording.xray[number]),  # Pictures that are made once.
        known=tuple(entry.id for entry in recording.metadata.objects or ()),
        moving=recording.moving_ids,
        before=None if before is None else replace(before, before=None),
    )
