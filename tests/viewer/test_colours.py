"""Colours: by motion, segment, error and depth; what is unknown is faint, what is not picked pale."""

import numpy as np
import pytest
from known_motions import two_motions
from worlds import recorded, sphere

from recording.palette import COLOURS, FAINT, TRUTH, rgb
from viewer.answer import Answer, Judgement
from viewer.clouds import Cloud, motion_cloud
from viewer.colours import (
    COLOURINGS,
    Colouring,
    Shades,
    bare_colours,
    legend,
    motion_colours,
    pale,
    scaled,
)
from viewer.space import space_of

MOTIONS = two_motions()


def shades(colouring: Colouring, picked: int | None = None) -> Shades:
    return Shades(colouring=colouring, depth_m=(0.0, 2.0), picked=picked)


def observed_cloud() -> Cloud:
    recording = recorded([sphere(lambda _: (0.0, 0.0, 3.0), 0.4)], frames=6, moving=[True])
    return motion_cloud(MOTIONS, MOTIONS.observed, recording, space_of(recording, MOTIONS))


def row_colours(shades: Shades, judgement: Judgement | None = None) -> dict[tuple[int, int], tuple[int, ...]]:
    """The colour of every observed point by frame and trajectory."""
    cloud = observed_cloud()
    assert cloud.row is not None
    colours = motion_colours(cloud, Answer(motions=MOTIONS, judgement=judgement), shades)
    keys = zip(MOTIONS.frame[cloud.row].tolist(), MOTIONS.trajectory[cloud.row].tolist(), strict=True)
    return dict(zip(keys, map(tuple, colours.tolist()), strict=True))


def test_motions_and_segments_have_their_numbers_colours_and_noise_is_faint() -> None:
    by_motion, by_segment = row_colours(shades("motion")), row_colours(shades("segment"))
    assert by_motion[5, 1] == tuple(rgb(COLOURS[1]))
    assert by_segment[5, 1] == tuple(rgb(COLOURS[2]))
    assert by_motion[0, 2] == by_segment[0, 2] == tuple(rgb(FAINT))


def test_what_is_not_picked_is_pale() -> None:
    found = row_colours(shades("motion", picked=1))
    assert found[0, 1] == tuple(rgb(COLOURS[1]))
    assert found[0, 0] == tuple(pale(rgb(COLOURS[0])[None], np.array([True]))[0])


def test_errors_go_from_dark_to_light_and_are_faint_where_unknown() -> None:
    error = np.full(len(MOTIONS), np.nan, np.float32)
    error[[0, 1]] = 0.0, 9.9
    found = row_colours(shades("error"), Judgement(scores={}, error_m=error, matches={}))
    assert sum(found[0, 0]) < sum(found[1, 0])
    assert found[2, 0] == tuple(rgb(FAINT))
    assert set(row_colours(shades("error")).values()) == {tuple(rgb(FAINT))}  # Nothing is judged.


def test_numbers_beyond_their_bounds_have_the_bounds_colours() -> None:
    colours = scaled(np.array([-1.0, 0.0, 2.0, 3.0]), 0.0, 2.0, "viridis")
    np.testing.assert_array_equal(colours[0], colours[1])
    np.testing.assert_array_equal(colours[2], colours[3])


def test_sensed_points_are_faint_and_the_truth_grey_but_by_depth() -> None:
    cloud = observed_cloud()
    assert set(map(tuple, bare_colours(cloud, shades("error"), truth=False))) == {tuple(rgb(FAINT))}
    assert set(map(tuple, bare_colours(cloud, shades("motion"), truth=True))) == {tuple(rgb(TRUTH))}
    assert len(set(map(tuple, bare_colours(cloud, shades("depth"), truth=True)))) == 3  # As many depths.


@pytest.mark.parametrize("colouring", COLOURINGS)
def test_every_colouring_has_a_legend_with_its_unit(colouring: Colouring) -> None:
    unit = {"error": "cm", "depth": "m"}.get(colouring, "noise")
    assert unit in legend(shades(colouring))


def test_a_cloud_of_no_motions_has_no_motions_colours() -> None:
    bare = Cloud(points=np.zeros((0, 3), np.float16), begin=np.zeros(2, int), depth_m=np.zeros(0, np.float32))
    with pytest.raises(ValueError, match="rows of motions"):
        motion_colours(bare, Answer(motions=MOTIONS), shades("motion"))
