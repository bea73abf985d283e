"""The readers of what is imported: depth images, arrays and point clouds."""

from functools import partial
from pathlib import Path
from typing import Any

import cv2
import h5py
import numpy as np
import OpenEXR
import pypcd4
import trimesh
from scipy.io import savemat

from fuzz.target import Target, saved
from importing.calibration import Calibration
from importing.formats import opened
from importing.source import Wanted
from importing.timing import timeline
from importing.undistort import undistortion
from recording.metadata import metadata_of

DEPTH = np.array([[1000, 0, 1100, 1200], [1300, 1400, 1500, 1600], [1700, 1800, 1900, 2000]], np.uint16)
"""Millimetres."""
_FRAMES = np.stack([DEPTH, DEPTH + 50])
_CAMERA = Calibration(fx=4.0, fy=4.0, cx=1.5, cy=1.0)
_AT_A_RATE = Calibration(fps=10.0).under(_CAMERA)
_RATE = Calibration(fps=10.0)
_BESIDE: dict[str, Any] = {"K": np.array([[4.0, 0, 1.5], [0, 4, 1], [0, 0, 1]]), "timestamps": np.array([7.0, 7.1])}


def imported(source: Path, known: Calibration = _AT_A_RATE) -> None:
    """All that importing does but for the writing."""
    found = opened(source, Wanted(known=known))
    about = found.calibration.under(known)
    camera = found.camera or about.camera(found.width, found.height, source=str(source))
    times = timeline(found.times, count=found.count, fps=about.fps, dropped="empty", source=str(source))
    straight = undistortion(about, camera) if found.camera is None else None
    metadata_of(camera, frames=times.frames, fps=times.fps, timestamps=times.stamps)
    for frame in found.frames():
        if straight:
            straight.frame(frame)


def image(kind: str, depth: np.ndarray = DEPTH) -> bytes:
    """The depths as an image file."""
    done, content = cv2.imencode(kind, depth)
    assert done
    return content.tobytes()


def _exr() -> list[bytes]:
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    depth = (DEPTH / 1000).astype(np.float32)
    return saved(
        "a.exr",
        lambda path: OpenEXR.File(header, {"Z": depth}).write(str(path)),
        lambda path: OpenEXR.File(header, {"Y": DEPTH.astype(np.uint32)}).write(str(path)),
    )


def _archive() -> list[bytes]:
    return saved(
        "a.npz",
        lambda path: np.savez(path, depth=_FRAMES, **_BESIDE),
        lambda path: np.savez_compressed(path, z=np.asfortranarray(_FRAMES / 1000), fx=4, fy=4, cx=1, cy=1, fps=10),
    )


def _array() -> list[bytes]:
    return saved("a.npy", lambda path: np.save(path, _FRAMES), lambda path: np.save(path, DEPTH / 1000))


def _matlab() -> list[bytes]:
    arrays = {"depth": np.moveaxis(_FRAMES, 0, -1), **_BESIDE}
    return saved("a.mat", lambda path: savemat(path, arrays), lambda path: savemat(path, arrays, do_compression=True))


def _matlab73() -> list[bytes]:
    def save(path: Path) -> None:
        with h5py.File(path, "w", userblock_size=512) as file:
            for name, value in {"depth": _FRAMES, **_BESIDE}.items():
                file.create_dataset(name, data=np.atleast_2d(value))
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")

    return saved("a.mat", save)


def _points() -> np.ndarray:
    row, column = np.indices(DEPTH.shape)
    z = DEPTH / 1000
    points = np.stack([(column - 1.5) / 4 * z, (row - 1) / 4 * z, z], axis=-1).reshape(-1, 3)
    return points[points[:, 2] > 0]


def _array_of_points() -> list[bytes]:
    return saved("a.npy", lambda path: np.save(path, _points()))


def _ply() -> list[bytes]:
    cloud = trimesh.PointCloud(_points(), colors=np.full((len(_points()), 4), 255, np.uint8))
    return saved(
        "a.ply",
        lambda path: path.write_bytes(cloud.export(file_type="ply")),
        lambda path: path.write_bytes(cloud.export(file_type="ply", encoding="ascii")),
    )


def _pcd() -> list[bytes]:
    rows = np.column_stack([_points(), np.ones(len(_points()))]).astype(np.float32)
    cloud = pypcd4.PointCloud.from_xyzi_points(rows)
    return saved("a.pcd", *(partial(cloud.save, encoding=encoding) for encoding in pypcd4.Encoding))


def _xyz() -> list[bytes]:
    lines = "\n".join(" ".join(f"{value:.4f}" for value in point) for point in _points())
    return [f"# x y z\n{lines}\n".encode(), f"{len(_points())}\n{lines}\n".replace(" ", ",").encode()]


def _images(kind: str) -> Target:
    shown = [DEPTH] if kind != ".tiff" else [DEPTH, (DEPTH / 1000).astype(np.float32)]
    return Target(name=f"a{kind}", read=imported, seeds=lambda: [image(kind, depth) for depth in shown])


FOREIGN = {
    "png": _images(".png"),
    "tiff": _images(".tiff"),
    "pgm": _images(".pgm"),
    "exr": Target(name="a.exr", read=imported, seeds=_exr),
    "npz": Target(name="a.npz", read=lambda folder: imported(folder / "a.npz", Calibration()), seeds=_archive),
    "npy": Target(name="a.npy", read=lambda folder: imported(folder / "a.npy"), seeds=_array),
    "npy_points": Target(name="a.npy", read=partial(imported, known=_RATE), seeds=_array_of_points),
    "mat": Target(name="a.mat", read=lambda folder: imported(folder / "a.mat", _CAMERA), seeds=_matlab),
    "mat73": Target(name="a.mat", read=lambda folder: imported(folder / "a.mat", _CAMERA), seeds=_matlab73),
    "ply": Target(name="a.ply", read=partial(imported, known=_RATE), seeds=_ply),
    "pcd": Target(name="a.pcd", read=partial(imported, known=_RATE), seeds=_pcd),
    "xyz": Target(name="a.xyz", read=partial(imported, known=_RATE), seeds=_xyz),
}
"""By what they read."""
