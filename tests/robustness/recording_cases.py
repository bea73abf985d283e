"""Wrong recordings."""

import io
import shutil
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from case import Case, Damage, cut, deep, every_frame, framed, keyed, linked, removed, written

from recording.exr import read_channels, write_channels

SOLVE = "solve {place}/small -o {place}/out.parquet"
VERIFY = "verify {place}/small"
ABOUT, FRAME, TRUTH = "small/recording.json", "small/frames/000001.exr", "small/truth.npz"
FULL = np.full((18, 24), 3, np.float32)
TURN = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def sparse(place: Path) -> None:
    with (place / ABOUT).open("r+b") as file:
        file.truncate(2**30)


def huge(place: Path) -> None:
    text = (place / ABOUT).read_text(encoding="utf-8")
    (place / ABOUT).write_text(text.replace('"fps": 15.0', '"fps": 1e999', 1), encoding="utf-8")


def bomb(place: Path) -> None:
    """An EXR file whose header promises 100,000 x 100,000 pixels."""
    content = (place / FRAME).read_bytes()
    begin = content.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
    window = struct.pack("<4i", 0, 0, 99_999, 99_999)
    (place / FRAME).write_bytes(content[:begin] + window + content[begin + 16 :])


def folder_frame(place: Path) -> None:
    (place / FRAME).unlink()
    (place / FRAME).mkdir()


def swapped(place: Path) -> None:
    frames = place / "small" / "frames"
    (frames / "000001.exr").rename(frames / "x")
    (frames / "000004.exr").rename(frames / "000001.exr")
    (frames / "x").rename(frames / "000004.exr")


def repeated(place: Path) -> None:
    for number in range(1, 6):
        shutil.copy(place / "small/frames/000000.exr", place / f"small/frames/{number:06d}.exr")


def truth_with(**changes: Callable[[np.ndarray], np.ndarray]) -> Damage:
    """Change arrays of the truth: a function of each."""

    def damage(place: Path) -> None:
        arrays = dict(np.load(place / TRUTH))
        for name, change in changes.items():
            arrays[name] = change(arrays[name])
        np.savez(place / TRUTH, **arrays)

    return damage


def pickled(place: Path) -> None:
    np.savez(place / TRUTH, faces_1=np.array([{"evil": 1}], object), vertices_1=np.zeros((1, 3, 3)))


def zip_bomb(place: Path) -> None:
    np.savez_compressed(place / TRUTH, faces_1=np.zeros((1, 3), int), vertices_1=np.zeros((6, 10**6, 3), np.float32))


def array_bomb(place: Path) -> None:
    """An array of a few bytes whose header promises terabytes."""
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f4", "fortran_order": False, "shape": (6, 10**12, 3)})
    with zipfile.ZipFile(place / TRUTH, "w") as archive:
        archive.writestr("faces_1.npy", head.getvalue())
        archive.writestr("vertices_1.npy", head.getvalue())


def without_xray(place: Path) -> None:
    shutil.rmtree(place / "small" / "xray")


def strange_label(place: Path) -> None:
    channels = read_channels(place / FRAME, shape=(18, 24))
    channels["objectid"] += np.uint32(77) * (channels["objectid"] > 0)
    write_channels(place / FRAME, channels, attributes={})


def killed(place: Path) -> None:
    """What a run leaves that was killed while it wrote motions."""
    (place / ".out.parquet.partial").write_text("half", encoding="utf-8")


DESCRIPTION = (
    Case(
        input="no folder", command="solve {place}/none", says="none: expected a recording, but there is no such folder"
    ),
    Case(
        input="a file for the folder", command="solve {place}/small.toml", says="expected a recording, but it is a file"
    ),
    Case(input="a name of 300 letters", command="solve {place}/" + "x" * 300, says="File name too long"),
    Case(input="zero bytes", command=SOLVE, damage=written(ABOUT, ""), says="recording.json: expected JSON"),
    Case(input="truncated", command=SOLVE, damage=cut(ABOUT, 0.5), says="recording.json: expected JSON"),
    Case(input="foreign: a PNG", command=SOLVE, damage=written(ABOUT, b"\x89PNG\r\n\xff"), says="got: no UTF-8"),
    Case(input="UTF-16", command=SOLVE, damage=written(ABOUT, "{}".encode("utf-16")), says="got: no UTF-8"),
    Case(input="a gigabyte", command=SOLVE, damage=sparse, says="got: more than 256 MB"),
    Case(
        input="lists nested 100,000 deep",
        command=SOLVE,
        damage=written(ABOUT, "[" * 100_000),
        says="expected JSON, but maximum recursion depth exceeded",
    ),
    Case(input="a number of 5,000 digits", command=SOLVE, damage=written(ABOUT, "9" * 5000), says="expected JSON, but"),
    Case(input="NaN", command=SOLVE, damage=keyed("fps", float("nan")), says="NaN is no JSON number"),
    Case(input="a number beyond floating point", command=SOLVE, damage=huge, says="fps: input should be"),
    Case(input="a list for the object", command=SOLVE, damage=written(ABOUT, "[]"), says="recording.json: "),
    Case(input="an unknown key", command=SOLVE, damage=keyed("widht", 3), says="'widht', did you mean 'width'?"),
    Case(input="a missing key", command=SOLVE, damage=keyed("fps", None), says="key 'fps' is missing"),
    Case(input="a later version", command=SOLVE, damage=keyed("format.version", 2), says="format.version"),
    Case(input="another format", command=SOLVE, damage=keyed("format.name", "mp4"), says="format.name"),
    Case(input="millimetres", command=SOLVE, damage=keyed("depth.unit", "mm"), says="depth.unit"),
    Case(input="depth along the ray", command=SOLVE, damage=keyed("depth.kind", "ray"), says="depth.kind"),
    Case(input="no frames", command=SOLVE, damage=keyed("frames", 0), says="frames"),
    Case(input="10^15 frames", command=SOLVE, damage=keyed("frames", 10**15), says="000006.exr is missing"),
    Case(input="no frame rate", command=SOLVE, damage=keyed("fps", 0), says="fps"),
    Case(input="a picture 10^9 wide", command=SOLVE, damage=keyed("width", 10**9), says="width"),
    Case(input="a negative height", command=SOLVE, damage=keyed("height", -18), says="height"),
    Case(
        input="time stamps that are missing",
        command=SOLVE,
        damage=keyed("timestamps", [0.0, 1.0]),
        says="expected 6 timestamps, one a frame, got 2",
    ),
    Case(
        input="a time stamp twice",
        command=SOLVE,
        damage=keyed("timestamps", [0, 1, 1, 2, 3, 4]),
        says="expected timestamps that grow",
    ),
    Case(input="no focal length", command=SOLVE, damage=keyed("camera.fx", 0), says="camera.fx"),
    Case(input="a huge focal length", command=SOLVE, damage=keyed("camera.fy", 1e300), says="camera.fy"),
    Case(
        input="a mirrored camera",
        command=SOLVE,
        damage=keyed("camera.world_from_camera.0", [-1, 0, 0, 0]),
        says="expected a rotation and a translation",
    ),
    Case(
        input="a camera 10^300 m away",
        command=SOLVE,
        damage=keyed("camera.world_from_camera", [*TURN[:2], [0, 0, 1, 1e300], TURN[3]]),
        says="expected a camera within 100000 m",
    ),
    Case(
        input="a matrix of three rows",
        command=SOLVE,
        damage=keyed("camera.world_from_camera", TURN[:3]),
        says="camera.world_from_camera",
    ),
    Case(
        input="two objects of one id",
        command=SOLVE,
        damage=keyed("objects", [{"id": 1, "name": "a", "kind": "ball", "moving": True}] * 2),
        says="expected every object id once",
    ),
    Case(
        input="wrong intrinsics",
        command=VERIFY,
        damage=keyed("camera.cx", 15.0),
        status=1,
        says="projection",
        becomes="solved as they say; `verify` of a simulated recording fails",
    ),
    Case(
        input="rotated axes",
        command=VERIFY,
        damage=keyed("camera.world_from_camera", TURN),
        status=1,
        says="point",
        becomes="solved in these axes, for nothing assumes which way is up; `verify` of a simulated recording fails",
    ),
    Case(
        input="a name that is a path, `../../x`",
        command=SOLVE,
        damage=keyed("name", "../../x"),
        status=0,
        says="solved",
        becomes="taken as words: no file is called by it",
    ),
    Case(
        input="a Unicode name",
        command=SOLVE,
        damage=keyed("name", "Straße 人波 🎈"),
        status=0,
        says="solved",
        becomes="kept",
    ),
    Case(
        input="a byte order mark",
        command=SOLVE,
        damage=lambda place: (place / ABOUT).write_bytes(b"\xef\xbb\xbf" + (place / ABOUT).read_bytes()),
        status=0,
        says="solved",
        becomes="read",
    ),
)
FRAMES = (
    Case(input="a missing frame", command=SOLVE, damage=removed(FRAME), says="000001.exr is missing"),
    Case(input="zero bytes", command=SOLVE, damage=written(FRAME, ""), says="000001.exr: expected an OpenEXR file"),
    Case(input="truncated", command=SOLVE, damage=cut(FRAME, 0.7), says="000001.exr: expected"),
    Case(input="foreign: text", command=SOLVE, damage=written(FRAME, "hello"), says="expected an OpenEXR file"),
    Case(input="a folder", command=SOLVE, damage=folder_frame, says="000001.exr is missing"),
    Case(input="a link to itself", command=SOLVE, damage=linked(FRAME, "000001.exr"), says="000001.exr is missing"),
    Case(input="unreadable", command=SOLVE, damage=linked(FRAME, "/proc/self/mem"), says="expected an OpenEXR file"),
    Case(input="a header of 37 GB (EXR bomb)", command=SOLVE, damage=bomb, says="expected 24x18 pixels"),
    Case(
        input="65 channels",
        command=SOLVE,
        damage=framed(**{f"c{number}": FULL for number in range(65)}),
        says="expected 64 channels at the most, got 65",
    ),
    Case(
        input="a size that changes",
        command=SOLVE,
        damage=framed(Z=np.ones((9, 24), np.float32)),
        says="expected 24x18 pixels, as recording.json says, got 24x9",
    ),
    Case(input="no depth", command=SOLVE, damage=framed(Y=FULL), says="expected a channel 'Z', got ['Y']"),
    Case(input="NaN", command=SOLVE, damage=deep(np.nan), says="got nan in 'Z' at row 2, column 1"),
    Case(input="infinite depth", command=SOLVE, damage=deep(np.inf), says="got inf in 'Z' at row 2, column 1"),
    Case(input="negative depth", command=SOLVE, damage=deep(-1), says="got -1.0 in 'Z' at row 2, column 1"),
    Case(input="huge depth", command=SOLVE, damage=deep(1e30), says="in 'Z' at row 2, column 1"),
    Case(input="tiny depth", command=SOLVE, damage=deep(1e-30), says="in 'Z' at row 2, column 1"),
    Case(input="ids as fractions", command=SOLVE, damage=framed(Z=FULL, objectid=FULL), says="'objectid' as uint32"),
    Case(
        input="no return anywhere",
        command=SOLVE,
        damage=every_frame(lambda _: 0 * FULL),
        status=0,
        says="0 motions",
        becomes="no motions, and the message says that nothing was seen",
    ),
    Case(
        input="constant depth",
        command=SOLVE,
        damage=every_frame(lambda _: FULL),
        status=0,
        says="0 motions",
        becomes="no motions",
    ),
    Case(
        input="duplicate frames",
        command=SOLVE,
        damage=repeated,
        status=0,
        says="0 motions",
        becomes="who is in them stands still",
    ),
    Case(
        input="frames in another order",
        command=VERIFY,
        damage=swapped,
        status=1,
        says="point",
        becomes="solved as they come; `verify` of a simulated recording, and the digests of a data set, tell",
    ),
    Case(
        input="half-precision depth",
        command=SOLVE,
        damage=framed(Z=FULL.astype(np.float16)),
        status=0,
        says="solved",
        becomes="read",
    ),
    Case(
        input="more frames than promised",
        command=SOLVE,
        damage=lambda place: shutil.copy(place / FRAME, place / "small/frames/000006.exr"),
        status=0,
        says="solved",
        becomes="left out",
    ),
)
TRUTHS = (
    Case(
        input="zero bytes", command=VERIFY, damage=written(TRUTH, ""), says="truth.npz: expected a NumPy .npz archive"
    ),
    Case(input="truncated", command=VERIFY, damage=cut(TRUTH, 0.5), says="truth.npz: "),
    Case(
        input="foreign: text", command=VERIFY, damage=written(TRUTH, "hello"), says="truth.npz: expected a NumPy .npz"
    ),
    Case(input="pickles", command=VERIFY, damage=pickled, says="truth.npz: the mesh of object 1 is damaged"),
    Case(input="a zip bomb", command=VERIFY, damage=zip_bomb, says="truth.npz: the mesh of object 1 is damaged"),
    Case(input="an array of 72 TB", command=VERIFY, damage=array_bomb, says="the mesh of object 1 is damaged"),
    Case(
        input="faces of vertices that there are not",
        command=VERIFY,
        damage=truth_with(faces_1=lambda faces: faces + 10**6),
        says="the mesh of object 1 is damaged",
    ),
    Case(
        input="frames that are missing",
        command=VERIFY,
        damage=truth_with(vertices_1=lambda vertices: vertices[:4]),
        says="the mesh of object 1 is damaged",
    ),
    Case(
        input="NaN",
        command=VERIFY,
        damage=truth_with(vertices_1=lambda vertices: vertices * np.nan),
        says="the mesh of object 1 is damaged",
    ),
    Case(input="none", command=VERIFY, damage=removed(TRUTH), says="truth"),
    Case(
        input="no X-ray",
        command=VERIFY,
        damage=without_xray,
        status=0,
        says="projection",
        becomes="`verify` leaves out what needs it",
    ),
    Case(
        input="an X-ray that is missing",
        command=VERIFY,
        damage=removed("small/xray/000001.exr"),
        says="xray/000001.exr is missing",
    ),
    Case(
        input="ids of no object",
        command=VERIFY,
        damage=strange_label,
        status=1,
        says="strange labels",
        becomes="`verify` fails",
    ),
)
LEFT = (
    Case(
        input="what a killed run had begun",
        command=SOLVE,
        damage=killed,
        status=0,
        says="solved",
        becomes="removed",
    ),
)
