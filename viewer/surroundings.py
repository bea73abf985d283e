"""What stands still in the scene: the ground, the camera, and in front of it what it sees."""

import math

import numpy as np
from jaxtyping import Float, Float32, UInt8
from viser import SceneNodeHandle
from viser.transforms import SO3

from algorithm.settings import Settings
from algorithm.static import background
from recording.palette import DEPTH, FAINT, rgb
from recording.recording import Recording
from recording.visibility import surface_points
from viewer.colours import scaled
from viewer.stage import Stage

_SHARE = 0.08
"""Size of the camera, as a share of the scene's."""
_WIDEST_PX = 320
"""Depth pictures are thinned out to this width at the most."""
_MOST_STILL = 60_000
_GREY = (120, 120, 120)
_REACH_RAD = math.radians(1.0)
"""So near to the ray of a click lies what was clicked on."""


def put_ground(stage: Stage) -> None:
    """A grid of metres at z = 0, where z is up."""
    if not stage.space.upright:
        return
    middle, width = stage.space.middle, 2 * math.ceil(stage.space.size_m)
    place = (float(round(middle[0])), float(round(middle[1])), 0.0)
    stage.server.scene.add_grid(
        "/ground",
        width=width,
        height=width,
        position=place,
        cell_size=1.0,
        cell_color=(225, 225, 225),
        section_size=5.0,
        section_color=(195, 195, 195),
        shadow_opacity=0.0,
    )


def still_nodes(stage: Stage, recording: Recording, settings: Settings, size_m: float) -> list[SceneNodeHandle]:
    """What stands still, as the solver sees it."""
    depths = [frame.depth for frame in recording.frames]
    still = background(depths, tolerance_m=settings.static_tolerance_m)
    points = surface_points(recording.camera, still.depth)
    points = points[:: -(-len(points) // _MOST_STILL) or 1]
    if not len(points):
        return []
    cloud = stage.server.scene.add_point_cloud(
        "/still",
        stage.space.near(points),
        rgb(FAINT),
        point_size=size_m,
        point_shading="gradient",
        point_shape="circle",
        position=stage.space.middle,
    )
    return [cloud]


def camera_nodes(stage: Stage, recording: Recording, depth_m: tuple[float, float], first: int) -> list[SceneNodeHandle]:
    """In each frame the camera as a frustum with its depth image, those of a frame first."""
    camera = recording.camera
    turn = SO3.from_matrix(camera.world_from_camera[:3, :3]).wxyz
    return [
        stage.server.scene.add_camera_frustum(
            stage.name(frame, "camera"),
            fov=2 * math.atan(camera.height / 2 / camera.fy),
            aspect=camera.width / camera.height,
            scale=_SHARE * stage.space.size_m,
            thickness=1.5,
            thickness_units="screen",
            color=_GREY,
            image=depth_picture(recording.frames[frame].depth, depth_m),
            format="png",
            wxyz=turn,
            position=camera.position - stage.space.middle,
            cast_shadow=False,
        )
        for frame in stage.from_frame(first)
    ]


def depth_picture(
    depth: Float32[np.ndarray, "row column"], depth_m: tuple[float, float]
) -> UInt8[np.ndarray, "less_rows less_columns 3"]:
    """A depth image in colours, white where nothing returned, thinned out."""
    step = -(-depth.shape[1] // _WIDEST_PX)
    few = depth[::step, ::step]
    colours = scaled(few.ravel(), *depth_m, DEPTH).reshape(*few.shape, 3)
    colours[~np.isfinite(few)] = 255
    return colours


def depth_bounds(recording: Recording) -> tuple[float, float]:
    """Between which depths nearly all returns lie, metres."""
    frames = range(0, recording.metadata.frames, max(recording.metadata.frames // 8, 1))
    depths = [depth[np.isfinite(depth)] for depth in (recording.frames[frame].depth for frame in frames)]
    known = np.concatenate(depths)
    if not len(known):
        return 0.0, 1.0
    near, far = np.percentile(known, (1, 99)).tolist()
    return near, max(far, near + 0.1)


def nearest_to_ray(
    points: Float[np.ndarray, "point 3"], origin: Float[np.ndarray, "3"], direction: Float[np.ndarray, "3"]
) -> int | None:
    """The point that a ray meets first: of those within a degree of it the nearest to its origin."""
    offset = points - origin
    along = offset @ (direction / np.linalg.norm(direction))
    distance = np.linalg.norm(offset, axis=1)
    near = np.flatnonzero(along > math.cos(_REACH_RAD) * distance)
    return int(near[along[near].argmin()]) if len(near) else None
