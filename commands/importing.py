"""Recordings from what others have: import."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from algorithm.depth_image import depth_range
from commands.common import WRITING, Output, Writing
from importing.calibration import Calibration
from importing.camera_file import calibration_file
from importing.pose import Pose, extrinsics_file, placed, pose_matrix
from importing.source import Wanted
from importing.timing import Dropped
from importing.write import Imported, Treatment, import_recording
from recording.checks import validated
from recording.errors import InputError
from recording.store import load_recording

EXAMPLES_HELP = """More examples:

- `unocclude import rgbd_dataset/ --camera freiburg2.yaml -o recordings/desk` (TUM RGB-D)
- `unocclude import ride.bag --key /camera/depth/image_rect_raw -o recordings/ride` (ROS 1, ROS 2, RealSense)
- `unocclude import scans/ --pattern '*.ply' --axes ros --fps 10 -o recordings/scans` (point clouds)
- `unocclude import depth.mat --camera camera.json --fps 30 -o recordings/lab` (MATLAB, NumPy)
"""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Seeing:
    """What `import` takes about the camera; each option overrides a file, and a file what the source says itself."""

    camera: Path | None = None
    """Calibration file: JSON, TOML or YAML with these options' names, ROS camera_info, OpenCV FileStorage, Open3D."""
    fx: float | None = None
    """Focal length along the columns, pixels."""
    fy: float | None = None
    """Focal length along the rows, pixels."""
    cx: float | None = None
    """Column of the principal point, pixels."""
    cy: float | None = None
    """Row of the principal point, pixels."""
    pixel_centre: float | None = None
    """Where the calibration has the centre of pixel (0, 0): 0, as most do (the default), or 0.5."""
    distortion: Annotated[tuple[float, ...] | None, Parameter(consume_multiple=True, negative="")] = None
    """Coefficients of the lens in OpenCV's order, such as `-0.28 0.07 0 0`; the frames are made straight."""
    distortion_model: Literal["plumb_bob", "rational_polynomial", "equidistant"] | None = None
    """OpenCV's polynomial, under either name (the default), or its fisheye lens."""
    size: str | None = None
    """Picture size in pixels, `640x480`, for point clouds through a scanner of known `--fx --fy --cx --cy`."""
    extrinsics: Path | None = None
    """File with `world_from_camera` or `camera_from_world`, 4x4, metres."""
    pose: Annotated[Pose | None, Parameter(negative="")] = None
    """The camera in the world: x y z in metres and a quaternion qx qy qz qw."""
    fps: float | None = None
    """Frames a second; by default what time stamps say."""
    scale: float | None = None
    """Metres of one unit; by default 0.001 for whole numbers, 1 for others, 0.0002 for TUM RGB-D."""

    def calibration(self) -> Calibration:
        """All of it as one."""
        known = calibration_file(self.camera) if self.camera else Calibration()
        if self.extrinsics and self.pose:
            raise InputError("expected --extrinsics or --pose, got both: leave one of them out")
        if self.extrinsics:
            known = known.under(extrinsics_file(self.extrinsics))
        if self.pose:
            known = known.under(placed(pose_matrix(self.pose, source="--pose"), source="--pose"))
        own = {name: getattr(self, name) for name in Calibration.model_fields if hasattr(self, name)}
        return known.under(validated(Calibration, {**own, **_size(self.size)}, source="import"))


SEEING = Seeing()


def import_command(
    source: Path,
    *,
    output: Output,
    pattern: str | None = None,
    masks: str | None = None,
    key: str | None = None,
    world_frame: str | None = None,
    axes: Literal["opencv", "opengl", "ros"] = "opencv",
    dropped: Dropped = "empty",
    remove_ground: Annotated[bool, Parameter(negative="")] = False,
    remove_background: Annotated[bool, Parameter(negative="")] = False,
    seeing: Seeing = SEEING,
    common: Writing = WRITING,
) -> None:
    """Make a recording of depth images, TUM RGB-D, arrays, point clouds or a bag (docs/importing.md).

    Example: `unocclude import depth/ --scale 0.001 --fx 365 --fy 365 --cx 256 --cy 212 --fps 30 -o recording`

    Args:
        source: Folder of images or of point clouds, TUM RGB-D folder, `.npz`, `.npy`, `.mat`, `.bag`, ROS 2 folder.
        output: The recording to make.
        pattern: Names of the files in a folder, which are taken in the order of the numbers in their names.
        masks: Names of images of object ids, one for each depth image, for the evaluation.
        key: Name of the array in a `.npz` or `.mat`, or of the topic in a bag, where there are several.
        world_frame: Frame of a bag's transforms (`/tf_static`, `/tf`) to take for the world; by default `map`, `odom`
            or `world`, where it is above the camera's.
        axes: How the points of clouds are meant: x right, y down, z forward; x right, y up, z backward; x forward,
            y left, z up.
        dropped: What becomes of frames that the time stamps miss: empty ones, or none at all.
        remove_ground: Leave out the largest plane and what is below it, where `solve` does not recognise it.
        remove_background: Leave out what stands still behind everything, where `solve` does not recognise it.
    """
    wanted = Wanted(
        known=seeing.calibration(), pattern=pattern, masks=masks, key=key, world_frame=world_frame, axes=axes
    )
    treatment = Treatment(dropped=dropped, remove_ground=remove_ground, remove_background=remove_background)
    with common.progress():
        made = import_recording(source, output, wanted=wanted, treatment=treatment, overwrite=common.overwrite)
    common.say(_sentence(made, output))


def _sentence(made: Imported, output: Path) -> str:
    about, first = made.metadata, load_recording(output).frames[0]
    low, high = depth_range([first.depth])
    parts = [
        f"imported {about.frames} frames of {about.width}x{about.height} to {output} ({made.kind} at {about.fps:g} a "
        f"second); the first has depths from {low:.2f} to {high:.2f} m and no return at {1 - first.seen.mean():.0%} of "
        "its pixels"
    ]
    if made.empty:
        parts.append(f"{made.empty} frames were dropped in the source and are empty")
    if made.straightened:
        parts.append("the lens's distortion is taken out")
    for removed in about.removed or ():
        what = "the background" if removed.distance_m is None else f"a plane {removed.distance_m:.2f} m away"
        parts.append(f"left out {what}, {removed.share:.0%} of the returns")
    return "; ".join(parts)


def _size(text: str | None) -> dict[str, int]:
    if text is None:
        return {}
    found = re.fullmatch(r"([1-9][0-9]{0,4})x([1-9][0-9]{0,4})", text)
    if not found:
        raise InputError(f"size: expected WIDTHxHEIGHT in pixels, such as 640x480, got {text!r}")
    return {"width": int(found[1]), "height": int(found[2])}
