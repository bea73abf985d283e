"""Wrong things to import; what single formats refuse besides is in `tests/importing/`."""

import struct
import zipfile
import zlib
from pathlib import Path

import cv2
import h5py
import numpy as np
from case import Case, Damage, written
from scipy.io import savemat

_CAMERA = "--fx 40 --fy 40 --cx 5 --cy 4 --fps 10"
_DEPTH = np.full((12, 8, 10), 3000, np.uint16)
_GIGANTIC = struct.pack(">II", 10**6, 10**6)


def _import(source: str, options: str = "") -> str:
    return f"import {{place}}/{source} -o {{place}}/out {_CAMERA} {options}"


def _images(*images: np.ndarray, name: str = "{}.png") -> Damage:
    def damage(place: Path) -> None:
        (place / "depth").mkdir(exist_ok=True)
        for number, image in enumerate(images):
            cv2.imwrite(str(place / "depth" / name.format(number)), image)

    return damage


def _text(name: str, text: str) -> Damage:
    """The usual images, and a text file beside them."""

    def damage(place: Path) -> None:
        _images(*_DEPTH)(place)
        (place / "depth" / name).write_text(text, encoding="utf-8")

    return damage


def _gigantic_png(place: Path) -> None:
    _images(*_DEPTH)(place)
    content = (place / "depth" / "0.png").read_bytes()
    head = content[12:16] + _GIGANTIC + content[24:29]
    whole = content[:12] + head + struct.pack(">I", zlib.crc32(head)) + content[33:]
    (place / "depth" / "0.png").write_bytes(whole)


def _truncated_png(place: Path) -> None:
    _images(*np.random.default_rng(0).integers(500, 5000, _DEPTH.shape, np.uint16))(place)
    content = (place / "depth" / "3.png").read_bytes()
    (place / "depth" / "3.png").write_bytes(content[:60])


def _archive(**arrays: np.ndarray) -> Damage:
    return lambda place: np.savez(place / "depth.npz", **arrays)  # type: ignore[arg-type]  # Arrays alone.


def _bomb(place: Path) -> None:
    """An archive that says more of its array than it holds."""
    head = b"\x93NUMPY\x01\x00v\x00" + b"{'descr': '<u2', 'fortran_order': True, 'shape': (1000000000, 900, 900), }"
    with zipfile.ZipFile(place / "depth.npz", "w") as archive:
        archive.writestr("depth.npy", head.ljust(127) + b"\n" + bytes(1000))


def _cut(name: str, share: float) -> Damage:
    def damage(place: Path) -> None:
        path = place / name
        if path.suffix == ".npy":
            np.save(path, np.array(_DEPTH, order="F"))
        elif path.suffix == ".mat":
            savemat(path, {"depth": np.moveaxis(_DEPTH, 0, -1)})
        content = path.read_bytes()
        path.write_bytes(content[: int(len(content) * share)])

    return damage


def _hdf5_without_depth(place: Path) -> None:
    with h5py.File(place / "depth.mat", "w", userblock_size=512) as file:
        file.create_group("depth")
    with (place / "depth.mat").open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


def _clouds(text: str) -> Damage:
    def damage(place: Path) -> None:
        (place / "scans").mkdir()
        (place / "scans" / "0.xyz").write_text(text, encoding="utf-8")

    return damage


def _sequence(place: Path) -> None:
    """A TUM RGB-D sequence whose list leads out of the folder."""
    (place / "depth").mkdir()
    (place / "depth" / "depth.txt").write_text("0.1 ../small/recording.json\n", encoding="utf-8")


_ONE = _DEPTH[:1]
IMPORTS = (
    Case(input="nothing there", command=_import("none"), says="expected a folder or a file to import"),
    Case(
        input="an empty folder",
        command=_import("depth"),
        says="expected files named like *.png",
        damage=lambda p: (p / "depth").mkdir(),
    ),
    Case(input="a recording", command=_import("small"), says="got a recording, which is one already"),
    Case(input="another kind of file", command=_import("clip.bvh"), says="got '.bvh'"),
    Case(
        input="no camera",
        command="import {place}/depth -o {place}/out --fps 9",
        says="came from nowhere: pass --fx --fy --cx --cy",
        damage=_images(*_DEPTH),
    ),
    Case(
        input="a camera of another size",
        command=_import("depth", "--camera {place}/camera.json"),
        says="images 640 pixels in width",
        damage=lambda place: (_images(*_DEPTH)(place), written("camera.json", '{"width": 640}')(place)),
    ),
    Case(
        input="a principal point far beside the picture",
        command=_import("depth").replace("--cx 5", "--cx 900"),
        says="cx: expected about 5",
        damage=_images(*_DEPTH),
    ),
    Case(
        input="8-bit images",
        command=_import("depth"),
        says="is it a picture of depth, not depth itself?",
        damage=_images(_ONE[0].astype(np.uint8)),
    ),
    Case(
        input="pictures in colour",
        command=_import("depth"),
        says="expected one channel of numbers, got 3 of uint8",
        damage=_images(np.zeros((8, 10, 3), np.uint8)),
    ),
    Case(
        input="sizes that change",
        command=_import("depth"),
        says="expected 10x8 pixels, as the first image has",
        damage=_images(_DEPTH[0], _DEPTH[0, :5]),
    ),
    Case(
        input="a truncated image",
        command=_import("depth"),
        says="3.png: expected a PNG, but it cannot be read",
        damage=_truncated_png,
    ),
    Case(
        input="a PNG of 10^12 pixels",
        command=_import("depth"),
        says="0.png: expected a depth image, got one of more than",
        damage=_gigantic_png,
    ),
    Case(
        input="two series of images",
        command=_import("depth"),
        says="say which by --pattern",
        damage=lambda place: (_images(*_DEPTH, name="a{}.png")(place), _images(*_DEPTH, name="b{}.png")(place)),
    ),
    Case(
        input="a pattern that leads out",
        command=_import("depth", "--pattern ../*.png"),
        says="file names within the folder",
        damage=_images(*_DEPTH),
    ),
    Case(
        input="masks for some images only",
        command=_import("depth", "--masks 0.png"),
        says="a mask for each",
        damage=_images(*_DEPTH),
    ),
    Case(
        input="a unit that puts depths beyond 100 km",
        command=_import("depth", "--scale 100"),
        says="pass another --scale",
        damage=_images(*_DEPTH),
    ),
    Case(
        input="a TUM list that leads out",
        command=_import("depth"),
        says="expected files within the folder",
        damage=_sequence,
    ),
    Case(
        input="time stamps that go back",
        command=_import("depth"),
        says="time stamps that grow",
        damage=_text("depth.txt", "0.2 0.png\n0.1 1.png\n"),
    ),
    Case(
        input="a gap of an hour",
        command=_import("depth").replace(" --fps 10", ""),
        says="gaps below 10 s",
        damage=_text("depth.txt", "0.0 0.png\n0.1 1.png\n0.2 2.png\n3600 3.png\n"),
    ),
    Case(
        input="negative depths",
        command=_import("depth.npz"),
        says="depth before the camera, got -1",
        damage=_archive(depth=-np.ones((2, 8, 10))),
    ),
    Case(
        input="an array of two sides too many",
        command=_import("depth.npz"),
        says="got (2, 2, 2, 2, 2)",
        damage=_archive(depth=np.ones((2,) * 5)),
    ),
    Case(
        input="pickled objects",
        command=_import("depth.npz"),
        says="which are never read",
        damage=_archive(depth=np.array([{}], dtype=object)),
    ),
    Case(input="a zip bomb", command=_import("depth.npz"), says="bytes of depth, got", damage=_bomb),
    Case(input="half an array", command=_import("a.npy"), says="is not complete", damage=_cut("a.npy", 0.5)),
    Case(input="half a MATLAB file", command=_import("a.mat"), says="a.mat: expected a", damage=_cut("a.mat", 0.6)),
    Case(
        input="MATLAB without arrays",
        command=_import("depth.mat"),
        says="expected an array 'depth', got none",
        damage=_hdf5_without_depth,
    ),
    Case(input="no bag", command=_import("a.bag"), says="expected a bag of ROS 1", damage=written("a.bag", b"x" * 99)),
    Case(
        input="points behind the scanner",
        command="import {place}/scans -o {place}/out --fps 5",
        says="say how the axes point by --axes",
        damage=_clouds("0 0 1\n0.1 0 1\n0 0 -1\n"),
    ),
    Case(
        input="two points on one ray",
        command="import {place}/scans -o {place}/out --fps 5",
        says="two of a frame lie on one ray",
        damage=_clouds("0 0 1\n0 0 2\n"),
    ),
    Case(
        input="words for points",
        command="import {place}/scans -o {place}/out --fps 5",
        says="0.xyz: expected points",
        damage=_clouds("one two three\n"),
    ),
    Case(
        input="no ground to remove",
        command=_import("depth", "--remove-ground"),
        says="ground: expected at least 50 returns to find it in, got 0",
        damage=_images(*np.zeros_like(_DEPTH)),
    ),
    Case(
        input="too few frames for a background",
        command=_import("depth", "--remove-background"),
        says="background: expected at least 10 frames",
        damage=_images(*_DEPTH[:4]),
    ),
    Case(
        input="into its own source",
        command=_import("depth").replace("place}/out", "place}/depth"),
        says="expected a recording to replace, got a folder of something else",
        damage=_images(*_DEPTH),
    ),
)
