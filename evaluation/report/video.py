"""A solved recording as a video for talks: what the sensor saw beside what was found."""

import io
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
from jaxtyping import UInt8
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from algorithm.depth_image import DepthRange, depth_range
from evaluation.figures.panels import draw_curve, draw_places, draw_points
from evaluation.figures.stages import Solved
from evaluation.figures.style import styled
from recording.atomic import whole_file
from recording.drawing import as_picture, draw_dots
from recording.errors import InputError
from recording.motions import NOISE
from recording.palette import COLOURS, FAINT, colours_of
from recording.progress import tracked

KINDS = (".mp4", ".gif")
_SIZE = (1280, 720)
"""Pixels; a GIF has half of each."""
_DOTS_PER_INCH = 100
_LETTERS = 14.0
_CODEC = cv2.VideoWriter.fourcc(*"mp4v")
"""MPEG-4 Part 2: OpenCV's wheel holds no H.264, which it may not give away."""
_COLOURS = 128
"""Of a GIF."""
_TIME_SHARE = 0.012
"""Height of the bar that tells the time."""


def require_video(path: Path) -> None:
    """InputError where a video of that name cannot be written."""
    if path.suffix not in KINDS:
        raise InputError(f"{path}: expected a video that ends in {' or '.join(KINDS)}")


def write_video(case: Solved, path: Path, *, overwrite: bool = False) -> None:
    """Write the video, MP4 or GIF by the ending, at the recording's own speed, whole or not at all."""
    require_video(path)
    with whole_file(path, overwrite=overwrite) as partial, TemporaryDirectory() as passing:
        place = Path(passing) / f"video{path.suffix}"  # OpenCV wants the ending, which a partial file lacks.
        (_write_mp4 if path.suffix == ".mp4" else _write_gif)(case, place)
        partial.write_bytes(place.read_bytes())


def pictures_of(case: Solved) -> Iterator[UInt8[np.ndarray, "row column 3"]]:
    """The video's pictures, RGB, one a frame."""
    frames = case.recording.metadata.frames
    within = depth_range([case.recording.frames[frame].depth for frame in case.moments])
    for frame in tracked(range(frames), "video", total=frames):
        with styled(letters=_LETTERS):
            figure = Figure(figsize=(_SIZE[0] / _DOTS_PER_INCH, _SIZE[1] / _DOTS_PER_INCH), dpi=_DOTS_PER_INCH)
            canvas = FigureCanvasAgg(figure)
            _draw_sensed(figure.add_axes((0.02, 0.1, 0.38, 0.8)), case, frame, within)
            _draw_found(figure.add_axes((0.42, 0.1, 0.56, 0.8)), case, frame)
            _draw_time(figure, case, frame)
            canvas.print_figure(content := io.BytesIO(), format="raw", dpi=_DOTS_PER_INCH)
        yield np.frombuffer(content.getvalue(), np.uint8).reshape(_SIZE[1], _SIZE[0], 4)[..., :3]


def _draw_sensed(axes: Axes, case: Solved, frame: int, within: DepthRange) -> None:
    depth = case.recording.frames[frame].depth
    extent = (0, depth.shape[1], depth.shape[0], 0)
    axes.imshow(depth, cmap="gray", vmin=within[0] - 0.1, vmax=within[1] + 0.1, extent=extent, alpha=0.85)
    as_picture(axes, case.recording.camera)
    axes.set_title("what the sensor sees")


def _draw_found(axes: Axes, case: Solved, frame: int) -> None:
    """All points of the frame, the observed ones upon the completed ones, and the paths up to now."""
    view, motions = case.above, case.motions
    draw_dots(axes, view.picture(case.still), FAINT, size=0.6, alpha=0.3)
    for curve in case.representatives:
        past = curve.frame <= frame
        draw_curve(axes, np.where(past[:, None], view.picture(curve.position), np.nan), curve, width=2.5)
    now = motions.rows((motions.frame == frame) & (motions.motion != NOISE))
    hidden = now.rows(~now.observed)
    draw_places(axes, view.camera, hidden.position, colours_of(hidden.motion), size=5.0, alpha=0.35)
    draw_points(axes, view.camera, now.rows(now.observed), alphas=(0.0, 0.9), size=2.5)
    view.frame(axes)
    axes.set_title("what was found (pale: completed)")


def _draw_time(figure: Figure, case: Solved, frame: int) -> None:
    """The recording's name, the frame, the time, and a bar that grows with it."""
    known = case.recording.metadata
    figure.text(0.02, 0.94, known.name or "recording", fontsize=1.3 * _LETTERS, weight="bold")
    figure.text(0.98, 0.94, f"frame {frame}, {frame / known.fps:.2f} s", ha="right")
    bar = figure.add_axes((0.02, 0.05, 0.96, _TIME_SHARE))
    bar.barh(0, known.frames, color=FAINT, alpha=0.4)
    bar.barh(0, frame + 1, color=COLOURS[0])
    bar.set(xlim=(0, known.frames), ylim=(-0.4, 0.4))
    bar.set_axis_off()


def _write_mp4(case: Solved, place: Path) -> None:
    writer = cv2.VideoWriter(str(place), _CODEC, case.recording.fps, _SIZE)
    if not writer.isOpened():
        raise InputError(f"{place.suffix}: expected OpenCV to write MPEG-4, but it cannot here: choose a .gif")
    for picture in pictures_of(case):
        writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    writer.release()


def _write_gif(case: Solved, place: Path) -> None:
    """Milliseconds a frame are whole tens, as GIF has them."""
    half = (_SIZE[0] // 2, _SIZE[1] // 2)
    small = (Image.fromarray(cv2.resize(picture, half, interpolation=cv2.INTER_AREA)) for picture in pictures_of(case))
    first, *others = [picture.quantize(_COLOURS, dither=Image.Dither.NONE) for picture in small]
    duration = max(20, round(100 / case.recording.fps) * 10)
    first.save(place, save_all=True, append_images=others, duration=duration, loop=0)
