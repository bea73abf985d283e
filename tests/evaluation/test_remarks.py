"""What is said of motions beside their scores."""

from dataclasses import replace

import numpy as np
import pytest
from known import all_noise, crossing, empty, perfect
from worlds import recording_of

from evaluation.remarks import remarks, why_no_motions
from evaluation.scores import scores
from evaluation.summary import summary
from recording.corrections import Anchor, Correction, Corrections
from recording.motions import Motions
from recording.recording import Recording, stripped

SHAPE = (48, 64)


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return perfect(recording)


def test_where_motions_were_found_nothing_is_said(recording: Recording, motions: Motions) -> None:
    assert remarks(recording, motions) == []


@pytest.mark.parametrize(
    ("depths", "why"),
    [
        ([np.full(SHAPE, np.nan)] * 5, "no frame holds a depth"),
        ([np.full(SHAPE, 2.0)], "1 frame, too few to follow anything"),
        ([np.full(SHAPE, 2.0)] * 12, "nothing moves"),
        (list(np.random.default_rng(0).uniform(1, 9, (12, *SHAPE))), "all that is seen moves: noise, or"),
    ],
)
def test_without_motions_the_reason_is_said(depths: list[np.ndarray], why: str) -> None:
    ((about, sentence),) = remarks(recording_of(depths), empty())
    assert about == "no motions"
    assert sentence.startswith(why)


def test_what_could_not_be_followed_is_told_from_what_makes_no_motion(recording: Recording, motions: Motions) -> None:
    assert why_no_motions(recording, empty()).startswith("what moves is too small")
    noise = all_noise(motions)
    count = len(np.unique(noise.trajectory))
    assert why_no_motions(recording, noise) == f"{count} trajectories were followed, but no motion has enough of them"
    told = replace(noise, making=replace(noise.making, settings={"eps4": 2000.0}))
    assert why_no_motions(recording, told).endswith("no motion has eps4 = 2000 of them")


def test_the_summary_tells_what_was_said_by_hand(recording: Recording, motions: Motions) -> None:
    mark = Anchor(frame=0, column=1.5, row=2.5)
    said = Corrections(recording_digest="", correction=(Correction(kind="same", one=mark, other=mark),))
    mended = replace(motions, making=replace(motions.making, corrections=said))
    lines = summary(scores(recording, mended), remarks(recording, mended)).splitlines()
    assert lines[-1] == "corrections     1 by hand"


def test_the_summary_without_truth_holds_no_score(recording: Recording, motions: Motions) -> None:
    lines = summary(scores(stripped(recording), motions)).splitlines()
    assert [line.split()[0] for line in lines] == ["recording", "motions", "time"]
    assert lines[-1] == "time            2.0 s without the cache, of it flow 1.0 s"
