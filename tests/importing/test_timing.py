"""Frames keep their place in time: what was dropped leaves an empty frame."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from importing.timing import Dropped, Timeline, timeline
from recording.errors import InputError


def line(times: list[float], *, fps: float | None = None, dropped: Dropped = "empty") -> Timeline:
    return timeline(tuple(times), count=len(times), fps=fps, dropped=dropped, source="test")


def test_without_times_frames_follow_one_another() -> None:
    found = timeline(None, count=3, fps=15.0, dropped="empty", source="test")
    assert (found.fps, found.places, found.stamps, found.empty) == (15.0, (0, 1, 2), None, 0)
    with pytest.raises(InputError, match="test: expected frames a second, but nothing in it says how many: pass --fps"):
        timeline(None, count=3, fps=None, dropped="empty", source="test")


def test_a_dropped_frame_leaves_a_number_and_a_stamp_between() -> None:
    found = line([5.0, 5.1, 5.4, 5.5])
    assert found.fps == 10.0
    assert found.places == (0, 1, 4, 5)
    assert found.empty == 2
    assert found.stamps is not None
    np.testing.assert_allclose(found.stamps, [5.0, 5.1, 5.2, 5.3, 5.4, 5.5])


def test_dropped_frames_are_left_out_if_so_wanted() -> None:
    found = line([5.0, 5.1, 5.4, 5.5], dropped="skip")
    assert found.places == (0, 1, 2, 3)
    assert found.stamps == (5.0, 5.1, 5.4, 5.5)


@given(st.integers(0, 2**32 - 1), st.sampled_from([5.0, 29.97, 30.0, 90.0]), st.floats(-0.002, 0.002))
def test_neither_jitter_nor_drift_makes_gaps(seed: int, fps: float, drift: float) -> None:
    generator = np.random.default_rng(seed)
    frames = np.delete(np.arange(400), generator.choice(np.arange(1, 399), 12, replace=False))
    times = frames / fps * (1 + drift) + generator.uniform(-0.15, 0.15, frames.size) / fps
    assert line([*times], fps=fps).places == tuple(frames - frames[0])


def test_the_rate_is_the_usual_one() -> None:
    assert line([0.0, 1 / 30, 2 / 30, 3 / 30, 1.0]).fps == 30.0


@pytest.mark.parametrize(
    ("times", "options", "expected"),
    [
        ([0.0, 0.1, 0.1], {}, "expected time stamps that grow, got 0.1 after 0.1 at frame 2"),
        ([0.0, 0.2, 0.1], {}, "expected time stamps that grow, got 0.1 after 0.2 at frame 2"),
        ([0.0, np.nan], {}, "expected time stamps in seconds, got nan"),
        (
            [0.0, 3000.0, 6000.0],
            {},
            "of 0.001 to 1000 frames a second, got those of 0",
        ),
        ([0.0, 1e-9, 2e-9, 5.0], {}, "got those of 1e+09"),
        ([0.0], {}, "which one frame does not tell: pass --fps"),
        ([0.0, 0.1, 0.2], {"fps": 30.0}, "fps: expected about 10, as the time stamps say, got 30: leave --fps out"),
        ([0.0, 0.1, 0.2, 60.0], {}, "expected gaps below 10 s, got one of 59.8 s after frame 2"),
    ],
)
def test_times_that_cannot_be_are_refused(times: list[float], options: dict[str, float], expected: str) -> None:
    with pytest.raises(InputError) as refused:
        line(times, **options)  # type: ignore[arg-type]  # Only fps.
    assert expected in str(refused.value)


def test_one_frame_at_a_given_rate_is_a_recording() -> None:
    assert line([7.0], fps=10.0).places == (0,)
