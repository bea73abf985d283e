"""What every pixel's ray meets first; the only module that knows Mitsuba and Dr.Jit.

Mitsuba tells the face. Where on the face is then worked out here, in float64: so both backends give the same
answer for the same face, and depth and material point agree to a float32's rounding.
"""

import contextlib
import functools
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from jaxtyping import Float32, Float64, Int64, Num, UInt32

from recording.camera import Camera, pixel_grid
from recording.truth import MeshSequence
from simulator.backend import LIBRARY_VARIABLE, Backend, likely_library
from simulator.facepoints import met_points
from simulator.window import Window, camera_points, reachable_faces, shared_window, window_around

_NOTHING = np.uint32(0xFFFFFFFF)
"""The face that a ray meets which meets none."""


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


@dataclass(frozen=True, kw_only=True, eq=False)
class _Posture:
    """The meshes as they are in one frame."""

    world: Float32[np.ndarray, "vertex 3"]
    """The vertices of all meshes, one after the other, world axes, metres."""
    points: Float64[np.ndarray, "3 vertex"]
    """The same in camera axes."""
    faces: Int64[np.ndarray, "reachable"]
    """The faces, numbered through all meshes, that are in `scene`."""
    window: Window
    """Where they are in the picture."""
    scene: "_Scene | None"
    """None where no ray reaches anything."""

    def nearest(
        self, origin: Float64[np.ndarray, "3"], directions: Float32[np.ndarray, "3 row column"]
    ) -> UInt32[np.ndarray, "row column"]:
        """Which one of `faces` each ray meets first; `_NOTHING` for none."""
        if self.scene is None or directions.size == 0:
            return np.full(directions.shape[1:], _NOTHING)
        return self.scene.nearest(origin, directions)


class RayCaster:
    """Casts one ray through every pixel's centre, in any frame of the meshes.

    Nearly all the time goes into the tree that Mitsuba builds of the faces, in every frame: so it is given only
    those that a pixel's ray can reach. Any number of casters may live at once.
    """

    def __init__(self, meshes: Mapping[int, MeshSequence], camera: Camera, backend: Backend) -> None:
        if any(identity <= 0 for identity in meshes):
            raise ValueError(f"object ids must be positive, as 0 means none; came {sorted(meshes)}")
        # A fixed order, without what cannot be hit: so the mapping's order is of no account.
        ids = [identity for identity in sorted(meshes) if len(meshes[identity].faces)]
        self._meshes = [meshes[identity] for identity in ids]
        self._camera = camera
        rays = _unit_depth_rays(camera)
        self._rays = np.ascontiguousarray(np.moveaxis(rays[..., :2], -1, 0))
        directions = (rays @ camera.world_from_camera[:3, :3].T).astype(np.float32)
        self._directions = np.ascontiguousarray(np.moveaxis(directions, -1, 0))
        counts = [len(mesh.faces) for mesh in self._meshes]
        self._first_face = np.cumsum([0, *counts])  # The faces are numbered through all meshes.
        self._mesh_of_face = np.repeat(np.arange(len(ids)), counts)
        self._id_of_mesh = np.array(ids, dtype=np.uint32)
        first_vertex = np.cumsum([0, *(mesh.vertices.shape[1] for mesh in self._meshes)])
        numbered = [mesh.faces + first for mesh, first in zip(self._meshes, first_vertex[:-1], strict=True)]
        self._faces = np.concatenate(numbered).astype(np.uint32) if ids else np.zeros((0, 3), dtype=np.uint32)
        self._backend = backend
        self._posture: _Posture | None = None

    def window(self, frame: int) -> Window:
        """A window outside of which nothing is seen in the frame."""
        return self._at(frame).window

    def cast(self, frame: int, window: Window | None = None) -> Hits:
        """What the pixels see in the frame: those of the window, or of the whole picture."""
        posture = self._at(frame)
        part = window or (slice(0, self._camera.height), slice(0, self._camera.width))
        inner = shared_window(part, posture.window)
        nearest = posture.nearest(self._camera.position, self._directions[:, *inner])
        there = nearest != _NOTHING
        met = posture.faces[nearest[there]]
        depth, u, v = met_points(self._rays[:, *inner][:, there], posture.points[:, self._faces[met].T])
        mesh = self._mesh_of_face[met]
        shape = (part[0].stop - part[0].start, part[1].stop - part[1].start)
        place = tuple(slice(a.start - b.start, a.stop - b.start) for a, b in zip(inner, part, strict=True))

        def image(values: Num[np.ndarray, "hit"], nothing: np.generic) -> Num[np.ndarray, "row column"]:
            pixels = np.full(shape, nothing)
            pixels[place][there] = values
            return pixels

        return Hits(
            depth=image(depth, np.float32(np.nan)),
            objectid=image(self._id_of_mesh[mesh], np.uint32(0)),
            face=image(met - self._first_face[mesh], np.uint32(0)),
            u=image(u, np.float32(0)),
            v=image(v, np.float32(0)),
        )

    def _at(self, frame: int) -> _Posture:
        """The meshes as they are in the frame; made anew only where they have moved since the last one."""
        vertices = [mesh.vertices_at(frame) for mesh in self._meshes]
        world = np.concatenate(vertices) if vertices else np.zeros((0, 3), dtype=np.float32)
        if self._posture is None or not np.array_equal(world, self._posture.world):
            points = camera_points(self._camera, world)
            faces = reachable_faces(self._camera, points, self._faces)
            window = window_around(self._camera, points)
            scene = _Scene(world, self._faces[faces], self._backend) if len(faces) else None
            self._posture = _Posture(world=world, points=points, faces=faces, window=window, scene=scene)
        return self._posture


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


class _Scene:
    """A mesh inside Mitsuba, for one frame: a new one costs no more than a change to an old one."""

    def __init__(
        self, vertices: Float32[np.ndarray, "vertex 3"], faces: UInt32[np.ndarray, "face 3"], backend: Backend
    ) -> None:
        self._backend = backend
        mitsuba = _mitsuba(backend)
        mesh = mitsuba.Mesh("mesh", len(vertices), len(faces))
        parameters = mitsuba.traverse(mesh)
        parameters["vertex_positions"] = vertices.ravel()
        parameters["faces"] = faces.ravel()
        parameters.update()
        # Optimising would reorder the mesh (Mitsuba issue 1796).
        self._scene = mitsuba.load_dict({"type": "scene", "mesh": mesh}, optimize=False)

    def nearest(
        self, origin: Float64[np.ndarray, "3"], directions: Float32[np.ndarray, "3 row column"]
    ) -> UInt32[np.ndarray, "row column"]:
        """The face that each ray meets first; `_NOTHING` for none."""
        cast = self._nearest_compiled if self._backend.name == "llvm" else self._nearest_one_by_one
        rays = np.ascontiguousarray(directions.reshape(3, -1))
        return cast(_mitsuba(self._backend), origin.tolist(), rays).reshape(directions.shape[1:])

    def _nearest_compiled(
        self, mitsuba: ModuleType, origin: list[float], directions: Float32[np.ndarray, "3 ray"]
    ) -> UInt32[np.ndarray, "ray"]:
        # Made of one array, the number of rays would be compiled into the kernel: one for each window.
        towards = mitsuba.Vector3f(*(mitsuba.Float(_aligned(axis)) for axis in directions))
        rays = mitsuba.Ray3f(mitsuba.Point3f(*origin), towards)
        met = self._scene.ray_intersect_preliminary(rays)
        nothing = mitsuba.UInt32(int(_NOTHING))
        return np.array(_drjit(self._backend).select(met.is_valid(), met.prim_index, nothing))

    def _nearest_one_by_one(
        self, mitsuba: ModuleType, origin: list[float], directions: Float32[np.ndarray, "3 ray"]
    ) -> UInt32[np.ndarray, "ray"]:
        start, nearest = mitsuba.Point3f(*origin), self._scene.ray_intersect_preliminary
        face = np.full(directions.shape[1], _NOTHING)
        for number, towards in enumerate(directions.T.tolist()):
            met = nearest(mitsuba.Ray3f(start, mitsuba.Vector3f(*towards)))
            if met.is_valid():
                face[number] = met.prim_index
        return face


def _aligned(values: Float32[np.ndarray, "ray"]) -> Float32[np.ndarray, "ray"]:
    """A copy that begins at a multiple of 64 bytes: Dr.Jit compiles a kernel for each alignment that it meets."""
    room = np.empty(len(values) + 16, dtype=np.float32)
    begin = -room.ctypes.data % 64 // room.itemsize
    copy = room[begin : begin + len(values)]
    copy[:] = values
    return copy


@functools.lru_cache(maxsize=2)
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
        import mitsuba  # noqa: PLC0415 - it imports drjit, hence the same.
    drjit.set_thread_count(1)  # Trees of a body's size are built no sooner by several; processes share the frames.
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
