"""Corrections by hand: known mistakes that they mend, and what cannot be respected."""

import numpy as np
import pytest
from made import body, crossing, person, same_partition, walker
from marking import SETTINGS, all_said, mark, mended, pictured, said

from algorithm.continued import continued
from algorithm.corrections import check_corrections, corrected
from algorithm.followed import Followed
from algorithm.given import NOTHING_GIVEN, Given
from algorithm.pipeline import completed_motions
from algorithm.result import Solution
from algorithm.settings import preset_settings
from recording.corrections import Anchor, Correction, CorrectionKind, Corrections
from recording.errors import InputError


def solved(followed: Followed, segment: np.ndarray, *every: Correction) -> Solution:
    return completed_motions(followed, segment, SETTINGS, None, all_said(*every))


def segments_together(solution: Solution) -> list[tuple[int, ...]]:
    return [motion.segments for motion in solution.motions]


@pytest.fixture(scope="module")
def crossed() -> tuple[Followed, np.ndarray]:
    """Two behind a wall, 0 and 2 before it, 1 and 3 after it: who meet there and turn are taken to cross."""
    paths, segment = crossing()
    return pictured(paths), segment


def test_said_nothing_nothing_changes(crossed: tuple[Followed, np.ndarray]) -> None:
    silent, plain = solved(*crossed), continued(*crossed, SETTINGS, None)
    assert silent.links == plain.links
    assert silent.alternatives == plain.alternatives
    for one, other in zip(silent.motions, plain.motions, strict=True):
        np.testing.assert_array_equal(one.members, other.members)
        np.testing.assert_array_equal(one.completion.position, other.completion.position)


@pytest.mark.parametrize(("kind", "one", "other"), [("force", 0, 3), ("same", 0, 3), ("same", 3, 0), ("same", 1, 2)])
def test_one_correction_mends_two_who_turn_behind_a_wall(
    crossed: tuple[Followed, np.ndarray], kind: CorrectionKind, one: int, other: int
) -> None:
    followed, segment = crossed
    assert segments_together(solved(followed, segment)) == [(0, 1), (2, 3)]
    found = solved(followed, segment, said(kind, mark(followed, 40 * one), mark(followed, 40 * other)))
    assert segments_together(found) == [(0, 3), (1, 2)]
    sure = {frozenset((link.before, link.after)): link.confidence for link in found.links}
    assert sure[frozenset((one, other))] == pytest.approx(1.0)


def test_who_are_different_are_in_different_motions(crossed: tuple[Followed, np.ndarray]) -> None:
    followed, segment = crossed
    found = solved(followed, segment, said("different", mark(followed, 0), mark(followed, 40)))
    assert not any({0, 1} <= set(each) for each in segments_together(found))


def test_a_forbidden_link_is_not_made(crossed: tuple[Followed, np.ndarray]) -> None:
    followed, segment = crossed
    found = solved(followed, segment, said("forbid", mark(followed, 0), mark(followed, 40)))
    assert (0, 1) not in {(link.before, link.after) for link in (*found.links, *found.alternatives)}


def test_what_is_different_is_not_joined_over_a_third_segment_either() -> None:
    followed = pictured(walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 30), (55, 75), (95, 121))))
    segment = np.repeat([0, 1, 2], 40)
    assert segments_together(solved(followed, segment)) == [(0, 1, 2)]
    found = solved(followed, segment, said("different", mark(followed, 0), mark(followed, 80)))
    assert len(found.motions) == 2
    assert not any({0, 2} <= set(each) for each in segments_together(found))


def test_what_is_the_same_is_linked_over_what_is_seen_between() -> None:
    followed = pictured(walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 30), (55, 75), (95, 121))))
    segment = np.repeat([0, 1, 2], 40)
    found = solved(followed, segment, said("same", mark(followed, 80), mark(followed, 0)))
    assert {(link.before, link.after) for link in found.links} == {(0, 1), (1, 2)}


def test_what_is_seen_at_the_same_time_can_be_the_same() -> None:
    paths = person(0, (-1, 0, 0), (0.02, 0, 0), 60, count=40) + person(5, (1, 0, 0), (0.02, 0, 0), 50, count=40)
    followed, segment = pictured(paths), np.repeat([0, 1], 40)
    assert len(solved(followed, segment).motions) == 2
    assert segments_together(solved(followed, segment, said("same", mark(followed, 0), mark(followed, 40)))) == [(0, 1)]


def test_a_straggler_that_is_different_stays_alone() -> None:
    host = person(0, (0, 0, 0), (0.03, 0, 0), 60, count=300)
    inside = body(20, (0.6, 0, 0), (0.03, 0, 0), 12, half=(0.1, 0.1, 0.1), count=25)
    followed, segment = pictured(host + inside), np.repeat([0, 1], [300, 25])
    assert segments_together(solved(followed, segment)) == [(0, 1)]
    apart = said("different", mark(followed, 0), mark(followed, 310))
    assert segments_together(solved(followed, segment, apart)) == [(0,), (1,)]


@pytest.mark.parametrize("gap", [0.3, 0.6])
def test_two_in_one_segment_are_parted(gap: float) -> None:
    """Side by side at one pace: near enough to be neighbours, or just taken for one."""
    half = (0.2, 0.2, 0.8)
    left = body(0, (0, 0, 0), (0.03, 0, 0), 40, half=half, count=150)
    right = body(10, (0.3, 0.4 + gap, 0), (0.03, 0.002, 0), 40, half=half, count=150)
    followed, truth = pictured(left + right), np.repeat([0, 1], 150)
    segment = np.zeros(300, int)
    segment[:3] = -1
    found = mended(followed, segment, said("different", mark(followed, 20), mark(followed, 180)))
    assert (found[:3] == -1).all()
    assert same_partition(found[3:], truth[3:])


def test_three_in_one_segment_are_parted_where_each_is_different() -> None:
    paths = [path for x in (0, 1, 2) for path in body(0, (x, 0, 0), (0.02, 0, 0), 30, half=(0.2, 0.2, 0.8), count=60)]
    followed = pictured(paths)
    marks = [mark(followed, number) for number in (5, 65, 125)]
    pairs = [(0, 1), (1, 2), (0, 2)]
    found = mended(followed, np.zeros(180, int), *(said("different", marks[a], marks[b]) for a, b in pairs))
    assert same_partition(found, np.repeat([0, 1, 2], 60))


def test_what_nothing_joins_to_a_mark_goes_to_who_is_nearest() -> None:
    left = body(0, (0, 0, 0), (0.02, 0, 0), 30, half=(0.2, 0.2, 0.5), count=100)
    foot = body(0, (0.1, 0, -1.0), (0.02, 0, 0), 30, half=(0.05, 0.05, 0.05), count=10)
    right = body(0, (0, 1.5, 0), (0.02, 0, 0), 30, half=(0.2, 0.2, 0.5), count=100)
    followed = pictured(left + foot + right)
    found = mended(followed, np.zeros(210, int), said("different", mark(followed, 150), mark(followed, 5)))
    assert same_partition(found, np.repeat([0, 1], [110, 100]))


def contradictions(followed: Followed) -> dict[str, tuple[Correction, ...]]:
    """What cannot be respected, by a part of the sentence that says so."""
    one, other, third, fourth = (mark(followed, 40 * number) for number in range(4))
    nowhere = Anchor(frame=20, column=2.0, row=2.0)
    return {
        "correction 2 (different): expected segments that nothing joins": (
            said("same", one, other),
            said("different", other, one),
        ),
        "correction 3 (different)": (
            said("same", one, other),
            said("force", other, fourth),
            said("different", fourth, one),
        ),
        "is forced as well": (said("force", one, other), said("forbid", one, other)),
        "begin before the second": (said("force", other, one),),
        "mark two points 'different'": (said("forbid", one, mark(followed, 1)),),
        "correction 1 (same): other: expected a point of a segment within": (said("same", third, nowhere),),
        "of frame 500": (said("same", third, Anchor(frame=500, column=1, row=1)),),
        "points of two objects": (said("different", one, mark(followed, 0, 0.9)),),
    }


@pytest.mark.parametrize("number", range(8))
def test_what_cannot_be_respected_is_refused(crossed: tuple[Followed, np.ndarray], number: int) -> None:
    followed, segment = crossed
    sentence, every = list(contradictions(followed).items())[number]
    with pytest.raises(InputError) as error:
        corrected(followed, segment, SETTINGS, all_said(*every))
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_corrections_of_another_recording_are_refused() -> None:
    with pytest.raises(InputError, match="those of another one"):
        check_corrections(Corrections(recording_digest="a"), "b", SETTINGS, NOTHING_GIVEN)


def test_the_papers_completion_and_given_links_are_refused() -> None:
    for settings, given in ((preset_settings("paper"), NOTHING_GIVEN), (SETTINGS, Given(links=lambda _a, _b: []))):
        with pytest.raises(InputError, match="completing = 'continuation'"):
            check_corrections(Corrections(recording_digest="a"), "a", settings, given)


def test_a_scrap_can_be_the_same_as_what_it_is_a_part_of() -> None:
    whole = walker((-2.4, 0, 0), (0.04, 0, 0), ((0, 40), (80, 121)))
    scrap = walker((-2.4, 3.0, 0), (0.04, 0, 0), ((45, 60),), count=2)
    followed, segment = pictured(whole + scrap), np.repeat([0, 1, 2], [40, 40, 2])
    assert segments_together(solved(followed, segment)) == [(0, 1)]
    found = solved(followed, segment, said("same", mark(followed, 80), mark(followed, 0)))
    assert segments_together(found) == [(0, 1, 2)]
