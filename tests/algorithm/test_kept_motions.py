"""While somebody corrects by hand, each motion is completed once."""

from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from worlds import recorded, sphere

from algorithm import continued, pipeline
from algorithm.settings import Settings
from algorithm.staged import solve
from recording.cache import Cache
from recording.corrections import Anchor, Correction, Corrections
from recording.errors import InputError
from recording.motions import COLUMNS, Motions
from recording.recording import Recording

SETTINGS = Settings(eps4=3)


@pytest.fixture(scope="module")
def recording() -> Recording:
    """A ball passes behind another."""
    near = sphere(lambda frame: (0.1, 0, 1.5), 0.25)
    far = sphere(lambda frame: (-0.9 + 0.12 * frame, 0, 2.5), 0.3)
    return recorded([near, far], frames=16, moving=[False, True])


@pytest.fixture(scope="module")
def plain(recording: Recording) -> Motions:
    """Before corrections: one motion of two segments."""
    return solve(recording, SETTINGS)


def assert_same(one: Motions, other: Motions) -> None:
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.links == other.links
    for first, second in zip(one.representatives, other.representatives, strict=True):
        np.testing.assert_array_equal(first.position, second.position)
        np.testing.assert_array_equal(first.observed, second.observed)


def anchor(motions: Motions, segment: int) -> Anchor:
    rows = np.flatnonzero(motions.observed & (motions.segment == segment))
    row = rows[len(rows) // 2]
    column, line = motions.column_row[row].tolist()
    return Anchor(frame=int(motions.frame[row]), column=column, row=line, segment=segment)


def test_a_correction_is_respected_and_only_what_it_changes_is_completed_anew(
    recording: Recording, plain: Motions, tmp_path: Path
) -> None:
    cache, none = Cache(folder=tmp_path), Corrections(recording_digest=recording.digest())
    (link,) = plain.links
    parted = none.plus(Correction(kind="different", one=anchor(plain, link.before), other=anchor(plain, link.after)))
    with patch.object(continued, "completed", wraps=continued.completed) as completing:
        for corrections, made in ((none, 1), (none, 1), (parted, 3), (none, 3), (parted, 3)):
            found = solve(recording, SETTINGS, cache=cache, corrections=corrections)
            assert completing.call_count == made
            assert found.making.corrections == corrections
            assert len(found.motion_ids) == (2 if corrections.correction else 1)
    assert_same(solve(recording, SETTINGS, cache=cache, corrections=none), plain)
    anew = pipeline.solve(recording, SETTINGS, corrections=parted)
    assert_same(solve(recording, SETTINGS, cache=cache, corrections=parted), anew)
    assert plain.making.corrections is None


def test_under_other_settings_nothing_is_taken_from_the_cache(recording: Recording, tmp_path: Path) -> None:
    cache, none = Cache(folder=tmp_path), Corrections(recording_digest=recording.digest())
    solve(recording, SETTINGS, cache=cache, corrections=none)
    with patch.object(continued, "completed", wraps=continued.completed) as completing:
        solve(recording, Settings(eps4=3, intra_gate=4.0), cache=cache, corrections=none)
        assert completing.call_count == 1


def test_a_foreign_recording_is_refused_before_anything_is_made(recording: Recording) -> None:
    with pytest.raises(InputError, match="another one"):
        solve(recording, SETTINGS, corrections=Corrections(recording_digest="abc"))
