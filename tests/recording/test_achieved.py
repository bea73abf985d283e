"""The achieved occlusion of a crossing behind a wall, counted by hand, and by the other functions that count it."""

import numpy as np
import pytest
from known import FRAMES, crossing

from recording.achieved import achieved_occlusion
from recording.causes import causes_of, tally_of
from recording.metadata import ObjectRecord
from recording.occlusion import Achieved, Hiders, Holes, Nearness
from recording.recording import Recording
from recording.visibility import holes, visibility_of


def achieved(recording: Recording) -> Achieved:
    assert recording.xray is not None
    pictures = zip(recording.frames, recording.xray, strict=True)
    tallies = [tally_of(frame, xray, recording.metadata) for frame, xray in pictures]
    return achieved_occlusion(tallies, recording.metadata, clearance_m=Nearness(people=0.75))


def renamed(recording: Recording, kinds: dict[int, str]) -> Recording:
    """The recording with other kinds of objects."""
    objects = tuple(
        ObjectRecord(id=entry.id, name=entry.name, kind=kinds.get(entry.id, entry.kind), moving=entry.moving)
        for entry in recording.metadata.objects or ()
    )
    metadata = recording.metadata.model_copy(update={"objects": objects})
    return Recording(metadata=metadata, frames=recording.frames, truth=recording.truth, xray=recording.xray)


def test_both_squares_are_hidden_once_behind_the_wall() -> None:
    recording = crossing()
    found, visibility = achieved(recording), visibility_of(recording)
    lengths = tuple(sorted(hole.frames for hole in holes(visibility) or ()))
    assert len(lengths) == 2
    assert found.hole_frames == Holes(
        count=2,
        median=np.mean(lengths),
        lower_quartile=np.quantile(lengths, 0.25),
        upper_quartile=np.quantile(lengths, 0.75),
        longest=lengths[-1],
        lengths=lengths,
    )
    assert found.object_frames == 2 * FRAMES
    assert found.hidden_object_frames == sum(lengths) == visibility.hidden.sum()
    assert found.hidden_share == pytest.approx(sum(lengths) / (2 * FRAMES), abs=1e-6)
    assert found.by == Hiders(people=0, balls=0, obstacles=1, sensor=0)
    assert found.clearance_m == Nearness(people=0.75, obstacles=None)


@pytest.mark.parametrize(("kind", "hider"), [("person", "people"), ("juggler", "people"), ("ball", "balls")])
def test_what_hides_goes_by_its_kind(kind: str, hider: str) -> None:
    found = achieved(renamed(crossing(), {7: kind})).by
    assert found is not None
    assert getattr(found, hider) == 1.0


def test_what_the_sensor_loses_it_hides() -> None:
    recording = crossing(wall=False, lost=0.95)
    found, causes = achieved(recording), causes_of(recording)
    assert found.by is not None
    assert found.by.sensor == pytest.approx((causes.cause == -2).sum() / found.hidden_object_frames, abs=1e-6)
    assert found.by.sensor > 0.9


def test_where_nothing_is_hidden_nothing_hides() -> None:
    recording = crossing(wall=False)
    visible = [
        {key: np.where(frame.labels.objectid == key, frame.depth, np.float32(np.nan)) for key in recording.moving_ids}
        for frame in recording.frames
        if frame.labels is not None
    ]
    found = achieved(Recording(metadata=recording.metadata, frames=recording.frames, xray=visible))
    assert found.hole_frames == Holes(count=0, lengths=())
    assert (found.by, found.hidden_share) == (None, 0.0)


def test_what_never_comes_into_view_has_no_share() -> None:
    recording = crossing()
    gone = [{key: np.full_like(depth, np.nan) for key, depth in xray.items()} for xray in recording.xray or ()]
    found = achieved(Recording(metadata=recording.metadata, frames=recording.frames, xray=gone))
    assert (found.object_frames, found.hidden_share) == (0, None)
