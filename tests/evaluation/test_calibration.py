"""Confidences in tenths: what was said, and what holds."""

from dataclasses import replace

import numpy as np
import pytest
from known import LEFT, crossing, empty, perfect
from known import with_rows as changed

from evaluation.calibration import Tenth, largest_miss, pooled, sure_share, tenths, tenths_from
from evaluation.scores import scores
from recording.motions import Link


def test_every_claim_is_in_one_tenth_and_one_is_in_the_last() -> None:
    found = tenths(
        np.array([0.0, 0.05, 0.1, 0.95, 1.0, 1.2, -0.1]), np.array([True, False, True, True, False, True, True])
    )
    assert [tenth.count for tenth in found] == [3, 1, 0, 0, 0, 0, 0, 0, 0, 3]
    assert [tenth.holding for tenth in found] == [2, 1, 0, 0, 0, 0, 0, 0, 0, 2]
    assert found[0].share == pytest.approx(2 / 3)
    assert found[4].share is None
    assert (found[3].begin, found[3].end) == (0.3, 0.4)


def test_said_at_random_but_honestly_there_is_hardly_a_miss() -> None:
    generator = np.random.default_rng(0)
    confidence = generator.random(20_000)
    found = tenths(confidence, generator.random(20_000) < confidence)
    assert largest_miss(found, least=50) < 0.03
    boast = tenths(np.full(100, 0.95), np.arange(100) < 60)
    assert largest_miss(boast, least=50) == pytest.approx(0.35)
    assert largest_miss(boast, least=101) is None


def test_pooled_recordings_count_as_one() -> None:
    one = tenths(np.array([0.55, 0.95]), np.array([True, True]))
    other = tenths(np.array([0.55, 0.57]), np.array([False, True]))
    both = pooled([one, other])
    assert both == tenths(np.array([0.55, 0.95, 0.55, 0.57]), np.array([True, True, False, True]))
    assert sure_share(both) == pytest.approx(1 / 3)
    assert pooled([]) == tenths(np.empty(0), np.empty(0, bool))
    assert sure_share(pooled([])) is None


def test_links_hold_when_both_segments_are_of_one_object() -> None:
    recording = crossing()
    motions = perfect(recording)
    doubtful = replace(
        motions, links=(Link(before=10, after=21, confidence=0.35), Link(before=20, after=21, confidence=0.8))
    )
    found = scores(recording, doubtful)["calibration"]
    assert tenths_from(found["links"]) == tenths(np.array([0.35, 0.8]), np.array([False, True]))
    assert found["right_links_above_90"] == 0
    assert [(each["begin"], each["share"]) for each in found["links"]] == [(0.3, 0.0), (0.8, 1.0)]


def test_completed_points_hold_within_16_cm() -> None:
    recording = crossing()
    motions = perfect(recording)
    wrong = ~motions.observed & (motions.motion == LEFT)
    position = np.where(wrong[:, None], motions.position + np.float32([0.0, 0.2, 0.0]), motions.position)
    said = changed(motions, position=position, confidence=np.where(wrong, 0.25, 0.85).astype(np.float32))
    low, high = scores(recording, said)["calibration"]["completed"]
    assert (low["begin"], low["share"]) == (0.2, 0.0)
    assert (high["begin"], high["share"]) == (0.8, 1.0)
    assert low["count"] > 100


def test_who_says_nothing_has_no_calibration() -> None:
    assert scores(crossing(), empty())["calibration"] == {"links": [], "completed": []}


def test_a_tenth_is_a_value() -> None:
    assert Tenth(begin=0.1, end=0.2, count=4, holding=1).share == 0.25
