"""From a source to a recording, frame by frame: straight pictures, empty frames for dropped ones, no background."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from importing.background import background_of
from importing.formats import opened
from importing.ground import ground_of
from importing.removing import Removing
from importing.source import DepthSource, Wanted
from importing.timing import Dropped, Timeline, timeline
from importing.undistort import Undistortion, undistortion
from recording.frame import Frame, Labels
from recording.metadata import Metadata, metadata_of
from recording.progress import tracked
from recording.space import check_room
from recording.store import new_recording, write_metadata, write_picture
from recording.version import VERSION


@dataclass(frozen=True, kw_only=True)
class Treatment:
    """What is done to the frames on the way."""

    dropped: Dropped = "empty"
    """What becomes of dropped frames."""
    remove_ground: bool = False
    """Leave out the returns of the largest plane."""
    remove_background: bool = False
    """Leave out the returns of what stands still behind everything."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Imported:
    """What was made."""

    metadata: Metadata
    kind: str
    """What the source was."""
    empty: int
    """How many frames were dropped in the source, and are empty."""
    straightened: bool
    """Whether the lens's distortion was taken out."""


def import_recording(
    source: Path,
    folder: Path,
    *,
    wanted: Wanted | None = None,
    treatment: Treatment | None = None,
    overwrite: bool = False,
) -> Imported:
    """Make a recording of what others have; the folder appears when all of it is there."""
    asked, how = wanted or Wanted(), treatment or Treatment()
    found = opened(source, asked)
    known = found.calibration.under(asked.known)
    camera = found.camera or known.camera(found.width, found.height, source=str(source))
    times = timeline(found.times, count=found.count, fps=known.fps, dropped=how.dropped, source=str(source))
    straight = undistortion(known, camera) if found.camera is None else None
    shown = replace(found, frames=lambda: _straight(found, straight))
    up_is_known = known.world_from_camera is not None or asked.axes == "ros"
    ground = ground_of(shown, camera, up_is_known=up_is_known) if how.remove_ground else None
    removing = Removing(ground=ground, background=background_of(shown) if how.remove_background else None)
    metadata = metadata_of(
        camera,
        frames=times.frames,
        fps=times.fps,
        name=folder.resolve().name,
        timestamps=times.stamps,
        made_by=f"unocclude {VERSION}",
    )
    with new_recording(folder, overwrite=overwrite) as partial:
        for number, frame in enumerate(_frames(shown, times, removing)):
            write_picture(partial, number, frame, None, metadata=metadata)
            if number == 0:
                (first,) = (partial / "frames").iterdir()
                check_room(first.stat().st_size * shown.count, partial.parent)
        metadata = metadata.model_copy(update={"removed": removing.records()})
        write_metadata(partial, metadata)
    return Imported(metadata=metadata, kind=found.kind, empty=times.empty, straightened=straight is not None)


def _straight(found: DepthSource, straight: Undistortion | None) -> Iterator[Frame]:
    for frame in found.frames():
        yield frame if straight is None else straight.frame(frame)


def _frames(shown: DepthSource, times: Timeline, removing: Removing) -> Iterator[Frame]:
    """The recording's frames; the source is read once, as they are asked for."""
    number = 0
    for place, frame in zip(times.places, tracked(shown.frames(), "importing", total=shown.count), strict=True):
        for _ in range(number, place):
            yield _empty(frame)
        yield removing.left_of(frame)
        number = place + 1


def _empty(like: Frame) -> Frame:
    """A frame without a return."""
    labels = like.labels and Labels(objectid=np.zeros_like(like.labels.objectid))
    return Frame(depth=np.full_like(like.depth, np.nan), labels=labels)
