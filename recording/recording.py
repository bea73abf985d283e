"""A recording: frames through one fixed camera, with its truth where it is known."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from recording.camera import Camera
from recording.errors import InputError
from recording.exr import stored_depth
from recording.frame import Frame
from recording.markup import beside, depth_thumbnail, facts
from recording.metadata import Metadata
from recording.motions import NOISE, Motions
from recording.over_time import spread_numbers
from recording.palette import colours_of
from recording.truth import Truth
from recording.xray import XRay

if TYPE_CHECKING:
    import matplotlib.axes

_FRAMES_LOOKED_AT = 9
"""For the range of colours in a picture."""
_SEEN, _COMPLETED = 2.5, 6.0
"""Sizes of points in a picture: those that nobody saw are large, and pale."""


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

    def plot(
        self,
        frame: int | None = None,
        *,
        motions: Motions | None = None,
        axes: "matplotlib.axes.Axes | None" = None,
    ) -> "matplotlib.axes.Axes":
        """Draw the depth of one frame, the middle one if none is named, on new axes if none are given.

        Upon it the points that motions have in this frame, in the colours of the motions; the completed ones are pale:
        so one sees through what hides them.
        """
        from recording.drawing import draw_depth, draw_dots, new_axes  # noqa: PLC0415 - matplotlib is slow to import.

        number = range(self.metadata.frames)[self.metadata.frames // 2 if frame is None else frame]
        drawn = axes or new_axes(shape=0.82 * self.camera.height / self.camera.width)
        within = self._usual_depths()
        draw_depth(drawn, self.frames[number].depth, self.camera, within=within, faint=motions is not None)
        drawn.set_title(f"{self.metadata.name or 'recording'}, frame {number}, {number / self.fps:.2f} s")
        if motions is not None:
            for observed, size, alpha in ((False, _COMPLETED, 0.3), (True, _SEEN, 0.9)):
                shown = (motions.frame == number) & (motions.motion != NOISE) & (motions.observed == observed)
                place = self.camera.pixel_from_world(motions.position[shown].astype(np.float64))[0]
                draw_dots(drawn, place, colours_of(motions.motion[shown]), size=size, alpha=alpha)
        return drawn

    def _usual_depths(self) -> tuple[float, float]:
        """The least and the greatest depth of some frames spread over the recording, so that colours mean the same."""
        moments = spread_numbers(self.metadata.frames, _FRAMES_LOOKED_AT)
        depths = [self.frames[moment].depth for moment in moments]
        present = np.concatenate([depth[np.isfinite(depth)] for depth in depths])
        return (float(present.min()), float(present.max())) if present.size else (0.0, 1.0)

    def __repr__(self) -> str:
        about = self.metadata
        known = f", {len(self.moving_ids)} moving objects" if about.objects is not None else ""
        size = f"{about.frames} frames of {about.width}x{about.height} pixels"
        return f"<Recording {about.name or 'without a name'}: {size}, {self.fps:g} a second{known}>"

    def _repr_html_(self) -> str:
        """What is known of it, and the depth of its middle frame, as a notebook shows it."""
        middle = self.metadata.frames // 2
        picture = depth_thumbnail(self.frames[middle].depth, f"frame {middle}")
        return str(beside(facts(self._facts()), picture))

    def _facts(self) -> list[tuple[str, str]]:
        about = self.metadata
        angle_deg = 2 * np.degrees(np.arctan(about.width / (2 * self.camera.fx)))
        moving = [entry.name for entry in about.objects or () if entry.moving]
        truth = [name for name, known in (("meshes", self.truth), ("X-ray twins", self.xray)) if known is not None]
        removed = [
            ("left out", ", ".join(f"{part.what}, {part.share:.0%} of the returns" for part in about.removed or ()))
        ]
        return [
            ("recording", about.name or "without a name"),
            ("frames", f"{about.frames}, {about.fps:g} a second, {about.frames / about.fps:.1f} s"),
            ("picture", f"{about.width} x {about.height} pixels, {angle_deg:.0f}° wide"),
            ("sensor", str((about.sensor or {}).get("preset", "unknown"))),
            ("moving objects", "unknown" if about.objects is None else f"{len(moving)}: {', '.join(moving)}"),
            ("truth", ", ".join(truth) or "none"),
            *(removed if about.removed else []),
        ]


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
