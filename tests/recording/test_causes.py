"""What hides an object: the wall, another one, the sensor; every unoccluded pixel has one fate."""

from dataclasses import replace

import numpy as np
import pytest
from known import FRAMES, GROUND, LEFT, RIGHT, WALL, crossing, masks_only

from recording.causes import NOT_HIDDEN, OUT_OF_VIEW, SENSOR, causes_of
from recording.errors import InputError
from recording.frame import Frame
from recording.recording import Recording, stripped
from recording.visibility import visibility_of


@pytest.mark.parametrize("lost", [0.0, 0.3])
def test_every_unoccluded_pixel_is_seen_covered_or_lost(lost: float) -> None:
    recording = crossing(lost=lost)
    found, visibility = causes_of(recording), visibility_of(recording)
    assert found.ids == (LEFT, RIGHT)
    assert found.covers == (LEFT, RIGHT, WALL, GROUND)
    np.testing.assert_array_equal(found.seen, visibility.seen)
    np.testing.assert_array_equal(found.unoccluded, visibility.unoccluded)
    np.testing.assert_array_equal(found.hidden, found.covered.sum(axis=2) + found.lost)
    assert (found.lost.sum() > 0) == (lost > 0)


def test_behind_the_wall_it_is_the_wall() -> None:
    recording = crossing()
    found = causes_of(recording)
    hidden = visibility_of(recording).hidden
    assert hidden is not None
    assert hidden.sum() > 10
    np.testing.assert_array_equal(found.cause == WALL, hidden)
    assert (found.cause[~hidden] == NOT_HIDDEN).all()
    assert found.shares(LEFT, 18) == {WALL: 1.0}
    assert found.shares(LEFT, 0) == {}


def test_without_the_wall_the_near_square_hides_the_far_one_and_none_hides_the_near_one() -> None:
    found = causes_of(crossing(wall=False))
    when = int(found.covered[1, :, 0].argmax())
    assert found.cause[1, when] == LEFT
    assert list(found.shares(RIGHT, when)) == [LEFT]
    assert found.shares(RIGHT, when)[LEFT] > 0.8
    assert not found.covered[0].any()
    assert (found.cause[0] == NOT_HIDDEN).all()


def test_shares_name_the_largest_cover_first() -> None:
    found = causes_of(crossing(lost=0.2))
    shares = found.shares(LEFT, 11)
    assert len(shares) == 2
    assert set(shares) == {WALL, SENSOR}
    assert list(shares.values()) == sorted(shares.values(), reverse=True)
    whole = found.covered[0, 11].sum() + found.lost[0, 11] + found.seen[0, 11]
    assert sum(shares.values()) == pytest.approx(1 - found.seen[0, 11] / whole)


def test_what_only_the_sensor_hides_is_called_so() -> None:
    found = causes_of(crossing(wall=False, lost=0.95))
    assert (found.cause[0] == SENSOR).mean() > 0.9


def test_out_of_view_is_a_cause_of_its_own() -> None:
    recording = crossing()
    assert recording.xray is not None
    gone = [
        {key: np.full_like(depth, np.nan) if key == LEFT and number < 3 else depth for key, depth in xray.items()}
        for number, xray in enumerate(recording.xray)
    ]
    frames = [without(frame, LEFT) if number < 3 else frame for number, frame in enumerate(recording.frames)]
    found = causes_of(Recording(metadata=recording.metadata, frames=frames, xray=gone))
    assert (found.cause[0] == OUT_OF_VIEW).tolist() == [number < 3 for number in range(FRAMES)]
    assert found.shares(LEFT, 0) == {}


def without(frame: Frame, objectid: int) -> Frame:
    """The frame with nothing where the object was."""
    assert frame.labels is not None
    gone = frame.labels.objectid == objectid
    labels = replace(frame.labels, objectid=np.where(gone, 0, frame.labels.objectid).astype(np.uint32))
    return replace(frame, depth=np.where(gone, np.nan, frame.depth).astype(np.float32), labels=labels)


def test_nothing_moving_has_no_causes() -> None:
    recording = crossing()
    still = [entry.model_copy(update={"moving": False}) for entry in recording.metadata.objects or ()]
    metadata = recording.metadata.model_copy(update={"objects": tuple(still)})
    found = causes_of(Recording(metadata=metadata, frames=recording.frames, xray=[{}] * FRAMES))
    assert found.cause.shape == (0, FRAMES)


def test_what_cannot_be_asked_is_refused() -> None:
    for bare in (stripped(crossing()), masks_only(crossing())):
        with pytest.raises(InputError, match="only simulated ones know what hides"):
            causes_of(bare)
    found = causes_of(crossing())
    with pytest.raises(InputError, match=r"expected a moving object, one of \[1, 2\], got 7"):
        found.shares(WALL, 0)
    with pytest.raises(InputError, match="expected a frame from 0 to 35, got 36"):
        found.shares(LEFT, 36)
