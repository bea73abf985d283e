"""BVH files: the skeleton and the motion of one captured person.

The text has two parts. HIERARCHY nests ROOT, JOINT and End Site blocks, each with its OFFSET from the block around it
and, but for end sites, its CHANNELS; MOTION has a line of all channels, in the order they were named, for each frame.
A joint's rotation channels apply in their order, each about the axes that the one before left: intrinsic Euler angles.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from recording.checks import text_of
from recording.errors import InputError

_CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
_MOST_CHANNELS = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class Clip:
    """A captured motion; lengths in the file's unit, axes the file's: y up."""

    joints: tuple[str, ...]
    """Names without a prefix that ends in a colon, parents before children; the first is the root."""
    parents: tuple[int, ...]
    """Number of each joint's parent; -1 for the root."""
    rest: Float[np.ndarray, "joint 3"]
    """Places of the joints while no channel turns anything, from the root's joint."""
    root: Float[np.ndarray, "frame 3"]
    """The root's joint."""
    rotations: tuple[Rotation, ...]
    """Each joint's rotations against its parent, one a frame."""
    frame_time: float
    """Seconds from frame to frame."""


@dataclass(kw_only=True, eq=False)
class _Skeleton:
    """What HIERARCHY says, while it is read."""

    joints: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[tuple[float, ...]] = field(default_factory=list)
    channels: list[tuple[str, ...]] = field(default_factory=list)


@dataclass(kw_only=True, eq=False)
class _Words:
    """The words of a file one after the other, each with its line for the error that may be."""

    path: Path
    words: Sequence[tuple[int, str]]
    taken: int = 0

    def next(self, expected: str) -> str:
        """The next word; `expected` says in an error what it ought to be."""
        if self.taken == len(self.words):
            raise InputError(f"{self.path}: expected {expected}, but the file ends: it is truncated or no BVH file")
        self.taken += 1
        return self.words[self.taken - 1][1]

    def require(self, *expected: str) -> None:
        """Take these words, whatever their case."""
        for word in expected:
            if self.next(repr(word)).lower() != word.lower():
                raise self.error(repr(word))

    def number(self, expected: str) -> float:
        """The next word as a finite number."""
        number = _number(self.next(expected))
        if not np.isfinite(number):
            raise self.error(expected)
        return number

    def error(self, expected: str) -> InputError:
        """That the word taken last is not what was expected."""
        line, word = self.words[self.taken - 1]
        return InputError(f"{self.path}, line {line}: expected {expected}, got {word!r}")


def read_bvh(path: Path) -> Clip:
    """The motion in a BVH file; an `InputError` names the file and the line of what cannot be read."""
    lines = text_of(path, "BVH file").splitlines()
    words = _Words(path=path, words=[(number, word) for number, line in enumerate(lines, 1) for word in line.split()])
    skeleton = _skeleton(words)
    words.require("Frames:")
    frames = words.number("a number of frames")
    if frames < 1 or frames != int(frames):
        raise words.error("a number of frames, 1 or more")
    words.require("Frame", "Time:")
    frame_time = words.number("seconds from frame to frame")
    if frame_time <= 0:
        raise words.error("seconds from frame to frame, above 0")
    first = words.words[words.taken - 1][0]
    values = _values(path, lines, first, (int(frames), sum(map(len, skeleton.channels))))
    return _clip(skeleton, values, frame_time)


def _skeleton(words: _Words) -> _Skeleton:
    """The joints, up to and with the word MOTION."""
    words.require("HIERARCHY", "ROOT")
    skeleton = _Skeleton()
    around: list[int] = []
    _open_joint(words, skeleton, around)
    while around:
        word = words.next("'JOINT', 'End Site' or '}'").lower()
        if word == "joint":
            _open_joint(words, skeleton, around)
        elif word == "end":
            words.require("Site", "{", "OFFSET")
            for axis in "xyz":
                words.number(f"an offset's {axis}")
            words.require("}")
        elif word == "}":
            around.pop()
        else:
            raise words.error("'JOINT', 'End Site' or '}'")
    words.require("MOTION")
    return skeleton


def _open_joint(words: _Words, skeleton: _Skeleton, around: list[int]) -> None:
    """Read a joint's name, offset and channels; `around` are the joints that are open."""
    name = words.next("a joint's name").rsplit(":", maxsplit=1)[-1]
    if name in skeleton.joints:
        raise words.error("every joint's name once")
    words.require("{", "OFFSET")
    skeleton.offsets.append(tuple(words.number(f"an offset's {axis}") for axis in "xyz"))
    words.require("CHANNELS")
    count = words.number("a number of channels")
    if count not in range(_MOST_CHANNELS + 1):
        raise words.error(f"a number of channels, 0 to {_MOST_CHANNELS}")
    channels: list[str] = []
    for _ in range(int(count)):
        channels.append(words.next("a channel").capitalize())
        if channels[-1] not in _CHANNELS or channels[-1] in channels[:-1]:
            raise words.error(f"another one of the channels {', '.join(_CHANNELS)}")
    skeleton.joints.append(name)
    skeleton.parents.append(around[-1] if around else -1)
    skeleton.channels.append(tuple(channels))
    around.append(len(skeleton.joints) - 1)


def _values(path: Path, lines: list[str], first: int, shape: tuple[int, int]) -> Float[np.ndarray, "frame channel"]:
    """The channels in every frame; `first` is how many lines come before, `shape` what was announced."""
    frames, channels = shape
    rows: list[list[float]] = []
    for number, line in enumerate(lines[first:], start=first + 1):
        if not (cells := line.split()):
            continue
        if len(rows) == frames:
            raise InputError(f"{path}, line {number}: expected the end after {frames} frames, got another one")
        if len(cells) != channels:
            raise InputError(
                f"{path}, line {number}: expected {channels} numbers, one for each channel, got {len(cells)}"
            )
        rows.append([_number(cell) for cell in cells])
        if not np.isfinite(rows[-1]).all():
            bad = next(cell for cell in cells if not np.isfinite(_number(cell)))
            raise InputError(f"{path}, line {number}: expected finite numbers, got {bad!r}")
    if len(rows) < frames:
        raise InputError(f"{path}: expected {frames} frames, got {len(rows)}: it is truncated")
    return np.array(rows).reshape(frames, channels)


def _clip(skeleton: _Skeleton, values: Float[np.ndarray, "frame channel"], frame_time: float) -> Clip:
    """The skeleton with its channels taken apart; positions of other joints than the root are left out."""
    rest = np.zeros((len(skeleton.joints), 3))
    root = np.tile(np.array(skeleton.offsets[0]), (len(values), 1))
    rotations, first = [], 0
    for joint, channels in enumerate(skeleton.channels):
        own = values[:, first : first + len(channels)]
        first += len(channels)
        turning = [number for number, channel in enumerate(channels) if channel.endswith("rotation")]
        order = "".join(channels[number][0] for number in turning)
        turned = Rotation.from_euler(order, own[:, turning], degrees=True) if order else None
        rotations.append(Rotation.identity(len(values)) if turned is None else turned)
        if joint:
            rest[joint] = rest[skeleton.parents[joint]] + skeleton.offsets[joint]
            continue
        for number, channel in enumerate(channels):
            if channel.endswith("position"):
                root[:, "XYZ".index(channel[0])] = own[:, number]
    return Clip(
        joints=tuple(skeleton.joints),
        parents=tuple(skeleton.parents),
        rest=rest,
        root=root,
        rotations=tuple(rotations),
        frame_time=frame_time,
    )


def _number(word: str) -> float:
    """The word as a number; NaN where it is none."""
    try:
        return float(word)
    except ValueError:
        return float("nan")
