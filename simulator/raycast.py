"""What every pixel's ray meets first; the only module that knows Mitsuba and Dr.Jit.

Mitsuba tells the object and the face. Where on the face is then worked out here, in float64: so both backends
give the same answer for the same face, and depth and material point agree to a float32's rounding.
"""

import contextlib
import functools
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Int64, Num, UInt32

from recording.camera import Camera, pixel_grid, transformed
from recording.truth import MeshSequence
from simulator.backend import LIBRARY_VARIABLE, Backend, likely_library
from simulator.facepoints import met_weights, weight_from_ray
from simulator.window import Window, window_around

_NOTHING = -1


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """What the pixels of a picture, or of a window of it, see."""

    depth: Float32[np.ndarray, "row column"]
    """Distance along the optical axis, metres; NaN where the ray meets nothing."""
    objectid: UInt32[np.ndarray, "row column"]
    """The object that is met, 0 where none is."""
    face: UInt32[np.ndarray, "row column"]
    """The object's face that is met, 0 where none is."""
    u: Float32[np.ndarray, "row column"]
    """Weight of the face's corner B: the point is (1 - u - v) A + u B + v C; 0 where nothing is met."""
    v: Float32[np.ndarray, "row column"]
    """Weight of the face's corner C; 0 where nothing is met."""


class RayCaster:
    """Casts one ray through every pixel's centre, in any frame of the meshes.

    Only meshes that move are handed over again for a new frame. Any number of casters may live at once.
    """

    def __init__(self, meshes: Mapping[int, MeshSequence], camera: Camera, backend: Backend) -> None:
        if any(identity <= 0 for identity in meshes):
            raise ValueError(f"object ids must be positive, as 0 means none; came {sorted(meshes)}")
        # A fixed order, without what cannot be hit: so the mapping's order is of no account.
        ids = [identity for identity in sorted(meshes) if len(meshes[identity].faces)]
        self._meshes = [meshes[identity] for identity in ids]
        self._camera = camera
        self._rays = _unit_depth_rays(camera)
        self._directions = (self._rays @ camera.world_from_camera[:3, :3].T).astype(np.float32)
        counts = [len(mesh.faces) for mesh in self._meshes]
        self._first_face = np.cumsum([0, *counts])  # The faces are numbered through all meshes.
        self._mesh_of_face = np.repeat(np.arange(len(ids)), counts)
        self._id_of_mesh = np.array(ids, dtype=np.uint32)
        self._weight_from_ray = np.empty((sum(counts), 3, 3))
        self._corners = np.empty((sum(counts), 3, 3))
        self._windows = [self._placed(number, 0) for number in range(len(ids))]
        self._frame = 0
        self._scene = _Scene(self._meshes, backend) if ids else None

    def cast(self, frame: int, window: Window | None = None) -> Hits:
        """What the pixels see in the frame: those of the window, or of the whole picture."""
        self._advance(frame)
        part = window or (slice(None), slice(None))
        rays = self._rays[part]
        pixel, met = self._nearest(part)
        corners = self._corners[met]
        weights = met_weights(rays.reshape(-1, 3)[pixel], self._weight_from_ray[met], corners)
        mesh = self._mesh_of_face[met]

        def image(values: Num[np.ndarray, "hit"], nothing: np.generic) -> Num[np.ndarray, "row column"]:
            pixels = np.full(rays.shape[:2], nothing)
            pixels.flat[pixel] = values
            return pixels

        return Hits(
            depth=image((weights * corners[:, :, 2]).sum(axis=1), np.float32(np.nan)),
            objectid=image(self._id_of_mesh[mesh], np.uint32(0)),
            face=image(met - self._first_face[mesh], np.uint32(0)),
            u=image(weights[:, 1], np.float32(0)),
            v=image(weights[:, 2], np.float32(0)),
        )

    def _nearest(self, part: Window) -> tuple[Int64[np.ndarray, "hit"], Int64[np.ndarray, "hit"]]:
        """The pixels of the window that see a mesh, and the faces, numbered through, that they see."""
        reachable = np.zeros(self._rays.shape[:2], dtype=bool)
        for window in self._windows:
            reachable[window] = True
        pixel = np.flatnonzero(reachable[part])
        if self._scene is None or len(pixel) == 0:
            return pixel[:0], pixel[:0]
        directions = self._directions[part].reshape(-1, 3)[pixel]
        mesh, face = self._scene.nearest(self._camera.position, directions)
        hit = mesh != _NOTHING
        return pixel[hit], self._first_face[mesh[hit]] + face[hit]

    def _advance(self, frame: int) -> None:
        """Bring all that moves to the frame."""
        if self._scene is None or frame == self._frame:
            return
        moving = [number for number, mesh in enumerate(self._meshes) if mesh.moving]
        for number in moving:
            self._windows[number] = self._placed(number, frame)
        self._scene.move({number: self._meshes[number].vertices_at(frame) for number in moving})
        self._frame = frame

    def _placed(self, number: int, frame: int) -> Window:
        """Work out how rays weigh the corners of the numbered mesh's faces; where the mesh can be seen."""
        mesh = self._meshes[number]
        vertices = mesh.vertices_at(frame).astype(np.float64)
        corners = transformed(np.linalg.inv(self._camera.world_from_camera), vertices)[mesh.faces]
        faces = slice(self._first_face[number], self._first_face[number + 1])
        self._weight_from_ray[faces] = weight_from_ray(corners)
        self._corners[faces] = corners
        return window_around(self._camera, vertices)


def casts_known_answer(backend: Backend) -> bool:
    """Whether the backend meets a triangle where it is, before and after a move, and nothing beside it."""
    triangle = np.array([[-1, -1, 2], [1, -1, 2], [0, 1, 2]], dtype=np.float32)
    mesh = MeshSequence(
        faces=np.array([[0, 1, 2]], dtype=np.int32), vertices=np.stack([triangle, triangle + np.float32(1)])
    )
    camera = Camera(width=9, height=9, fx=3.0, fy=3.0, cx=4.5, cy=4.5, world_from_camera=np.eye(4))
    caster = RayCaster({7: mesh}, camera, backend)
    for frame, depth in enumerate((2.0, 3.0)):
        hits = caster.cast(frame)
        pixel = (4 + frame, 4 + frame)
        ends_right = hits.objectid[pixel] == 7 and abs(hits.depth[pixel] - depth) < 1e-5
        if not ends_right or hits.objectid[0, 0] != 0:
            return False
    return True


def limit_threads(backend: Backend, count: int) -> None:
    """Let this process cast with so many threads: the cores divided by the processes at work."""
    _drjit(backend).set_thread_count(count)


class _Scene:
    """Meshes inside Mitsuba, in the order in which they were given."""

    def __init__(self, meshes: Sequence[MeshSequence], backend: Backend) -> None:
        self._backend = backend
        mitsuba = _mitsuba(backend)
        shapes = {_key(k): _mitsuba_mesh(mitsuba, _key(k), mesh) for k, mesh in enumerate(meshes)}
        # Optimising would merge and reorder the meshes (Mitsuba issue 1796).
        self._scene = mitsuba.load_dict({"type": "scene", **shapes}, optimize=False)
        self._parameters = mitsuba.traverse(self._scene)
        self._shapes = self._scene.shapes()
        order = {_key(k): k for k in range(len(meshes))}
        self._mesh_of_shape = [order[shape.id()] for shape in self._shapes]

    def move(self, vertices: Mapping[int, Float32[np.ndarray, "_vertex 3"]]) -> None:
        """Put the numbered meshes' vertices elsewhere, world axes, metres."""
        _mitsuba(self._backend)
        for k, mesh_vertices in vertices.items():
            self._parameters[f"{_key(k)}.vertex_positions"] = mesh_vertices.ravel()
        if vertices:
            self._parameters.update()

    def nearest(
        self, origin: Float64[np.ndarray, "3"], directions: Float32[np.ndarray, "ray 3"]
    ) -> tuple[Int64[np.ndarray, "ray"], Int64[np.ndarray, "ray"]]:
        """The mesh's number, -1 for none, and the face that each ray meets first."""
        cast = self._nearest_compiled if self._backend.name == "llvm" else self._nearest_one_by_one
        return cast(_mitsuba(self._backend), origin.tolist(), directions)

    def _nearest_compiled(
        self, mitsuba: ModuleType, origin: list[float], directions: Float32[np.ndarray, "ray 3"]
    ) -> tuple[Int64[np.ndarray, "ray"], Int64[np.ndarray, "ray"]]:
        drjit = _drjit(self._backend)
        towards = mitsuba.Vector3f(np.ascontiguousarray(directions.T))
        met = self._scene.ray_intersect_preliminary(mitsuba.Ray3f(mitsuba.Point3f(*origin), towards))
        drjit.eval(met)

        def numbers(shapes: Any) -> Int64[np.ndarray, "shape"]:
            return np.array(drjit.reinterpret_array(mitsuba.UInt32, shapes)).astype(np.int64)

        # A shape is known by its number in Mitsuba's registry: 0 for none, else as the process has it.
        registered = numbers(self._scene.shapes_dr())
        mesh_of_number = np.full(registered.max() + 1, _NOTHING)
        mesh_of_number[registered] = self._mesh_of_shape
        return mesh_of_number[numbers(met.shape)], np.array(met.prim_index).astype(np.int64)

    def _nearest_one_by_one(
        self, mitsuba: ModuleType, origin: list[float], directions: Float32[np.ndarray, "ray 3"]
    ) -> tuple[Int64[np.ndarray, "ray"], Int64[np.ndarray, "ray"]]:
        start, nearest = mitsuba.Point3f(*origin), self._scene.ray_intersect_preliminary
        mesh_of_shape = dict(zip(self._shapes, self._mesh_of_shape, strict=True))
        mesh = np.full(len(directions), _NOTHING)
        face = np.zeros(len(directions), dtype=np.int64)
        for number, towards in enumerate(directions.tolist()):
            met = nearest(mitsuba.Ray3f(start, mitsuba.Vector3f(*towards)))
            if met.is_valid():
                mesh[number], face[number] = mesh_of_shape[met.shape], met.prim_index
        return mesh, face


def _key(number: int) -> str:
    return f"mesh_{number}"


def _mitsuba_mesh(mitsuba: ModuleType, key: str, mesh: MeshSequence) -> Any:
    """The mesh in its first frame, as Mitsuba's own."""
    inside = mitsuba.Mesh(key, mesh.vertices.shape[1], len(mesh.faces))
    parameters = mitsuba.traverse(inside)
    parameters["vertex_positions"] = mesh.vertices_at(0).ravel()
    parameters["faces"] = mesh.faces.astype(np.uint32).ravel()
    parameters.update()
    return inside


def _unit_depth_rays(camera: Camera) -> Float64[np.ndarray, "row column 3"]:
    """The direction of each pixel's ray, camera axes, as long as it takes to be 1 m deep."""
    return camera.camera_from_pixel(pixel_grid(camera.height, camera.width), np.ones((camera.height, camera.width)))


@functools.cache
def _libraries(wanted: str | None) -> tuple[ModuleType, ModuleType]:
    """Mitsuba and Dr.Jit, which loads its LLVM but once: when it is first imported, whatever the backend."""
    library = wanted or likely_library()
    loaded = os.environ.get(LIBRARY_VARIABLE) if "drjit" in sys.modules else library
    if wanted and loaded != wanted:
        raise RuntimeError(f"this process has loaded LLVM from {loaded}, not {wanted}: start another")
    if library:
        os.environ[LIBRARY_VARIABLE] = library
    with contextlib.nullcontext() if wanted else _silent_standard_error():
        import drjit  # noqa: PLC0415 - the variable must be set first.
        import mitsuba  # noqa: PLC0415 - the same.
    return mitsuba, drjit


@contextlib.contextmanager
def _silent_standard_error() -> Iterator[None]:
    """Let C code complain to nobody: Dr.Jit does, about an LLVM that the scalar backend never needs."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        kept = os.dup(2)
        os.dup2(nowhere.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def _mitsuba(backend: Backend) -> ModuleType:
    """Mitsuba, set to the backend: it keeps the choice for the whole process, so each use makes it anew."""
    mitsuba, _ = _libraries(backend.library)
    mitsuba.set_variant("llvm_ad_rgb" if backend.name == "llvm" else "scalar_rgb")
    return mitsuba


def _drjit(backend: Backend) -> ModuleType:
    return _libraries(backend.library)[1]
