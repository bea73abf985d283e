"""The measure of the search: holes as the evaluation counts them, and nearer to the wish is less."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recording.visibility import runs_of
from simulator.foresight import seen_share
from simulator.misfit import Cover, foretold, hidden_share, holes_of, misfit
from simulator.occlusion import OcclusionWish

ALL = np.uint64(2**64 - 1)


def cover_of(hidden: np.ndarray, *, by_obstacles: bool = False) -> Cover:
    """Crowds that are wholly in the picture, and wholly covered where they are hidden."""
    cells, nothing = np.where(hidden, ALL, np.uint64(0)), np.zeros(hidden.shape, np.uint64)
    inside = np.full(hidden.shape, ALL)
    return Cover(inside=inside, people=nothing if by_obstacles else cells, obstacles=cells if by_obstacles else nothing)


def one_hole(frames: int, *, of: int = 60) -> np.ndarray:
    hidden = np.zeros((1, 2, of), bool)
    hidden[0, 1, 10 : 10 + frames] = True
    return hidden


@given(st.integers(0, 2**32 - 1))
def test_holes_are_those_of_the_evaluation(seed: int) -> None:
    generator = np.random.default_rng(seed)
    state = generator.integers(0, 3, (3, 2, 12))  # Out of view, hidden, seen.
    hidden, in_view = state == 1, state > 0
    found = holes_of(hidden, in_view)
    for crowd in range(3):
        runs = runs_of((1, 2), hidden=hidden[crowd], in_view=in_view[crowd])
        wanted = sorted(run.frames for run in runs if run.hole)
        assert found.frames[found.crowd == crowd].tolist() == wanted


def test_what_is_seen_is_the_share_of_the_cells_that_are_left() -> None:
    inside, covered = np.array([ALL, ALL, np.uint64(0b1111), np.uint64(0)]), np.array([0, ALL, 0b0111, 0], np.uint64)
    assert seen_share(inside, covered).tolist() == [1.0, 0.0, 0.25, 1.0]


@pytest.mark.parametrize("frames", [3, 10, 30])
def test_the_hole_that_was_wished_fits_best(frames: int) -> None:
    wish = OcclusionWish(hole_frames=frames)
    off = [misfit(wish, cover_of(one_hole(each)), chance=0.5)[0] for each in (2, 3, 5, 10, 20, 30, 45)]
    assert (2, 3, 5, 10, 20, 30, 45)[int(np.argmin(off))] == frames
    assert min(off) == pytest.approx(0, abs=1e-9)


def test_no_hole_is_worse_than_a_wrong_one() -> None:
    wish = OcclusionWish(hole_frames=10)
    none, wrong = (misfit(wish, cover_of(one_hole(each)), chance=0.5)[0] for each in (0, 40))
    assert none > wrong > 1


def test_the_hidden_share_counts_if_it_is_wished() -> None:
    cover = cover_of(one_hole(12))
    assert foretold(cover).hidden_share == pytest.approx(0.1)
    assert hidden_share(one_hole(12), np.ones((1, 2, 60), bool)).tolist() == [0.1]
    asked = [OcclusionWish(hole_frames=12, hidden_share=share) for share in (0.1, 0.2)]
    met, missed = (misfit(wish, cover, chance=0.5)[0] for wish in asked)
    assert met < 0.01
    assert missed > 10


@pytest.mark.parametrize(("by", "better"), [("people", False), ("obstacles", True)])
def test_who_hides_counts_if_it_is_wished(by: str, better: bool) -> None:
    wish = OcclusionWish.model_validate({"hole_frames": 12, "by": by})
    people, obstacles = (
        misfit(wish, cover_of(one_hole(12), by_obstacles=each), chance=0.5)[0] for each in (False, True)
    )
    assert (obstacles < people) == better


def test_a_run_that_begins_hidden_is_no_hole_and_is_foretold_so() -> None:
    hidden = np.zeros((1, 1, 20), bool)
    hidden[0, 0, :8] = True
    assert foretold(cover_of(hidden)).hole_median is None
    assert foretold(cover_of(hidden)).sentence == "no hole and 0.40 hidden"
