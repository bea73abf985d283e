"""End-point errors of scene flow on depth, against the exact motion of every visible moving point."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from scipy.ndimage import distance_transform_edt

from algorithm.lifting import SceneFlow
from recording.camera import pixel_grid
from recording.correspondence import flow_between
from recording.recording import Recording

EDGE_M = 0.15
"""A neighbour that is nearer to the camera by more than this hides something: the pixel lies at an occlusion edge."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FlowErrors:
    """The errors of one flow at the pixels that count: moving, and visible in both frames; a row a pixel."""

    pixels: Float64[np.ndarray, "pixel"]
    """End-point error in the picture, pixels."""
    metres: Float64[np.ndarray, "pixel"]
    """End-point error in space, metres; where the flow knows no depth, as if the point had not moved."""
    height_share: Float64[np.ndarray, "pixel"]
    """Where the point lies between the object's lowest (0) and highest (1) point in this frame."""
    edge_px: Float64[np.ndarray, "pixel"]
    """Distance to the nearest occlusion edge, pixels; infinite without one."""


def flow_errors(recording: Recording, flow: SceneFlow, a: int, b: int) -> FlowErrors:
    """The errors of the flow of frame a to frame b; the truth is that of the material point behind each pixel."""
    truth, frame = flow_between(recording, a, b), recording.frames[a]
    labels = frame.labels
    if labels is None:
        raise ValueError("expected a recording with labels: flow_between would have refused it")
    counts = np.isin(labels.objectid, recording.moving_ids) & truth.visible & frame.seen
    clean = frame.depth if frame.clean_depth is None else frame.clean_depth
    camera, grid = recording.camera, pixel_grid(*frame.depth.shape)
    begun = camera.world_from_pixel(grid, clean.astype(np.float64))
    arrived = camera.world_from_pixel(grid + flow.column_row, clean + np.nan_to_num(flow.depth).astype(np.float64))
    moved = np.where(np.isfinite(flow.depth)[..., None], arrived - begun, 0.0)
    return FlowErrors(
        pixels=np.linalg.norm(flow.column_row - truth.pixels, axis=-1)[counts].astype(np.float64),
        metres=np.linalg.norm(moved - truth.metres, axis=-1)[counts],
        height_share=_height_shares(begun[..., 2], labels.objectid, counts),
        edge_px=_distance_to_edge(clean)[counts],
    )


def _height_shares(
    height: Float64[np.ndarray, "row column"], objectid: np.ndarray, counts: Bool[np.ndarray, "row column"]
) -> Float64[np.ndarray, "pixel"]:
    share = np.zeros(height.shape)
    for one in np.unique(objectid[counts]):
        own = objectid == one
        low, high = np.nanmin(height[own]), np.nanmax(height[own])
        share[own] = (height[own] - low) / max(high - low, 1e-9)
    return share[counts]


def _distance_to_edge(depth: np.ndarray) -> Float64[np.ndarray, "row column"]:
    """The distance of every pixel from the nearest one behind which something lies hidden, or that hides it."""
    edge = np.zeros(depth.shape, bool)
    with np.errstate(invalid="ignore"):
        for axis in (0, 1):
            jump = np.abs(np.diff(depth, axis=axis)) > EDGE_M
            edge |= np.concatenate([jump, np.zeros_like(np.take(edge, [0], axis))], axis)
            edge |= np.concatenate([np.zeros_like(np.take(edge, [0], axis)), jump], axis)
    return distance_transform_edt(~edge) if edge.any() else np.full(depth.shape, np.inf)
