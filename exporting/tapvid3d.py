"""TAPVid-3D archives (Koppula et al. 2024): points in 3D with their tracks through all frames.

Keys and conventions as in the data set's own description and as its evaluation reads them: `tracks_XYZ` (frame, track,
3) in the camera's axes, metres; `visibility` (frame, track); `queries_xyt` (track, 3), column and row, with the first
pixel's centre at (0.5, 0.5), and frame; `fx_fy_cx_cy`; `images_jpeg_bytes`, here pictures of the depth; and
`extrinsics_w2c`, camera from world, one a frame.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, UInt8

from exporting.npz import Archive, new_archive
from exporting.queries import Queries, chosen_rows, evenly_spread, first_seen, labels_at
from exporting.source import Source
from recording.camera import transformed
from recording.correspondence import material_places
from recording.frame import Labels
from recording.over_time import spread_numbers
from recording.sight import covering

_LOOKED_AT = 9
"""Frames that the range of the pictures' colours is taken from."""


def write_tapvid3d(source: Source, folder: Path) -> None:
    """Write `found/<name>.npz` from the motions and `truth/<name>.npz` from the truth, with the same tracks in both.

    A track begins where a trajectory of a motion was first seen; without motions at pixels of moving objects, spread
    evenly. Where the truth is known, tracks that begin in a pixel without an object are left out.
    """
    if source.motions is None:
        source.needed_truth("tapvid3d")
    queries = evenly_spread(source) if source.motions is None else first_seen(source)
    if source.recording.truth is not None:
        labels = labels_at(source, queries)
        known = labels.objectid[:, 0] != 0
        queries, labels = queries.of(known), chosen_rows(labels, known)
        with _new_file(source, folder / "truth", queries) as archive:
            archive.add("objectid", labels.objectid[:, 0].astype(np.int32))
            _add_tracks(archive, source, _TrueTracks(source, labels))
    if source.motions is not None:
        with _new_file(source, folder / "found", queries) as archive:
            archive.add("motion", queries.motion.astype(np.int32))
            _add_tracks(archive, source, _FoundTracks(source, queries))


class _TrueTracks:
    """Where the material points are; one is visible that lies in the picture with nothing before it."""

    def __init__(self, source: Source, labels: Labels) -> None:
        self._labels = labels
        self._camera = source.recording.camera
        self._truth = source.needed_truth("tapvid3d")

    def __len__(self) -> int:
        return len(self._labels.objectid)

    def places(self, frame: int) -> Float64[np.ndarray, "track 3"]:
        return material_places(self._labels, self._truth, at=frame)[:, 0]

    def visible(self, frame: int) -> Bool[np.ndarray, "track"]:
        places = self.places(frame)
        free = covering(self._truth, self._camera, places, frame=frame) == 0
        return free & self._camera.contains(self._camera.pixel_from_world(places)[0])


class _FoundTracks:
    """Where the motions say that their points are; one is visible that was observed."""

    def __init__(self, source: Source, queries: Queries) -> None:
        self._source = source
        self._trajectory = queries.trajectory

    def __len__(self) -> int:
        return len(self._trajectory)

    def places(self, frame: int) -> Float32[np.ndarray, "track 3"]:
        places = np.full((len(self), 3), np.float32(np.nan))
        moment = self._source.moment(frame)
        kept = np.isin(moment.trajectory, self._trajectory)
        places[np.searchsorted(self._trajectory, moment.trajectory[kept])] = moment.position[kept]
        return places

    def visible(self, frame: int) -> Bool[np.ndarray, "track"]:
        moment = self._source.moment(frame)
        return np.isin(self._trajectory, moment.trajectory[~moment.completed])


def _add_tracks(archive: Archive, source: Source, tracks: _TrueTracks | _FoundTracks) -> None:
    shape = (source.frames, len(tracks))
    camera_from_world = np.linalg.inv(source.recording.camera.world_from_camera)
    places = (transformed(camera_from_world, tracks.places(frame)) for frame in source.numbers("tracks"))
    archive.stream("tracks_XYZ", places, shape=(*shape, 3), dtype=np.float32)
    visible = (tracks.visible(frame) for frame in source.numbers("visibility"))
    archive.stream("visibility", visible, shape=shape, dtype=bool)


@contextmanager
def _new_file(source: Source, folder: Path, queries: Queries) -> Iterator[Archive]:
    """The recording's file in a new folder, with what does not depend on where the tracks come from."""
    camera = source.recording.camera
    folder.mkdir()
    with new_archive(folder / f"{source.name}.npz") as archive:
        archive.add("queries_xyt", np.column_stack([queries.column_row, queries.frame]).astype(np.float32))
        archive.add("fx_fy_cx_cy", np.array([camera.fx, camera.fy, camera.cx, camera.cy]))
        archive.add("extrinsics_w2c", np.tile(np.linalg.inv(camera.world_from_camera), (source.frames, 1, 1)))
        archive.add("images_jpeg_bytes", np.array(list(_pictures(source))))  # As fixed-size bytes: no pickles.
        yield archive


def _pictures(source: Source) -> Iterator[bytes]:
    """Every frame's depth as JPEG: near is light, what has no return is black."""
    frames = source.recording.frames
    some = spread_numbers(source.frames, _LOOKED_AT)
    depths = [frames[number].depth for number in some]
    present = np.concatenate([depth[np.isfinite(depth)] for depth in depths] or [np.zeros(0)])
    near, far = (present.min(), present.max()) if present.size else (0.0, 1.0)
    for number in source.numbers("pictures"):
        yield _picture(frames[number].depth, float(near), float(far))


def _picture(depth: Float32[np.ndarray, "row column"], near: float, far: float) -> bytes:
    share = np.clip((far - depth) / max(far - near, 1e-6), 0, 1)
    grey: UInt8[np.ndarray, "row column"] = np.nan_to_num(255 * share).astype(np.uint8)
    colour = cv2.applyColorMap(grey, cv2.COLORMAP_VIRIDIS)
    colour[np.isnan(depth)] = 0
    return bytes(cv2.imencode(".jpg", colour)[1])
