"""The readers of the project's own formats, those of what a user writes, and of walks and clips that scenes name."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from algorithm.settings import Settings, settings_from_file
from evaluation.sweeps.plan import load_sweep
from fuzz.samples import BVH, SWEEP
from fuzz.target import Target, saved
from recording.camera import Camera
from recording.corrections import Anchor, Correction, Corrections, load_corrections, save_corrections
from recording.exr import read_frame, read_xray
from recording.frame import Frame, Labels
from recording.manifest import Entry, FamilyRecord, Manifest, ManifestFormat, ObjectCounts, load_manifest
from recording.metadata import metadata_of
from recording.motions import Event, Link, Making, Motions, mean_places
from recording.occlusion import Achieved, Holes, Nearness
from recording.parquet import load_motions, save_motions
from recording.recording import Recording
from recording.store import load_recording, save_recording
from recording.truth import MeshSequence
from simulator.bvh import read_bvh
from simulator.family import load_family
from simulator.scene import load_scene
from simulator.tracks import tracks_of
from simulator.trajectory_file import Trajectory, recorded_walk

SHAPE = (3, 4)
SCENE = b"""name = "small"
frames = 2
fps = 15
[camera]
width = 24
height = 18
position = [0, -4, 1.2]
look_at = [0, 0, 1]
[[people]]
body = "man"
waypoints = [[-1, 0], [1, 0]]
speed = 1.2
[[balls]]
radius = 0.1
waypoints = [[0, 0, 1], [1, 0, 1]]
times = [0, 1]
[[obstacles]]
shape = "box"
position = [0, 1, 0]
size = [1, 0.2, 2]
"""
FAMILY = b'name = "tiny"\nframes = 2\n[camera]\nwidth = 24\nheight = 18\n[people]\ncount = [1, 2]\n[obstacles]\n'
WALKS = b"id,frame,x,y\n" + b"".join(b"3,%d,%d,0\n" % (frame, frame) for frame in range(9))


def _recording() -> Recording:
    camera = Camera(width=SHAPE[1], height=SHAPE[0], fx=4.0, fy=4.0, cx=2.0, cy=1.5)
    ids, ones = np.ones(SHAPE, np.uint32), np.ones(SHAPE, np.float32)
    labels = Labels(objectid=ids, face=0 * ids, u=ones / 3, v=ones / 3)
    frame = Frame(depth=ones, labels=labels, clean_depth=ones, reason=0 * ids)
    mesh = MeshSequence(faces=np.array([[0, 1, 2]], np.int32), vertices=np.ones((2, 3, 3), np.float32))
    metadata = metadata_of(camera, frames=2, fps=10.0, timestamps=(0.0, 0.1), name="tiny")
    return Recording(metadata=metadata, frames=(frame, frame), truth={1: mesh}, xray=({1: ones}, {1: ones}))


def _stored(name: str) -> list[bytes]:
    with TemporaryDirectory() as folder:
        save_recording(_recording(), Path(folder) / "tiny")
        return [(Path(folder) / "tiny" / name).read_bytes()]


def _motions_file() -> list[bytes]:
    rows = np.arange(4, dtype=np.int32)
    motions = Motions(
        frame=rows % 2,
        trajectory=rows // 2,
        position=np.ones((4, 3), np.float32),
        column_row=np.ones((4, 2), np.float32),
        segment=rows // 2,
        motion=rows // 2,
        source=np.array([0, 0, 1, 2], np.uint8),
        confidence=np.ones(4, np.float32),
        links=(Link(before=0, after=1, confidence=0.5),),
        events=(Event(kind="merge", frame=1, motions=(0, 1)),),
        making=Making(settings={"eps3": 1.0}, recording_digest="0", version="1", seconds={"total": 1.0}),
    )
    return saved("a.parquet", lambda path: save_motions(motions, path))


def _corrections_file() -> list[bytes]:
    anchor = Anchor(frame=0, column=1.5, row=2.5, segment=3)
    said = Corrections(recording_digest="0", correction=(Correction(kind="same", one=anchor, other=anchor),))
    return saved("a.toml", lambda path: save_corrections(said, path))


def _manifest() -> list[bytes]:
    achieved = Achieved(
        object_frames=2,
        hidden_object_frames=0,
        hole_frames=Holes(count=0, lengths=()),
        clearance_m=Nearness(people=None, obstacles=None),
    )
    entry = Entry(
        name="tiny-000001",
        seed=1,
        split="development",
        frames=2,
        fps=15.0,
        width=4,
        height=3,
        sensor="ideal",
        objects=ObjectCounts(moving=1, people=1, still=0),
        scene_digest="0",
        digest="0",
        achieved=achieved,
    )
    family = FamilyRecord(name="tiny", digest="0", document={"name": "tiny"})
    manifest = Manifest(format=ManifestFormat(), family=family, made_by="unocclude", recordings=(entry,))
    return [manifest.text.encode()]


def _read_all(folder: Path) -> None:
    recording = load_recording(folder)
    for mesh in (recording.truth or {}).values():
        mesh.vertices_at(0)


def _bare(folder: Path) -> None:
    """A recording whose description is fuzzed: the frames are there."""
    (folder / "frames").mkdir(exist_ok=True)
    for number in range(2):
        (folder / "frames" / f"{number:06d}.exr").touch()
    load_recording(folder)


def _truth(folder: Path) -> None:
    if not (folder / "recording.json").is_file():
        (folder / "recording.json").write_bytes(_stored("recording.json")[0])
    (folder / "frames").mkdir(exist_ok=True)
    for number in range(2):
        (folder / "frames" / f"{number:06d}.exr").touch()
    _read_all(folder)


def _walk(folder: Path) -> None:
    tracks_of(folder / "walks.txt", fps=10.0, metres=1.0)
    recorded_walk(Trajectory(file="walks.txt", id=3, fps=10.0), folder)


OWN = {
    "scene": Target(name="a.toml", read=lambda folder: load_scene(folder / "a.toml"), seeds=lambda: [SCENE]),
    "family": Target(name="a.toml", read=lambda folder: load_family(folder / "a.toml"), seeds=lambda: [FAMILY]),
    "sweep": Target(name="a.toml", read=lambda folder: load_sweep(folder / "a.toml"), seeds=lambda: [SWEEP.encode()]),
    "settings": Target(
        name="a.toml",
        read=lambda folder: settings_from_file(Settings(), folder / "a.toml"),
        seeds=lambda: [b'eps3 = 2.0\nflow = "range"\nremove_static = false\n'],
    ),
    "corrections": Target(
        name="a.toml", read=lambda folder: load_corrections(folder / "a.toml"), seeds=_corrections_file
    ),
    "recording": Target(name="recording.json", read=_bare, seeds=lambda: _stored("recording.json")),
    "manifest": Target(name="manifest.json", read=load_manifest, seeds=_manifest),
    "frame": Target(
        name="a.exr",
        read=lambda folder: read_frame(folder / "a.exr", shape=SHAPE),
        seeds=lambda: _stored("frames/000000.exr"),
    ),
    "xray": Target(
        name="a.exr",
        read=lambda folder: read_xray(folder / "a.exr", shape=SHAPE),
        seeds=lambda: _stored("xray/000000.exr"),
    ),
    "truth": Target(name="truth.npz", read=_truth, seeds=lambda: _stored("truth.npz")),
    "motions": Target(
        name="a.parquet", read=lambda folder: mean_places(load_motions(folder / "a.parquet")), seeds=_motions_file
    ),
    "bvh": Target(name="a.bvh", read=lambda folder: read_bvh(folder / "a.bvh"), seeds=lambda: [BVH.encode()]),
    "walks": Target(name="walks.txt", read=_walk, seeds=lambda: [WALKS]),
}
"""By what they read."""
