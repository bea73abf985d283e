"""A recording: frames through one fixed camera, with its truth where it is known."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field

from recording.camera import Camera
from recording.errors import InputError
from recording.exr import stored_depth
from recording.frame import Frame
from recording.metadata import Metadata
from recording.truth import Truth
from recording.xray import XRay


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """Frames and what is known about them; frames and truth may be read from disk as they are asked for."""

    metadata: Metadata
    frames: Sequence[Frame]
    truth: Truth | None = None
    xray: Sequence[XRay] | None = None
    """One a frame."""
    camera: Camera = field(init=False)

    def __post_init__(self) -> None:
        for name, values in (("frames", self.frames), ("X-rays", self.xray)):
            if values is not None and len(values) != self.metadata.frames:
                raise InputError(f"expected {self.metadata.frames} {name}, as the metadata says, got {len(values)}")
        object.__setattr__(self, "camera", self.metadata.as_camera())

    @property
    def fps(self) -> float:
        """Frames a second."""
        return self.metadata.fps

    @property
    def moving_ids(self) -> tuple[int, ...]:
        """The ids of the objects that move; empty where no object is known."""
        return tuple(entry.id for entry in self.metadata.objects or () if entry.moving)

    def digest(self) -> str:
        """SHA-256 of what the sensor saw: camera, frame rate and every depth.

        A copy that was stripped of its truth has the same digest.
        """
        digest = DepthDigest(self.metadata)
        for frame in self.frames:
            digest.add(frame)
        return digest.hexdigest()


class DepthDigest:
    """The digest of a recording while its frames are being made, in their order."""

    def __init__(self, metadata: Metadata) -> None:
        known = metadata.model_dump(mode="json", include={"fps", "width", "height", "camera"})
        self._content = hashlib.sha256(json.dumps(known, sort_keys=True).encode())

    def add(self, frame: Frame) -> None:
        """Take the next frame's depth in."""
        self._content.update(stored_depth(frame.depth).tobytes())

    def hexdigest(self) -> str:
        """The digest of all that was added."""
        return self._content.hexdigest()


def stripped(recording: Recording) -> Recording:
    """The recording as a real sensor would have made it: the required keys and `Z` alone."""
    required = {name for name, info in Metadata.model_fields.items() if info.is_required()}
    bare = recording.metadata.model_dump(include=required)
    return Recording(
        metadata=Metadata.model_validate(bare),
        frames=tuple(Frame(depth=frame.depth) for frame in recording.frames),
    )
