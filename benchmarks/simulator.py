"""How fast a scene is cast and stored, part by part, beside Open3D's RaycastingScene and trimesh's Embree.

All cast the same meshes through the same pixels, frame by frame in turn. Open3D may use every core, a process of
ours uses one. Takes about a minute; `pip install unocclude[bench]` installs the others, without which they are
left out.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.


import cProfile
import tempfile
import time
from collections.abc import Callable
from itertools import islice
from typing import TypeVar

import numpy as np
from cyclopts import App

from benchmarks.tables import Row, run, show
from recording.camera import pixel_grid
from recording.store import write_picture
from recording.truth import MeshSequence
from simulator.backend import Backend, BackendWish, find_backend
from simulator.pictures import Stage, pictures
from simulator.raycast import RayCaster
from simulator.simulate import Simulation, prepared, write_simulation

Faces = np.ndarray
"""The face that each pixel sees, numbered through all objects in the order of their ids; -1 for none."""

Answer = TypeVar("Answer")

app = App(help=__doc__)
COMPARED = 20
"""Frames that everybody casts, spread over the scene."""
PARTS = {
    "which faces can be reached": ("reachable_faces",),
    "BVH (Mitsuba)": ("_Scene.__init__",),
    "rays (Mitsuba)": ("_Scene.nearest",),
    "exact points": ("met_points",),
    "nearest of all": ("_nearest", "_ideal_frame"),
    "frame to EXR": ("write_frame",),
    "X-ray to EXR": ("write_xray",),
}
"""The functions whose time each part is."""


@app.default
def simulator(
    *,
    scene: str = "9men",
    sizes: tuple[str, ...] = ("640x480", "240x180"),
    workers: int = 2,
    backend: BackendWish = "auto",
    json: bool = False,
) -> None:
    """Print milliseconds and frames a second, and how many times as long as Open3D each takes.

    Args:
        scene: A scene's name, or the path of its TOML file.
        sizes: Picture sizes.
        workers: Processes that write to disk together.
        backend: Ray caster: compiled (`llvm`), interpreted (`scalar`), or what works here.
        json: One JSON object in place of the table.
    """
    chosen, rows = find_backend(backend), []
    for size in sizes:
        simulation = prepared(scene, size=size)
        found = [*compared(simulation, chosen), *stored(simulation, chosen, workers), *parts(simulation, chosen)]
        rows += [{"size": size, **row} for row in found]
    show(f"{scene}: {chosen.reason}", rows, as_json=json)


def compared(simulation: Simulation, backend: Backend) -> list[Row]:
    """Casting alone: posed meshes to labels in memory, everybody in turn."""
    stage = simulation.stage
    few = stage.every(max(stage.frames // COMPARED, 1), begin=0)
    makers = {
        "picture (Mitsuba)": ours,
        "picture (Open3D)": open3d,
        "picture (trimesh, Embree)": embree,
    }
    casts = {name: cast for name, maker in makers.items() if (cast := maker(few, backend)) is not None}
    seconds, agree = dict.fromkeys(casts, 0.0), dict.fromkeys(casts, 0)
    for frame in range(few.frames):
        answers = {}
        for name, cast in casts.items():
            answers[name], spent = timed(lambda cast=cast, frame=frame: cast(frame))
            seconds[name] += spent
        for name, answer in answers.items():
            agree[name] += np.count_nonzero(answer == answers["picture (Mitsuba)"])
    _, whole = timed(lambda: sum(1 for _ in pictures(few, backend)))
    reference = seconds.get("picture (Open3D)")
    pixels = few.frames * few.camera.height * few.camera.width
    rows = [
        {**row(name, spent / few.frames, reference and spent / reference), "same labels": agree[name] / pixels}
        for name, spent in seconds.items()
    ]
    return [*rows, row("picture and X-ray, in memory", whole / few.frames, reference and whole / reference)]


def stored(simulation: Simulation, backend: Backend, workers: int) -> list[Row]:
    """From posed meshes to a recording on disk, the start of the workers and the truth included."""
    rows = []
    for count in dict.fromkeys((1, workers)):
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder) / "recording"
            _, spent = timed(
                lambda place=place, count=count: write_simulation(
                    simulation, place, backend=backend.name, workers=count
                )
            )
            size = sum(path.stat().st_size for path in place.rglob("*.*"))
        name = f"recording on disk, {count} process{'es' * (count > 1)}"
        frames = simulation.scene.frames
        rows.append({**row(name, spent / frames), "MB a frame": size / frames / 1e6})
    return rows


def parts(simulation: Simulation, backend: Backend) -> list[Row]:
    """What each part of a frame on disk costs in one process; profiling makes them all a little slower."""
    profile, frames = cProfile.Profile(), 0
    stage = simulation.stage
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "frames").mkdir()
        drawn = pictures(stage.every(max(stage.frames // COMPARED, 1), begin=0), backend)
        next(drawn)  # The first one compiles.
        profile.enable()
        for frame, xray in islice(drawn, COMPARED):
            write_picture(place, frames, frame, xray, metadata=simulation.metadata)
            frames += 1
        profile.disable()
        content = b"".join(path.read_bytes() for path in place.rglob("*.exr"))
        _, spent = timed(lambda: (place / "again").write_bytes(content))
    rows = [row(f"  {name}", seconds_in(profile, functions) / frames) for name, functions in PARTS.items()]
    return [*rows, row("  of which writing the bytes", spent / frames)]


def seconds_in(profile: cProfile.Profile, functions: tuple[str, ...]) -> float:
    """The time that a profile found in the functions of the project that have these names."""
    total = 0.0
    for entry in profile.getstats():
        name = getattr(entry.code, "co_qualname", "")
        file = getattr(entry.code, "co_filename", "")
        if name in functions and Path(file).parent.name in ("simulator", "recording"):
            total += entry.totaltime
    return total


def ours(stage: Stage, backend: Backend) -> Callable[[int], Faces]:
    """Our caster, with all meshes in one scene and without X-rays."""
    meshes = ordered(stage)
    first_face = dict(zip(meshes, np.cumsum([0, *(len(mesh.faces) for mesh in meshes.values())]), strict=False))
    number = np.zeros(max(meshes) + 1, dtype=np.int64)
    number[list(first_face)] = list(first_face.values())
    caster = RayCaster(meshes, stage.camera, backend)
    caster.cast(0)

    def cast(frame: int) -> Faces:
        hits = caster.cast(frame)
        return np.where(hits.objectid > 0, number[hits.objectid] + hits.face, -1)

    return cast


def open3d(stage: Stage, _: Backend) -> Callable[[int], Faces] | None:
    """Open3D's caster: a new scene for each frame, as it cannot move its meshes."""
    try:
        from open3d import core, t  # noqa: PLC0415 - it need not be there.
    except ImportError as error:
        print(f"without Open3D: {error}", file=sys.stderr)
        return None
    meshes = ordered(stage)
    rays = core.Tensor(np.concatenate(rays_of(stage), axis=-1).reshape(-1, 6))
    first_face = np.cumsum([0, *(len(mesh.faces) for mesh in meshes.values())])
    faces = [core.Tensor(mesh.faces.astype(np.uint32)) for mesh in meshes.values()]

    def cast(frame: int) -> Faces:
        scene = t.geometry.RaycastingScene()
        for mesh, corners in zip(meshes.values(), faces, strict=True):
            scene.add_triangles(core.Tensor(mesh.vertices_at(frame)), corners)
        met = scene.cast_rays(rays)
        mesh, face = met["geometry_ids"].numpy(), met["primitive_ids"].numpy().astype(np.int64)
        there = mesh != scene.INVALID_ID
        numbered = np.where(there, first_face[np.where(there, mesh, 0)] + face, -1)
        return numbered.reshape(stage.camera.height, stage.camera.width)

    cast(0)
    return cast


def embree(stage: Stage, _: Backend) -> Callable[[int], Faces] | None:
    """Trimesh with Embree: a new mesh for each frame; it tells the face alone."""
    try:
        import trimesh  # noqa: PLC0415 - only this caster wants it.
        from trimesh.ray.ray_pyembree import RayMeshIntersector  # noqa: PLC0415 - embreex need not be there.
    except ImportError as error:
        print(f"without embreex: {error}", file=sys.stderr)
        return None
    meshes = ordered(stage)
    origins, directions = (part.reshape(-1, 3) for part in rays_of(stage))
    first_vertex = np.cumsum([0, *(mesh.vertices.shape[1] for mesh in meshes.values())])
    faces = np.concatenate([mesh.faces + first for mesh, first in zip(meshes.values(), first_vertex, strict=False)])

    def cast(frame: int) -> Faces:
        vertices = np.concatenate([mesh.vertices_at(frame) for mesh in meshes.values()])
        solid = trimesh.Trimesh(vertices=vertices, faces=faces, process=False)
        face = RayMeshIntersector(solid).intersects_first(origins, directions)
        return np.asarray(face).reshape(stage.camera.height, stage.camera.width)

    cast(0)
    return cast


def ordered(stage: Stage) -> dict[int, MeshSequence]:
    """All meshes in the order of their ids."""
    return dict(sorted({**stage.moving, **stage.still}.items()))


def rays_of(stage: Stage) -> tuple[np.ndarray, np.ndarray]:
    """Origin and direction of each pixel's ray, world axes."""
    camera = stage.camera
    shape = (camera.height, camera.width)
    far = camera.world_from_pixel(pixel_grid(*shape), np.ones(shape))
    origins = np.broadcast_to(camera.position, far.shape)
    return origins.astype(np.float32), (far - origins).astype(np.float32)


def timed(work: Callable[[], Answer]) -> tuple[Answer, float]:
    """What the work returns, and the seconds that it took."""
    begun = time.perf_counter()
    return work(), time.perf_counter() - begun


def row(what: str, seconds: float, ratio: float | None = None) -> Row:
    """A line of the table."""
    return {"what": what, "ms a frame": 1e3 * seconds, "frames/s": 1 / seconds, "x Open3D": ratio}


if __name__ == "__main__":
    run(app)
