"""Recordings on disk: `recording.json`, `frames/`, `xray/`, `truth.npz`."""

import os
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import overload

import numpy as np

from recording.atomic import whole_folder
from recording.camera import Camera
from recording.checks import json_document, lack_of, validated
from recording.errors import DAMAGED, InputError
from recording.exr import read_frame, read_xray, write_frame, write_xray
from recording.frame import Frame
from recording.metadata import Metadata
from recording.recording import Recording
from recording.truth import MeshSequence, Truth
from recording.xray import XRay


def write_recording(
    folder: Path,
    *,
    metadata: Metadata,
    frames: Iterable[tuple[Frame, XRay | None]],
    truth: Truth | None = None,
    overwrite: bool = False,
) -> None:
    """Write a recording while its frames are being made; the folder appears when all of it is there."""
    with new_recording(folder, truth=truth, overwrite=overwrite) as partial:
        for number, (frame, xray) in enumerate(frames):
            write_picture(partial, number, frame, xray, metadata=metadata)
        write_metadata(partial, metadata)


@contextmanager
def new_recording(folder: Path, *, truth: Truth | None = None, overwrite: bool = False) -> Iterator[Path]:
    """A folder to fill by `write_picture`, in any order and by any process, and by `write_metadata` at last.

    It becomes `folder` when the block ends well, and vanishes when it does not.
    """
    if folder.is_dir() and any(folder.iterdir()) and not (folder / "recording.json").is_file():
        raise InputError(f"{folder}: expected a recording to replace, got a folder of something else: choose another")
    with whole_folder(folder, overwrite=overwrite) as partial:
        (partial / "frames").mkdir()
        yield partial
        if not (partial / "recording.json").is_file():
            raise ValueError(f"{folder}: expected metadata before the end of the block")
        if truth is not None:
            _write_truth(partial / "truth.npz", truth)


def write_picture(partial: Path, number: int, frame: Frame, xray: XRay | None, *, metadata: Metadata) -> None:
    """Write one frame, and its X-ray if there is one, into the folder of a new recording."""
    camera = metadata.as_camera()
    write_frame(partial / "frames" / frame_name(number), frame, camera=camera, fps=metadata.fps)
    if xray:  # OpenEXR has no file without channels.
        (partial / "xray").mkdir(exist_ok=True)
        write_xray(partial / "xray" / frame_name(number), xray, shape=(camera.height, camera.width))


def write_metadata(partial: Path, metadata: Metadata) -> None:
    """Write `recording.json` into the folder of a new recording that has all its frames."""
    count = sum(1 for _ in (partial / "frames").iterdir())
    if count != metadata.frames:
        raise InputError(f"expected {metadata.frames} frames, got {count}")
    text = metadata.model_dump_json(indent=2, exclude_none=True)
    (partial / "recording.json").write_text(text + "\n", encoding="utf-8")


def save_recording(recording: Recording, folder: str | os.PathLike[str], *, overwrite: bool = False) -> None:
    """Write a recording that is complete."""
    xrays: Iterable[XRay | None] = recording.xray or [None] * recording.metadata.frames
    write_recording(
        Path(folder),
        metadata=recording.metadata,
        frames=zip(recording.frames, xrays, strict=True),
        truth=recording.truth,
        overwrite=overwrite,
    )


def load_recording(folder: str | os.PathLike[str]) -> Recording:
    """The recording in a folder; frames and truth are read when they are asked for."""
    place = Path(folder)
    description = place / "recording.json"
    if not description.is_file():
        raise InputError(f"{place}: expected a recording, but {lack_of(description.name, place)}")
    metadata = validated(Metadata, json_document(description), source=str(description))
    camera = metadata.as_camera()
    numbers = (_frame_path(place, number) for number in range(metadata.frames))
    missing = next((path for path in numbers if not path.is_file()), None)
    if missing is not None:
        raise InputError(f"{missing} is missing: recording.json promises {metadata.frames} frames")
    return Recording(
        metadata=metadata,
        frames=_StoredFrames(place, metadata.frames, camera),
        truth=_StoredTruth(place / "truth.npz", metadata.frames) if (place / "truth.npz").is_file() else None,
        xray=_StoredXRays(place, metadata.frames, camera) if (place / "xray").is_dir() else None,
    )


def frame_name(number: int) -> str:
    """The file name of a frame."""
    return f"{number:06d}.exr"


def _frame_path(folder: Path, number: int) -> Path:
    return folder / "frames" / frame_name(number)


class _Stored:
    """What frames and X-rays on disk have in common: they are counted, and read one by one."""

    def __init__(self, folder: Path, count: int, camera: Camera) -> None:
        self._folder = folder
        self._count = count
        self._shape = (camera.height, camera.width)

    def __len__(self) -> int:
        return self._count

    def _number(self, index: int) -> int:
        if not -self._count <= index < self._count:
            raise IndexError(index)
        return index % self._count


class _StoredFrames(_Stored, Sequence[Frame]):
    """The frames of a recording on disk."""

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Frame]: ...
    def __getitem__(self, index: int | slice) -> Frame | Sequence[Frame]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(self._count))]
        return read_frame(_frame_path(self._folder, self._number(index)), shape=self._shape)


class _StoredXRays(_Stored, Sequence[XRay]):
    """The X-ray twins of a recording on disk."""

    @overload
    def __getitem__(self, index: int) -> XRay: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[XRay]: ...
    def __getitem__(self, index: int | slice) -> XRay | Sequence[XRay]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(self._count))]
        path = self._folder / "xray" / frame_name(self._number(index))
        return read_xray(path, shape=self._shape)


class _StoredTruth(Mapping[int, MeshSequence]):
    """The meshes in a `truth.npz`, each read when it is first asked for."""

    def __init__(self, path: Path, frames: int) -> None:
        self._path = path
        self._frames = frames
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                names = [name.removeprefix("faces_") for name in arrays.files if name.startswith("faces_")]
                self._ids = sorted(map(int, names))
        except DAMAGED:
            raise InputError(f"{path}: expected a NumPy .npz archive: make the recording again") from None
        self._mesh = lru_cache(maxsize=None)(self._read)

    def __getitem__(self, objectid: int) -> MeshSequence:
        if objectid not in self._ids:
            raise KeyError(objectid)
        return self._mesh(objectid)

    def __iter__(self) -> Iterator[int]:
        return iter(self._ids)

    def __len__(self) -> int:
        return len(self._ids)

    def _read(self, objectid: int) -> MeshSequence:
        damaged = InputError(f"{self._path}: the mesh of object {objectid} is damaged: make it again")
        try:
            with self._path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                names = [f"{name}_{objectid}" for name in ("faces", "vertices")]
                if any(_swells(arrays.zip.getinfo(f"{name}.npy")) for name in names):
                    raise damaged
                faces, vertices = (arrays[name] for name in names)
        except DAMAGED:
            raise damaged from None
        if not _is_mesh(faces, vertices, self._frames):
            raise damaged
        return MeshSequence(faces=faces.astype(np.int32), vertices=vertices.astype(np.float32))


def _swells(member: zipfile.ZipInfo) -> bool:
    """Whether a member of an archive unpacks to far more than it is on disk, which no mesh does."""
    return member.file_size > 10**6 + 100 * member.compress_size


def _is_mesh(faces: np.ndarray, vertices: np.ndarray, frames: int) -> bool:
    """Whether the arrays are the faces, and the vertices in each frame or in the one of what stands still."""
    if faces.dtype.kind not in "iu" or vertices.dtype.kind != "f" or faces.ndim != 2 or vertices.ndim != 3:
        return False
    if faces.shape[1] != 3 or vertices.shape[2] != 3 or len(vertices) not in (1, frames):
        return False
    numbered = not faces.size or (faces.min() >= 0 and faces.max() < vertices.shape[1])
    return bool(numbered and np.isfinite(vertices).all())


def _write_truth(path: Path, truth: Truth) -> None:
    """Write the meshes uncompressed: vertices hardly compress, and reading one mesh then touches only it.

    The archive is an `.npz` whose members bear no date, so that the same scene gives the same bytes.
    """
    with zipfile.ZipFile(path, "w") as archive:
        for objectid, mesh in truth.items():
            for name, values in (("faces", mesh.faces), ("vertices", mesh.vertices)):
                undated = zipfile.ZipInfo(f"{name}_{objectid}.npy")
                with archive.open(undated, "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, values, allow_pickle=False)
