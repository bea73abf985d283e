"""Recordings and motions that show themselves: in a line, in a notebook, in a plot."""

import base64
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from random_recording import full_recording
from wellformed import read
from worlds import recorded, recording_of, small_camera, sphere

from recording.motions import NOISE, OBSERVED, Motions, Representative
from recording.palette import COLOURS, FAINT, colour_of, colours_of, rgb_of
from recording.recording import Recording
from recording.store import load_recording, save_recording

FRAMES = 6
HOSTILE = "<script>alert(1)</script>"


@pytest.fixture
def recording() -> Recording:
    return recorded([sphere(lambda t: (0.1 * t, 0.0, 2.0), 0.4)], frames=FRAMES, moving=[True])


@pytest.fixture
def axes() -> Axes:
    return Figure().subplots()


def moving(*ways: np.ndarray) -> Motions:
    """A motion of one point for each way, unseen in its third frame; and a point of noise."""
    count, frames = len(ways), len(ways[0])
    seen = np.arange(frames) != 2
    number = np.append(np.repeat(np.arange(count), frames), NOISE).astype(np.int32)
    return Motions(
        frame=np.append(np.tile(np.arange(frames), count), 0).astype(np.int32),
        trajectory=np.append(np.repeat(np.arange(count), frames), count).astype(np.int32),
        position=np.concatenate([*ways, [[0.0, 0.0, 2.0]]]).astype(np.float32),
        column_row=np.zeros((len(number), 2), np.float32),
        segment=number,
        motion=number,
        source=np.append(np.tile(np.where(seen, OBSERVED, 2), count), OBSERVED).astype(np.uint8),
        confidence=np.ones(len(number), np.float32),
        representatives=tuple(
            Representative(motion=motion, frame=np.arange(frames, dtype=np.int32), position=way, observed=seen)
            for motion, way in enumerate(ways)
        ),
    )


def straight(*, towards: tuple[float, float, float]) -> np.ndarray:
    return np.array([0.0, 0.0, 2.0]) + np.linspace(0, 1, FRAMES)[:, None] * np.array(towards)


def test_a_recording_says_in_a_line_what_it_is(recording: Recording) -> None:
    assert repr(recording) == "<Recording without a name: 6 frames of 80x60 pixels, 30 a second, 1 moving objects>"
    assert repr(recording_of([np.ones((3, 4))])).endswith("1 frames of 4x3 pixels, 30 a second>")


def test_a_notebook_shows_a_recordings_facts_and_its_middle_frame(recording: Recording) -> None:
    page = recording._repr_html_()
    tags, texts = read(page)
    assert {"6, 30 a second, 0.2 s", "80 x 60 pixels, 53° wide", "1: object 1", "frame 3, depth 1.6 "} <= set(texts)
    encoded = re.search('base64,([^"]+)', page)
    assert "img" in tags
    assert encoded is not None
    image = cv2.imdecode(np.frombuffer(base64.b64decode(encoded[1]), np.uint8), cv2.IMREAD_COLOR)
    grey = (image == int(FAINT[1:3], 16)).all(axis=-1)
    np.testing.assert_array_equal(grey, ~recording.frames[3].seen)


def test_a_recording_from_disk_without_returns_or_truth_shows_itself(tmp_path: Path, axes: Axes) -> None:
    folder = tmp_path / "empty"
    save_recording(recording_of([np.full((3, 4), np.nan)] * 2), folder)
    texts = read(load_recording(folder)._repr_html_())[1]
    assert {"unknown", "none"} <= set(texts)
    load_recording(folder).plot(axes=axes)


def test_what_stands_in_a_file_cannot_become_part_of_the_page() -> None:
    full = full_recording()
    named = full.metadata.model_copy(
        update={
            "name": HOSTILE,
            "sensor": {"preset": HOSTILE},
            "objects": tuple(entry.model_copy(update={"name": HOSTILE}) for entry in full.metadata.objects or ()),
        }
    )
    tags, texts = read(Recording(metadata=named, frames=full.frames)._repr_html_())
    assert "script" not in tags
    assert HOSTILE in texts


def test_a_recording_plots_the_frame_that_is_asked_for_in_metres_and_the_same_colours(
    recording: Recording, axes: Axes
) -> None:
    assert recording.plot(1, axes=axes) is axes
    image = axes.images[0]
    np.testing.assert_array_equal(np.asarray(image.get_array().filled(np.nan)), recording.frames[1].depth)
    assert image.get_clim() == pytest.approx((1.6, 2.0), abs=0.1)
    assert axes.get_title() == "recording, frame 1, 0.03 s"
    assert [each.get_ylabel() for each in axes.figure.axes] == ["", "depth [m]"]
    another = Figure().subplots()
    assert recording.plot(-1, axes=another).get_title().startswith("recording, frame 5")
    assert another.images[0].get_clim() == image.get_clim()
    with pytest.raises(IndexError):
        recording.plot(FRAMES)


def test_a_recording_plots_the_points_of_motions_where_they_are_in_its_picture(
    recording: Recording, axes: Axes
) -> None:
    motions = moving(straight(towards=(0.5, 0.0, 0.0)), straight(towards=(0.0, 0.5, 0.0)))
    recording.plot(2, motions=motions, axes=axes)  # The frame in which both are completed.
    completed, observed = axes.collections
    place, _ = recording.camera.pixel_from_world(motions.position[motions.frame == 2].astype(float))
    np.testing.assert_allclose(completed.get_offsets(), place)
    assert len(observed.get_offsets()) == 0


def test_one_call_makes_a_figure_that_a_notebook_shows(recording: Recording) -> None:
    before = set(plt.get_fignums())
    drawn = recording.plot(), moving(straight(towards=(1.0, 0.0, 0.0))).plot()
    assert len(set(plt.get_fignums()) - before) == len(drawn)
    for axes in drawn:
        plt.close(axes.figure)


def test_motions_say_in_a_line_what_they_are() -> None:
    motions = moving(straight(towards=(1.0, 0.0, 0.0)))
    assert repr(motions) == "<Motions: 1 motions, 7 points, 1 of them completed>"


def test_a_notebook_shows_a_row_a_motion_with_its_colour() -> None:
    page = moving(straight(towards=(1.0, 0.0, 0.0)), straight(towards=(0.0, 1.0, 0.0)))._repr_html_()
    _, texts = read(page)
    assert [text.strip() for text in texts[6:12]] == ["0", "0 to 5", "1", "1", "5", "1"]
    assert texts[-1] == "1 points of no motion, 0 links, 0 events"
    assert page.index(COLOURS[0]) < page.index(COLOURS[1])


def test_of_very_many_motions_a_notebook_shows_the_first() -> None:
    _, texts = read(moving(*[straight(towards=(1.0, 0.0, 0.0))] * 42)._repr_html_())
    assert texts[-1].startswith("2 more motions, ")


@pytest.mark.parametrize(
    ("towards", "labels"),
    [
        ((1.0, 2.0, 0.0), ("x [m]", "y [m]")),  # Up is z, as in simulated recordings.
        ((1.0, 0.1, 2.0), ("x [m]", "z [m]")),  # Up is -y, as in imported ones.
    ],
)
def test_motions_are_plotted_on_the_axes_along_which_they_reach_farthest(
    towards: tuple[float, float, float], labels: tuple[str, str], axes: Axes
) -> None:
    moving(straight(towards=towards)).plot(axes=axes)
    assert (axes.get_xlabel(), axes.get_ylabel()) == labels


def test_through_a_camera_motions_are_seen_from_its_top(axes: Axes) -> None:
    aside = np.array([[0.0, 0.0, 1.0, 5.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    camera = replace(small_camera(), world_from_camera=aside)
    moving(np.array([[8.0, 1.0, 0.0]] * FRAMES)).plot(camera, axes=axes)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("right of the camera [m]", "before the camera [m]")
    np.testing.assert_allclose(axes.lines[0].get_xydata(), [[1.0, 3.0]] * FRAMES)


def test_what_was_completed_is_dotted(axes: Axes) -> None:
    moving(straight(towards=(1.0, 1.0, 0.0))).plot(axes=axes)
    dotted, full, begin = axes.lines
    assert dotted.get_linestyle() == ":"
    np.testing.assert_array_equal(np.isnan(full.get_xdata()), np.arange(FRAMES) == 2)
    np.testing.assert_allclose(begin.get_xydata(), [[0.0, 0.0]])
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["motion 0"]


def test_no_motions_are_an_empty_table_and_an_empty_plot(axes: Axes) -> None:
    nothing = moving(straight(towards=(1.0, 0.0, 0.0))).rows(np.zeros(FRAMES + 1, bool))
    nothing = replace(nothing, representatives=())
    read(nothing._repr_html_())
    nothing.plot(axes=axes)
    assert axes.get_title().startswith("0 motions")


def test_colours_come_by_turns_and_noise_is_faint() -> None:
    assert colours_of(np.array([0, len(COLOURS), NOISE])).tolist() == [COLOURS[0], COLOURS[0], FAINT]
    assert colour_of(1) == COLOURS[1]
    assert rgb_of(np.array([1, NOISE])).tolist() == [[0xD5, 0x5E, 0x00], [0xBB, 0xBB, 0xBB]]


def test_who_draws_nothing_does_not_wait_for_matplotlib() -> None:
    asked = "import sys, recording.recording, recording.motions; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", asked], cwd=Path(__file__).parents[2], check=False).returncode == 0
