"""USD (`.usdc`): the truth's meshes and the motions' points over time, for Blender and other 3D programs.

USD rather than glTF: it has samples over time, of vertices and of points whose number changes from frame to frame, and
these are what bodies that walk and motions that are completed are made of. glTF moves whole nodes and blends shapes: a
body in 300 frames would be 300 shapes, and a point that appears a node of its own. USD also states the unit, the upward
axis and the frame rate, and Blender reads all of it without an add-on.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Float64
from pxr import Gf, Usd, UsdGeom, Vt

from exporting.source import Source
from recording.camera import Camera
from recording.motions import Motions, Representative, mean_places
from recording.palette import TRUTH, colour_of, rgb

FRAMES_AT_ONCE = 32
"""So many frames are in memory before they are written."""
_SEEN_M, _COMPLETED_M, _WAY_M = 0.015, 0.02, 0.02
"""Widths of points and curves; as in all pictures the points that nobody saw are larger, and pale."""
_PALE = 0.4
"""Opacity of what nobody saw."""
_FILM = 0.36
"""Width of the camera's film: 36 mm in tenths of the unit, a metre, as USD has it."""
_OPENGL_FROM_OPENCV = np.diag([1.0, -1.0, -1.0, 1.0])
"""USD's cameras look along -z, with y up."""


def write_usd(source: Source, folder: Path) -> None:
    """Write `<name>.usdc`: metres, the world's axes with z up, a time code a frame.

    `/World/Camera`; `/World/Truth/object_N`, the mesh of each object; in `/World/Motions/motion_N` the points
    `motion_N_observed` and `motion_N_completed` of each frame and the curve `motion_N_way`. Noise is left out. A world
    of which nobody said which way is up is turned, so that the camera's top is, and y is the file's upward axis.
    """
    if source.motions is None:
        source.needed_truth("usd")
    stage = Usd.Stage.CreateNew(str(folder / f"{source.name}.usdc"))
    _state_units(stage, source)
    _add_camera(stage, source.recording.camera)
    meshes = _new_meshes(stage, source)
    clouds = _new_clouds(stage, source)
    for frame in source.numbers("USD"):
        for objectid, mesh in meshes.items():
            _set_points(mesh, (source.recording.truth or {})[objectid].vertices_at(frame), frame)
        if source.motions is not None:
            moment = source.moment(frame)
            for (motion, completed), cloud in clouds.items():
                own = (moment.motion == motion) & (moment.completed == completed)
                _set_points(cloud, moment.position[own], frame)
        if frame % FRAMES_AT_ONCE == 0:
            stage.Save()
    stage.Save()


def _state_units(stage: Usd.Stage, source: Source) -> None:
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(source.frames - 1)
    stage.SetTimeCodesPerSecond(source.recording.fps)
    stage.SetFramesPerSecond(source.recording.fps)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z if source.upright else UsdGeom.Tokens.y)
    if not source.upright:
        world.AddTransformOp().Set(
            _matrix(_OPENGL_FROM_OPENCV @ np.linalg.inv(source.recording.camera.world_from_camera))
        )


def _matrix(target_from_source: Float64[np.ndarray, "4 4"]) -> Gf.Matrix4d:
    """A transform as USD has it, for points that are rows."""
    return Gf.Matrix4d(target_from_source.T.tolist())


def _add_camera(stage: Usd.Stage, camera: Camera) -> None:
    shown = UsdGeom.Camera.Define(stage, "/World/Camera")
    shown.AddTransformOp().Set(_matrix(camera.world_from_camera @ _OPENGL_FROM_OPENCV))
    high = _FILM * camera.height / camera.width * camera.fx / camera.fy
    shown.CreateFocalLengthAttr(_FILM * camera.fx / camera.width)
    shown.CreateHorizontalApertureAttr(_FILM)
    shown.CreateVerticalApertureAttr(high)
    shown.CreateHorizontalApertureOffsetAttr(_FILM * (0.5 - camera.cx / camera.width))
    shown.CreateVerticalApertureOffsetAttr(high * (camera.cy / camera.height - 0.5))
    shown.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1000.0))


def _new_meshes(stage: Usd.Stage, source: Source) -> dict[int, UsdGeom.Mesh]:
    """The meshes that still need the vertices of every frame; those that never move are complete."""
    moving = {}
    UsdGeom.Xform.Define(stage, "/World/Truth")
    names = {entry.id: entry.name for entry in source.recording.metadata.objects or ()}
    for objectid, known in (source.recording.truth or {}).items():
        mesh = UsdGeom.Mesh.Define(stage, f"/World/Truth/object_{objectid}")
        mesh.GetPrim().SetDisplayName(names.get(objectid, ""))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(known.faces), 3, np.int32)))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(known.faces.reshape(-1)))
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        _paint(mesh, TRUTH)
        if known.moving:
            moving[objectid] = mesh
        else:
            _set_points(mesh, known.vertices_at(0), Usd.TimeCode.Default())
    return moving


def _new_clouds(stage: Usd.Stage, source: Source) -> dict[tuple[int, bool], UsdGeom.Points]:
    """By motion and whether it was completed: points that still need their places in every frame."""
    clouds = {}
    UsdGeom.Xform.Define(stage, "/World/Motions")
    motions = source.motions
    for motion in [] if motions is None else motions.motion_ids:
        UsdGeom.Xform.Define(stage, f"/World/Motions/motion_{motion}")
        for completed, name, width in ((False, "observed", _SEEN_M), (True, "completed", _COMPLETED_M)):
            cloud = UsdGeom.Points.Define(stage, f"{_motion_path(motion)}_{name}")
            cloud.CreateWidthsAttr(Vt.FloatArray([width]))
            cloud.SetWidthsInterpolation(UsdGeom.Tokens.constant)
            _paint(cloud, colour_of(motion), opacity=_PALE if completed else 1.0)
            clouds[motion, completed] = cloud
    for curve in [] if motions is None else _ways(motions):
        _add_way(stage, curve)
    return clouds


def _motion_path(motion: int) -> str:
    """Where the prims of a motion stand, and how their names begin: Blender knows objects by their names alone."""
    return f"/World/Motions/motion_{motion}/motion_{motion}"


def _ways(motions: Motions) -> tuple[Representative, ...]:
    return motions.representatives or mean_places(motions)


def _add_way(stage: Usd.Stage, curve: Representative) -> None:
    way = UsdGeom.BasisCurves.Define(stage, f"{_motion_path(curve.motion)}_way")
    way.CreateTypeAttr(UsdGeom.Tokens.linear)
    way.CreateCurveVertexCountsAttr(Vt.IntArray([len(curve.frame)]))
    way.CreateWidthsAttr(Vt.FloatArray([_WAY_M]))
    way.SetWidthsInterpolation(UsdGeom.Tokens.constant)
    _paint(way, colour_of(curve.motion))
    _set_points(way, curve.position, Usd.TimeCode.Default())


def _set_points(shape: UsdGeom.PointBased, points: Float[np.ndarray, "point 3"], time: Usd.TimeCode | int) -> None:
    values = Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points, np.float32))
    shape.GetPointsAttr().Set(values, time)
    shape.GetExtentAttr().Set(UsdGeom.PointBased.ComputeExtent(values), time)


def _paint(shape: UsdGeom.Gprim, colour: str, *, opacity: float = 1.0) -> None:
    """Give it a colour of the palette. USD has the colours of light, the palette those of screens (IEC 61966-2-1)."""
    shade = rgb(colour) / 255
    light = np.where(shade <= 0.04045, shade / 12.92, ((shade + 0.055) / 1.055) ** 2.4)
    shape.CreateDisplayColorAttr([Gf.Vec3f(*light.tolist())])
    shape.CreateDisplayOpacityAttr([opacity])
