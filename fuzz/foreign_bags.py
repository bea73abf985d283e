"""The readers of bags: ROS 1's file, the files of a ROS 2 folder."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from bag_files import TOPIC, Bag, images, new_bag  # Of tests/importing, which is on the path.
from imports import TIMES, depth_mm

from fuzz.foreign_files import image, imported
from fuzz.target import Target, saved
from importing.calibration import Calibration
from importing.compressed_depth import MARK

_METADATA = "metadata.yaml"


def _raw(bag: Bag) -> None:
    """Two images, their camera, and where it stands."""
    bag.add("/camera/depth/camera_info", [(TIMES[0], bag.camera(TIMES[0]))])
    bag.add(TOPIC, images(bag)[:2])
    bag.add("/tf_static", [(TIMES[0], bag.transforms(TIMES[0], ("map", "depth", (1, 0, 2, 0, 0, 0, 1))))])


def _packed(bag: Bag) -> None:
    """Two images as PNG, and their camera."""
    bag.add("/camera/depth/camera_info", [(TIMES[0], bag.camera(TIMES[0]))])
    content = bytes(12) + image(".png", depth_mm()[0])
    packed = [(stamp, bag.compressed(stamp, f"16UC1; {MARK} png", content)) for stamp in TIMES[:2]]
    bag.add(f"{TOPIC}/{MARK}", packed)


def _write(path: Path, kind: str, fill: Callable[[Bag], None]) -> None:
    with new_bag(path, kind) as bag:
        fill(bag)


def _ros1() -> list[bytes]:
    return saved("a.bag", *(partial(_write, kind="ros1", fill=fill) for fill in (_raw, _packed)))


def _ros2(kind: str, name: str) -> bytes:
    """A file of a ROS 2 bag, whose folder is called `a`."""
    with TemporaryDirectory() as folder:
        _write(Path(folder) / "a", kind, _raw)
        return (Path(folder) / "a" / name).read_bytes()


def _read(kind: str, beside: str, read: str) -> Callable[[Path], None]:
    """What reads a bag after a valid file of it was put beside the one that is fuzzed, once."""

    def reads(folder: Path) -> None:
        if not (folder / beside).is_file():
            (folder / beside).write_bytes(_ros2(kind, beside))
        imported(folder / read, Calibration())

    return reads


BAGS = {
    "ros1": Target(name="a.bag", read=lambda folder: imported(folder / "a.bag", Calibration()), seeds=_ros1),
    "mcap": Target(
        name="a.mcap",
        read=_read("mcap", _METADATA, "a.mcap"),
        seeds=lambda: [_ros2("mcap", "a.mcap")],
    ),
    "db3": Target(
        name="a.db3",
        read=_read("sqlite3", _METADATA, "a.db3"),
        seeds=lambda: [_ros2("sqlite3", "a.db3")],
    ),
    "bag_metadata": Target(name=_METADATA, read=_read("mcap", "a.mcap", "."), seeds=lambda: [_ros2("mcap", _METADATA)]),
}
"""By what they read."""
