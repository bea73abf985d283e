"""Laws of recordings and motions, on recordings that nobody would think of."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from worlds import recording_of

import unocclude
from recording.motions import COLUMNS
from recording.recording import Recording

depth_metres = st.one_of(st.just(np.nan), st.floats(0.5, 6.0, width=32), st.floats(2**-13, 2**16, width=32))


Depths = np.ndarray  # A recording is made of them in the test: in a strategy nothing may look at annotations.


@st.composite
def tiny_depths(draw: st.DrawFn) -> Depths:
    """Of a few frames: any depths, or a patch that wanders over an even ground."""
    frames, rows, columns = (draw(st.integers(1, most)) for most in (7, 9, 12))
    if draw(st.booleans()):
        return draw(arrays(np.float32, (frames, rows, columns), elements=depth_metres))
    depths = np.full((frames, rows, columns), draw(st.floats(2, 5)), np.float32)
    for frame in range(frames):
        row, column = draw(st.integers(0, rows - 1)), draw(st.integers(0, columns - 1))
        depths[frame, row : row + 4, column : column + 4] = draw(depth_metres)
    return depths


def check_solved(recording: Recording, preset: str) -> None:
    motions = unocclude.solve(recording, unocclude.preset_settings(preset))
    assert np.isfinite(motions.position).all()
    assert ((motions.frame >= 0) & (motions.frame < recording.metadata.frames)).all()
    assert ((motions.confidence >= 0) & (motions.confidence <= 1)).all()
    order = np.lexsort((motions.frame, motions.trajectory))
    assert np.array_equal(order, np.arange(len(motions)))


@settings(max_examples=30)
@given(depths=tiny_depths(), preset=st.sampled_from(["default", "paper"]))
def test_solve_never_raises(depths: Depths, preset: str) -> None:
    check_solved(recording_of(list(depths)), preset)


@pytest.mark.soak
@settings(max_examples=1500)
@given(depths=tiny_depths(), preset=st.sampled_from(["default", "paper"]))
def test_solve_never_raises_on_many(depths: Depths, preset: str) -> None:
    check_solved(recording_of(list(depths)), preset)


@settings(max_examples=30)
@given(depths=tiny_depths())
def test_what_is_saved_comes_back(depths: Depths) -> None:
    recording = recording_of(list(depths))
    with TemporaryDirectory() as folder:
        unocclude.save_recording(recording, Path(folder) / "a")
        loaded = unocclude.load_recording(Path(folder) / "a")
        for one, other in zip(recording.frames, loaded.frames, strict=True):
            np.testing.assert_array_equal(one.depth, other.depth)
        assert loaded.metadata == recording.metadata
        assert loaded.digest() == recording.digest()


@settings(max_examples=20)
@given(depths=tiny_depths(), seed=st.integers(0, 99))
def test_motions_come_back_in_order_whatever_order_they_were_stored_in(depths: Depths, seed: int) -> None:
    motions = unocclude.solve(recording_of(list(depths)), unocclude.preset_settings("paper"))
    shuffled = motions.rows(np.random.default_rng(seed).permutation(len(motions)))
    with TemporaryDirectory() as folder:
        unocclude.save_motions(shuffled, Path(folder) / "a.parquet")
        loaded = unocclude.load_motions(Path(folder) / "a.parquet")
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(loaded, name), getattr(motions, name))


@settings(max_examples=20)
@given(depths=tiny_depths())
def test_a_recording_is_solved_alike_in_memory_and_from_disk(depths: Depths) -> None:
    recording = recording_of(list(depths))
    with TemporaryDirectory() as folder:
        unocclude.save_recording(recording, Path(folder) / "a")
        stored = unocclude.solve(unocclude.load_recording(Path(folder) / "a"))
    here = unocclude.solve(recording)
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(stored, name), getattr(here, name))
