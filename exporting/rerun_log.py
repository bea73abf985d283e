"""Rerun recordings (`.rrd`): depth, motions and truth over time, for the Rerun viewer."""

from pathlib import Path

import numpy as np
import rerun as rr

from exporting.source import Moment, Source
from recording.motions import NOISE, mean_places
from recording.palette import TRUTH, colour_of, rgb, rgb_of

APPLICATION = "unocclude"
FRAMES_AT_ONCE = 32
"""So many frames are in memory before they are written."""
_SEEN_M, _COMPLETED_M = 0.008, 0.012
"""Radii of points, as in all pictures those that nobody saw are larger, and pale."""
_PALE = 110
"""Alpha of what nobody saw."""


def write_rerun(source: Source, folder: Path) -> None:
    """Write `<name>.rrd`; its timelines are `frame`, and `time` in seconds from the first frame.

    Entities: `world/camera`, with its `depth`; `world/observed` and `world/completed`, the points of motions;
    `world/ways/N`, the way of motion N; `world/truth/N`, the mesh of object N.
    """
    path = folder / f"{source.name}.rrd"
    log = rr.RecordingStream(APPLICATION, recording_id=f"{source.name}-{source.digest[:12]}")
    log.set_log_tick_enabled(False)
    log.set_log_time_enabled(False)
    log.save(path)
    _log_still(log, source)
    for frame in source.numbers("Rerun"):
        log.set_time("frame", sequence=frame)
        log.set_time("time", duration=frame / source.recording.fps)
        depth = np.nan_to_num(source.recording.frames[frame].depth, nan=0.0)
        log.log("world/camera/depth", rr.DepthImage(depth, meter=1.0))
        if source.motions is not None:
            moment = source.moment(frame)
            _log_points(log, "world/observed", moment.of(~moment.completed), _SEEN_M, 255)
            _log_points(log, "world/completed", moment.of(moment.completed), _COMPLETED_M, _PALE)
        for objectid, mesh in (source.recording.truth or {}).items():
            if mesh.moving:
                log.log(f"world/truth/{objectid}", rr.Mesh3D.from_fields(vertex_positions=mesh.vertices_at(frame)))
        if frame % FRAMES_AT_ONCE == 0:
            log.flush()
    log.disconnect()


def _log_still(log: rr.RecordingStream, source: Source) -> None:
    """The camera, the motions' ways, and the faces of all meshes with the vertices of those that never move."""
    camera = source.recording.camera
    up = rr.ViewCoordinates.RIGHT_HAND_Z_UP if source.upright else rr.ViewCoordinates.RDF
    log.log("world", up, static=True)
    placed = rr.Transform3D(translation=camera.position, mat3x3=camera.world_from_camera[:3, :3])
    pinhole = rr.Pinhole(
        focal_length=[camera.fx, camera.fy],
        principal_point=[camera.cx, camera.cy],
        width=camera.width,
        height=camera.height,
        camera_xyz=rr.ViewCoordinates.RDF,
    )
    log.log("world/camera", placed, pinhole, static=True)
    for objectid, mesh in (source.recording.truth or {}).items():
        known = rr.Mesh3D.from_fields(triangle_indices=mesh.faces, albedo_factor=[*rgb(TRUTH), 255])
        log.log(f"world/truth/{objectid}", known, static=True)
        if not mesh.moving:
            still = rr.Mesh3D.from_fields(vertex_positions=mesh.vertices_at(0))
            log.log(f"world/truth/{objectid}", still, static=True)
    if source.motions is not None:
        for curve in source.motions.representatives or mean_places(source.motions):
            way = rr.LineStrips3D([curve.position], colors=[rgb(colour_of(curve.motion))])
            log.log(f"world/ways/{curve.motion}", way, static=True)


def _log_points(log: rr.RecordingStream, entity: str, moment: Moment, radius_m: float, alpha: int) -> None:
    shades = np.column_stack([rgb_of(moment.motion), np.full(len(moment.motion), alpha, np.uint8)])
    log.log(entity, rr.Points3D(moment.position, colors=shades, radii=[radius_m], class_ids=moment.motion - NOISE))
