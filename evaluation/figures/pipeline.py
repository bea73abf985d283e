"""Figure 4: from point clouds to trajectories, with what each stage has in its hands."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from algorithm.depth_image import depth_range, grey_image
from algorithm.lifting import SceneFlow
from algorithm.scene_flow import Footage, flows_between
from evaluation.figures.scenes import add_bar, draw_trajectories
from evaluation.figures.stages import Solved
from evaluation.figures.style import PAGE_INCHES
from evaluation.figures.views import front_view
from recording.camera import PIXEL_CENTRE
from recording.drawing import draw_dots
from recording.palette import COLOURS

_ARROWS = 14
"""Rows of arrows in the picture's busy part."""
_LONGEST = 3.0
"""Gaps between arrows that the largest motion is drawn as long as."""


def pipeline_figure(solved: Sequence[Solved]) -> Figure:
    """Figure 4: point clouds, depth images, optical flow and its lift to 3D, trajectories."""
    case = solved[0]
    figure = Figure(figsize=(PAGE_INCHES, 0.4 * PAGE_INCHES), layout="constrained")
    columns = np.asarray(figure.subfigures(1, 4, width_ratios=(1, 1, 1.4, 1.9)))
    frames = _busy_frames(case)
    clouds, images = columns[0].subplots(3, 1), columns[1].subplots(3, 1)
    for frame, cloud, image in zip(frames, clouds, images, strict=True):
        _draw_cloud(cloud, case, frame)
        _draw_image(image, case, frame)
    clouds[0].set_title("(a) point clouds")
    images[0].set_title("(b) depth images")
    flow, change = columns[2].subplots(2, 1)
    found = _flow_from(case, frames[1])
    _draw_flow(flow, case, frames[1], found)
    _draw_change(change, case, found)
    trajectories = columns[3].subplots()
    draw_trajectories(trajectories, case, case.above)
    trajectories.set_anchor("N")
    trajectories.set_title(f"(d) {trajectories.get_title(loc='left')}")
    return figure


def _busy_frames(case: Solved) -> tuple[int, int, int]:
    """The frame in which most points are followed, and one a fifth of a second before and after it."""
    count = case.recording.metadata.frames
    followed = np.bincount(case.trajectories.frame, minlength=count) if case.trajectories.count else np.zeros(count)
    middle = min(int(np.argmax(followed)), max(count - 2, 0))
    apart = max(1, round(case.recording.fps / 5))
    return max(middle - apart, 0), middle, min(middle + apart, count - 1)


def _draw_cloud(axes: Axes, case: Solved, frame: int) -> None:
    draw_dots(axes, case.above.picture(case.returns(frame)), COLOURS[0], size=0.25, alpha=0.8)
    case.above.frame(axes)
    axes.set_ylabel(f"frame {frame}")


def _draw_image(axes: Axes, case: Solved, frame: int) -> None:
    _draw_grey(axes, case, frame, black=0)
    front_view(case.recording, case.shown).frame(axes)


def _draw_grey(axes: Axes, case: Solved, frame: int, *, black: int) -> None:
    """Depth as grey, of which `black` is drawn as black."""
    within = depth_range([case.recording.frames[moment].depth for moment in (*case.moments, frame)])
    grey = np.ma.masked_equal(grey_image(case.recording.frames[frame].depth, within=within), 0)
    axes.imshow(grey, cmap="gray", vmin=black, vmax=255, extent=_extent(case), interpolation="nearest")


def _flow_from(case: Solved, frame: int) -> SceneFlow:
    """The flow from a frame to the next, as the solver has it."""
    following = min(frame + 1, case.recording.metadata.frames - 1)
    sensed = [case.recording.frames[moment].depth for moment in (frame, following)]
    moving = [np.where(case.ground.moving(depth), depth, np.float32(np.nan)) for depth in sensed]
    footage = Footage(
        moving=moving if case.settings.remove_static else sensed,
        sensed=sensed,
        camera=case.recording.camera,
        fps=case.recording.fps,
    )
    return flows_between(footage, case.settings)(0, 1)[0]


def _draw_flow(axes: Axes, case: Solved, frame: int, flow: SceneFlow) -> None:
    """Optical flow from a frame to the next as arrows upon the depth image, drawn so long that they can be seen."""
    _draw_grey(axes, case, frame, black=-400)
    known = np.isfinite(case.recording.frames[frame].depth) & np.isfinite(flow.column_row).all(axis=-1)
    row, column = np.nonzero(known)
    if len(row):
        _draw_arrows(axes, np.stack([column, row], axis=1) + PIXEL_CENTRE, flow.column_row[row, column])
    front_view(case.recording, case.shown).frame(axes)
    axes.set_title(f"(c) 2D flow, frames {frame} and {frame + 1}")


def _draw_change(axes: Axes, case: Solved, flow: SceneFlow) -> None:
    """What the flow's lift to 3D adds: the change of depth of every pixel."""
    change_cm = 100 * flow.depth
    known = np.abs(change_cm[np.isfinite(change_cm)])
    largest = max(float(np.percentile(known, 95)) if known.size else 0.0, 0.1)
    image = axes.imshow(change_cm, cmap="PuOr", norm=Normalize(-largest, largest), extent=_extent(case))
    front_view(case.recording, case.shown).frame(axes)
    add_bar(axes, image, "change of depth [cm a frame]")
    axes.set_title("3D flow: change of depth")


def _draw_arrows(axes: Axes, place: np.ndarray, motion: np.ndarray) -> None:
    """Arrows at some of the places."""
    gap = max(float(np.ptp(place[:, 1])) / _ARROWS, 1.0)
    _, chosen = np.unique((place // gap).astype(int), axis=0, return_index=True)
    longest = max(float(np.percentile(np.linalg.norm(motion[chosen], axis=1), 95)), 1e-6)
    (column, row), (across, down) = place[chosen].T, motion[chosen].T
    scale = longest / (_LONGEST * gap)
    axes.quiver(column, row, across, down, color=COLOURS[1], angles="xy", scale_units="xy", scale=scale, width=0.006)


def _extent(case: Solved) -> tuple[float, float, float, float]:
    return 0.0, float(case.recording.camera.width), float(case.recording.camera.height), 0.0
