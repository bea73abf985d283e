"""Where a bag's camera stands, by the transforms between named frames that ROS keeps in `/tf_static` and `/tf`."""

from array import array
from collections.abc import Iterator, MutableSequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from importing.calibration import Calibration
from importing.pose import placed, still_pose
from recording.errors import InputError
from recording.progress import note, tracked

TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
FIXED = ("map", "odom", "world")
"""Frames that do not move and whose z points up, as ROS names them (REP 105; `world` by custom)."""
_LONGEST_CHAIN = 100
Poses = tuple[Float[np.ndarray, "moment 3"], Rotation]
"""Places and turns of one frame in another, at some times."""


@dataclass(kw_only=True)
class _Edge:
    """Where a frame is in its parent."""

    parent: str
    other_parent: str | None = None
    """A second one, which no frame may have."""
    times: MutableSequence[float] = field(default_factory=lambda: array("d"))
    poses: MutableSequence[float] = field(default_factory=lambda: array("d"))
    """x, y, z and a quaternion x, y, z, w of each time."""

    def at(self, times: Float[np.ndarray, "moment"], *, source: str) -> Poses:
        """The latest pose at each time; the first one before there is any."""
        order = np.argsort(self.times, kind="stable")
        latest = np.searchsorted(np.array(self.times)[order], times, side="right") - 1
        poses = np.array(self.poses).reshape(-1, 7)[order][np.maximum(latest, 0)]
        lengths = np.linalg.norm(poses[:, 3:], axis=1)
        if not (np.isfinite(poses).all() and np.all(np.abs(lengths - 1) < 0.01)):
            raise InputError(f"{source}: expected finite places and unit quaternions in the transforms")
        return poses[:, :3], Rotation.from_quat(poses[:, 3:])


def camera_place(reader: Any, frame: str, times: tuple[float, ...], *, wanted: str | None, source: str) -> Calibration:
    """Where the camera's frame stands in the fixed frame that is wanted, or in `map`, `odom` or `world`.

    Nothing where the bag has no such frame above the camera: which way is up is not known then. A camera that moves
    while it records is refused.
    """
    edges = _edges(reader)
    own, fixed = _bare(frame), None if wanted is None else _bare(wanted)
    above = _above(edges, own, source)
    if fixed is None:
        fixed = next((name for name in reversed(above[1:]) if name in FIXED), None)
        if fixed is None:
            if len(above) > 1:
                note(
                    f"{source}: the transforms place the camera in {above[-1]!r}, which need not stand still: "
                    f"if it does, pass --world-frame {above[-1]}"
                )
            return Calibration()
    if not set(above) & set(_above(edges, fixed, source)):
        known = ", ".join(sorted({*edges, *(edge.parent for edge in edges.values())})) or "none"
        raise InputError(
            f"{source}: expected transforms between {own!r}, the camera's frame, and {fixed!r}, got the frames {known}"
        )
    moments = np.array(times)
    place, turn = _in_topmost(edges, above, moments, source)
    world_place, world_turn = _in_topmost(edges, _above(edges, fixed, source), moments, source)
    poses = np.hstack([world_turn.inv().apply(place - world_place), (world_turn.inv() * turn).as_quat()])
    return placed(still_pose(poses, source=f"{source}, frame {own!r} in {fixed!r}"), source=source)


def _edges(reader: Any) -> dict[str, _Edge]:
    """All transforms of the bag, by the frame that each places."""
    edges: dict[str, _Edge] = {}
    for parent, child, time, pose in _transforms(reader):
        edge = edges.setdefault(child, _Edge(parent=parent))
        if edge.parent != parent:
            edge.other_parent = parent
        edge.times.append(time)
        edge.poses.extend(pose)
    return edges


def _transforms(reader: Any) -> Iterator[tuple[str, str, float, list[float]]]:
    """Parent, child, seconds, and the child's pose in its parent; static transforms count from the beginning."""
    found = [each for each in reader.connections if each.msgtype in TYPES]
    if not found:
        return
    total = sum(each.msgcount for each in found)
    messages = tracked(reader.messages(connections=found), "looking for the camera's place", total=total)
    for connection, _, content in messages:
        still = connection.topic.endswith("tf_static")
        for each in reader.deserialize(content, connection.msgtype).transforms:
            stamp, move = each.header.stamp, each.transform
            pose = [getattr(move.translation, axis) for axis in "xyz"] + [
                getattr(move.rotation, axis) for axis in "xyzw"
            ]
            time = -np.inf if still else stamp.sec + stamp.nanosec * 1e-9
            yield _bare(each.header.frame_id), _bare(each.child_frame_id), time, pose


def _above(edges: dict[str, _Edge], frame: str, source: str) -> list[str]:
    """A frame, its parent, and so on up to the topmost."""
    names = [frame]
    while edge := edges.get(names[-1]):
        if edge.other_parent is not None:
            came = f"it in {edge.parent!r} and in {edge.other_parent!r}"
            raise InputError(f"{source}: expected {names[-1]!r} in one frame, got {came}")
        names.append(edge.parent)
        if len(names) > _LONGEST_CHAIN:
            raise InputError(f"{source}: expected transforms that end at one frame, got a circle at {frame!r}")
    return names


def _in_topmost(edges: dict[str, _Edge], above: list[str], times: Float[np.ndarray, "moment"], source: str) -> Poses:
    """The first of the frames in the last, at each time."""
    place, turn = np.zeros((len(times), 3)), Rotation.identity(len(times))
    for name in above[:-1]:
        outer_place, outer_turn = edges[name].at(times, source=source)
        place, turn = outer_place + outer_turn.apply(place), outer_turn * turn
    return place, turn


def _bare(name: str) -> str:
    """A frame's name; ROS 1 may have a slash before it."""
    return str(name).lstrip("/")
