"""Bags as others write them, written by rosbags itself."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from imports import HEIGHT, TIMES, WIDTH, depth_m, depth_mm
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

IMAGE, CAMERA, NUMBER = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo", "std_msgs/msg/Float32"
COMPRESSED, TRANSFORM = "sensor_msgs/msg/CompressedImage", "geometry_msgs/msg/TransformStamped"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
TOPIC = "/camera/depth/image_rect_raw"
K = np.array([300.0, 0, 3.5, 0, 310.0, 2.0, 0, 0, 1])
KINDS = {"ros1": "ride.bag", "sqlite3": "ride", "mcap": "ride"}


@dataclass
class Bag:
    """A bag that is being written."""

    writer: Any
    store: Any
    of_ros_1: bool

    def add(self, topic: str, messages: Sequence[tuple[float, Any]]) -> None:
        """Messages of one topic, and when they arrive."""
        connection = self.writer.add_connection(topic, messages[0][1].__msgtype__, typestore=self.store)
        for seconds, message in messages:
            serialize = self.store.serialize_ros1 if self.of_ros_1 else self.store.serialize_cdr
            self.writer.write(connection, round(seconds * 1e9), serialize(message, message.__msgtype__))

    def header(self, seconds: float, *, frame: str = "depth") -> Any:
        """A header with a time stamp."""
        whole = int(seconds)
        stamp = self.store.types["builtin_interfaces/msg/Time"](sec=whole, nanosec=round((seconds - whole) * 1e9))
        extra = {"seq": 0} if self.of_ros_1 else {}
        return self.store.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **extra)

    def image(self, seconds: float, pixels: np.ndarray, encoding: str, *, padding: int = 0, big: bool = False) -> Any:
        """An image message, with bytes at the end of each row, or with the bytes of numbers swapped."""
        stored = pixels.astype(pixels.dtype.newbyteorder(">" if big else "<"))
        rows = np.ascontiguousarray(stored).view(np.uint8).reshape(pixels.shape[0], -1)
        padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=255)
        return self.store.types[IMAGE](
            header=self.header(seconds),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=int(big),
            step=padded.shape[1],
            data=padded.ravel(),
        )

    def camera(self, seconds: float, *, model: str = "plumb_bob", lens: tuple[float, ...] = (0.0,) * 5) -> Any:
        """A CameraInfo message."""
        area = self.store.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        matrices = {"d": np.array(lens), "k": K, "r": np.eye(3).ravel(), "p": np.zeros(12)}
        named = {name.upper() if self.of_ros_1 else name: value for name, value in matrices.items()}
        about = {"height": HEIGHT, "width": WIDTH, "distortion_model": model, "binning_x": 0, "binning_y": 0}
        return self.store.types[CAMERA](header=self.header(seconds), roi=area, **about, **named)

    def compressed(self, seconds: float, format_: str, data: bytes) -> Any:
        """A CompressedImage message."""
        content = np.frombuffer(data, np.uint8)
        return self.store.types[COMPRESSED](header=self.header(seconds), format=format_, data=content)

    def transforms(self, seconds: float, *moves: tuple[str, str, tuple[float, ...]]) -> Any:
        """A message of transforms: parent, child, and the child's x y z qx qy qz qw in its parent."""
        geometry = {
            name: self.store.types[f"geometry_msgs/msg/{name}"] for name in ("Vector3", "Quaternion", "Transform")
        }
        stamped = []
        for parent, child, pose in moves:
            move = geometry["Transform"](geometry["Vector3"](*pose[:3]), geometry["Quaternion"](*pose[3:]))
            header = self.header(seconds, frame=parent)
            stamped.append(self.store.types[TRANSFORM](header=header, child_frame_id=child, transform=move))
        return self.store.types[TRANSFORMS](transforms=stamped)


@contextmanager
def new_bag(path: Path, kind: str) -> Iterator[Bag]:
    store = get_typestore(Stores.ROS1_NOETIC if kind == "ros1" else Stores.ROS2_HUMBLE)
    if kind == "ros1":
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TRANSFORMS))
    if kind == "ros1":
        with Writer1(path) as writer:
            yield Bag(writer, store, of_ros_1=True)
    else:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        with Writer2(path, version=9, storage_plugin=plugin) as writer:
            yield Bag(writer, store, of_ros_1=False)


def images(bag: Bag, *, floating: bool = False, times: tuple[float, ...] = TIMES, **options: Any) -> list[Any]:
    stored = np.nan_to_num(depth_m(depth_mm())) if floating else depth_mm()
    encoding = "32FC1" if floating else "16UC1"
    return [(stamp, bag.image(stamp, each, encoding, **options)) for stamp, each in zip(times, stored, strict=True)]
