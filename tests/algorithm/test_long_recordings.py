"""Recordings that do not fit into memory: solved alike, in parts, from where a run was interrupted."""

import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from worlds import ball_behind_another, recorded, sphere

from algorithm import estimate, flow_parts, observations
from algorithm.at_hand import AtHand
from algorithm.estimate import estimated, room_for
from algorithm.flow_parts import FlowParts
from algorithm.scene_flow import ThereAndBack
from algorithm.settings import Settings, preset_settings
from algorithm.staged import solve
from algorithm.static import background
from recording.cache import Cache
from recording.motions import COLUMNS, Motions
from recording.recording import Recording


@pytest.fixture(scope="module")
def recording() -> Recording:
    return ball_behind_another()


@pytest.fixture
def in_small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flow_parts, "_PAIRS", 4)
    monkeypatch.setattr(observations, "_ROWS_AT_ONCE", 300)


def assert_same(one: Motions, other: Motions) -> None:
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_with_hardly_any_memory_the_motions_are_the_same(
    recording: Recording, preset: str, request: pytest.FixtureRequest
) -> None:
    settings = preset_settings(preset)
    plain = solve(recording, settings)
    request.getfixturevalue("in_small_parts")
    assert len(plain) > 100
    assert room_for(recording.metadata, 1) < recording.metadata.frames
    assert_same(solve(recording, settings, memory_bytes=1), plain)


@pytest.mark.usefixtures("in_small_parts")
def test_an_interrupted_run_goes_on_where_it_was(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache, made = Cache(folder=tmp_path), []
    original = FlowParts._made

    def interrupted(self: FlowParts, pairs: range, key: str) -> Iterator[ThereAndBack]:
        if pairs.start == 8 and len(made) == 2:
            raise KeyboardInterrupt
        made.append(pairs.start)
        return original(self, pairs, key)

    monkeypatch.setattr(FlowParts, "_made", interrupted)
    with pytest.raises(KeyboardInterrupt):
        solve(recording, cache=cache)
    made.append(-1)
    resumed = solve(recording, cache=cache)
    assert made == [0, 4, -1, 8, 12]
    assert_same(resumed, solve(recording))


def test_no_more_images_stay_than_there_is_room_for() -> None:
    made: list[int] = []

    def make(number: int) -> np.ndarray:
        made.append(number)
        return np.full((2, 3), number, np.float32)

    images = AtHand(make, 5, room=2)
    assert [int(image[0, 0]) for image in images] == [0, 1, 2, 3, 4]
    assert (images[-1] == 4).all()
    assert [int(image[0, 0]) for image in images[3:]] == [3, 4]
    assert made == [0, 1, 2, 3, 4]
    assert (images[0] == 0).all()
    assert made == [0, 1, 2, 3, 4, 0]
    with pytest.raises(IndexError):
        _ = images[5]


def test_an_estimate_counts_what_moves(recording: Recording) -> None:
    expected = estimated(recording, memory_bytes=10**9)
    moving = solve(recording).observed.sum()
    assert 0.5 * moving < expected.points < 2 * moving
    assert 0 < expected.seconds < 600
    enough = round(expected.memory_bytes)
    assert expected.within(enough + 1) == expected
    fewer = expected.within(enough - 1)
    assert fewer is not None
    assert fewer.points_apart_px == 2
    assert fewer.memory_bytes < enough
    assert expected.within(10**6) is None
    far = replace(expected, points_apart_px=50)
    assert far.within(enough) == far


def test_an_estimate_of_a_single_frame() -> None:
    one = recorded([sphere(lambda _: (0.1, 0, 1.5), 0.25)], frames=1, moving=[False])
    assert estimated(one, memory_bytes=10**9).seconds >= 0


def test_few_points_of_many_are_a_motion_too(recording: Recording) -> None:
    """Epsilon 4 counts the trajectories among all that there were."""
    many, few = (solve(recording, Settings(points_apart_px=apart, eps4=200)) for apart in (1, 2))
    assert len(few.motion_ids) == len(many.motion_ids) == 1
    assert 0 < len(np.unique(few.trajectory)) < 200 <= len(np.unique(many.trajectory))


def test_what_stands_still_is_found_in_the_room_that_the_estimate_leaves() -> None:
    generator = np.random.default_rng(1)
    depths = [generator.normal(3.0, 0.01, (120, 160)).astype(np.float32) for _ in range(70)]
    tracemalloc.start()
    try:
        background(depths, tolerance_m=0.03)
        largest = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert largest < estimate._BYTES_A_PIXEL * depths[0].size
