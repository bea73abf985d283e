"""Steps 1 and 2 over a recording: how every point moves from a frame to another and back."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from algorithm.depth_image import (
    continued_behind,
    depth_range,
    grey_image,
    nearness_image,
    shading_image,
    smoothed_depth,
)
from algorithm.flow import flow_b_from_a
from algorithm.lifting import SceneFlow, lifted
from algorithm.noise import surface_noise_m
from algorithm.range_flow import View, agreed, range_flow
from algorithm.settings import ImageName, Settings
from recording.camera import Camera

Depth = Float32[np.ndarray, "row column"]
Image = UInt8[np.ndarray, "row column"]
PixelFlow = Float32[np.ndarray, "row column 2"]
"""Motion (column, row) of every pixel of one frame to another, pixels; NaN where it is not known."""
FlowBetween = Callable[[int, int], PixelFlow]
"""Takes frames a and b; gives the flow from a to b."""
ThereAndBack = tuple[SceneFlow, SceneFlow]
FlowsBetween = Callable[[int, int], ThereAndBack]
"""Takes frames a and b; gives the flow from a to b and that from b to a."""
_FRAMES_AT_HAND = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Footage:
    """The frames of a recording, as the solver sees them."""

    moving: Sequence[Depth]
    """Depth without what stands still, metres; NaN = nothing."""
    sensed: Sequence[Depth]
    """Depth as it came."""
    camera: Camera
    fps: float


def flows_between(footage: Footage, settings: Settings, given: FlowBetween | None = None) -> FlowsBetween:
    """The scene flows of the settings' method; a pixel flow that is given takes the place of step 1."""
    if given is not None:
        return _lifted_flows(footage, settings, given)
    if settings.flow == "range":
        return _range_flows(footage, settings)
    method, image = settings.flow, lru_cache(_FRAMES_AT_HAND)(image_of(footage, settings, settings.image))
    return _lifted_flows(footage, settings, lambda a, b: flow_b_from_a(image(a), image(b), method=method))


def _range_flows(footage: Footage, settings: Settings) -> FlowsBetween:
    """Range flow, each way averaged with the way back."""
    noise_m = surface_noise_m(footage.moving)
    image = image_of(footage, settings, settings.image)
    near = settings.similar_depth_m

    @lru_cache(_FRAMES_AT_HAND)
    def view(number: int) -> View:
        surface = smoothed_depth(footage.moving[number], similar_depth_m=near)
        return View(surface=surface, image=image(number))

    def both(a: int, b: int) -> ThereAndBack:
        views = view(a), view(b)
        forward, backward = _at_once(lambda one, other: range_flow(views[one], views[other], noise_m=noise_m))
        return agreed(forward, backward, *views), agreed(backward, forward, *views[::-1])

    return both


def _lifted_flows(footage: Footage, settings: Settings, flow: FlowBetween) -> FlowsBetween:
    """Flow in the picture, lifted by the depths that it leads to."""

    def one_way(a: int, b: int) -> SceneFlow:
        return lifted(
            flow(a, b),
            footage.moving[a],
            footage.moving[b],
            similar_depth_m=settings.similar_depth_m,
            largest_step_m=settings.fastest_m_per_s / footage.fps,
        )

    return lambda a, b: _at_once(lambda one, other: one_way((a, b)[one], (a, b)[other]))


def _at_once(flow: Callable[[int, int], SceneFlow]) -> ThereAndBack:
    """The flows from 0 to 1 and from 1 to 0, in two threads; in one where OpenCV may have no more.

    (`OPENCV_FOR_THREADS_NUM=1`.) So workers that share the cores among them keep to one thread each.
    """
    with ThreadPoolExecutor(2 if cv2.getNumThreads() > 1 else 1) as threads:
        forward, backward = threads.map(flow, (0, 1), (1, 0))
    return forward, backward


def image_of(footage: Footage, settings: Settings, kind: ImageName) -> Callable[[int], Image]:
    """The image of a frame that flow can follow (step 0): depth as grey or brightness, or the lit surface."""
    within = depth_range(footage.moving) if kind in ("grey", "nearness") else (0.0, 1.0)

    def image(number: int) -> Image:
        moving = footage.moving[number]
        if kind == "grey":
            plain = grey_image(moving, within=within)
        elif kind == "nearness":
            plain = nearness_image(moving, within=within)
        else:
            plain = shading_image(moving, camera=footage.camera, similar_depth_m=settings.similar_depth_m)
        if not settings.remove_static:
            return plain
        return continued_behind(plain, moving, footage.sensed[number])

    return image
