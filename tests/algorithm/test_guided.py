"""Laws of the assignment under guidance."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import settings as trying
from hypothesis import strategies as st

from algorithm.continuation import Candidates
from algorithm.guidance import Guidance, joined
from algorithm.guided import guided
from algorithm.linking import Links, Standing, confidences, linked
from recording.errors import InputError
from recording.motions import Link

COUNT = 7
SPAN = np.stack([np.arange(COUNT), np.arange(COUNT)], axis=1)
"""One frame each, one after the other."""


def world(seed: int) -> tuple[Candidates, Standing, np.ndarray]:
    """Segments one after the other, with links on in time at random prices."""
    generator = np.random.default_rng(seed)
    before, after = np.nonzero(np.triu(generator.uniform(size=(COUNT, COUNT)) < 0.6, 1))
    possible = Candidates(
        before=before, after=after, price=generator.normal(0, 4, len(before)), restlessness=np.full(len(before), 0.3)
    )
    begin, end, weight = generator.uniform(0, 3, (3, COUNT))
    return possible, Standing(begin=begin, end=end, weight=weight / 3), SPAN


def pairs_of(found: Links) -> set[tuple[int, int]]:
    return set(zip(found.before[found.chosen].tolist(), found.after[found.chosen].tolist(), strict=True))


pair = st.tuples(st.integers(0, COUNT - 1), st.integers(0, COUNT - 1)).filter(lambda ends: ends[0] < ends[1])
pairs = st.lists(pair, max_size=3, unique=True).map(tuple)


@given(seed=st.integers(0, 10**6))
def test_without_guidance_the_assignment_is_the_likeliest(seed: int) -> None:
    possible, standing, span = world(seed)
    found, plain = guided(possible, standing, Guidance(), span), linked(possible, standing)
    for name in ("before", "after", "chosen", "margin"):
        np.testing.assert_array_equal(getattr(found, name), getattr(plain, name))


@given(seed=st.integers(0, 10**6), same=pairs, different=pairs, forbid=pairs, force=pairs)
@trying(max_examples=300)
def test_guidance_is_respected(
    seed: int,
    same: tuple[tuple[int, int], ...],
    different: tuple[tuple[int, int], ...],
    forbid: tuple[tuple[int, int], ...],
    force: tuple[tuple[int, int], ...],
) -> None:
    guidance = Guidance(same=same, different=different, forbid=forbid, force=force)
    bound = joined(guidance.bound, COUNT)
    assume(all(bound[a] != bound[b] for a, b in different) and not set(forbid) & set(force))
    possible, standing, span = world(seed)
    made = pairs_of(guided(possible, standing, guidance, span))
    motion = joined([*made, *guidance.bound], COUNT)
    assert not made & set(forbid)
    assert all(motion[a] != motion[b] for a, b in different)
    assert len({a for a, _ in made}) == len({b for _, b in made}) == len(made)
    befores, afters = [a for a, _ in force], [b for _, b in force]
    if len(set(befores)) == len(set(afters)) == len(force):  # None is in another one's way.
        assert set(force) <= made


@given(seed=st.integers(0, 10**6), same=pair)
def test_what_is_the_same_is_one_chain(seed: int, same: tuple[int, int]) -> None:
    made = dict(pairs_of(guided(*world(seed)[:2], Guidance(same=(same,)), SPAN)))
    at = same[0]
    while at != same[1]:
        at = made[at]


@given(seed=st.integers(0, 10**6), forced=pair)
def test_a_forced_link_leaves_the_rest_as_likely_as_can_be(seed: int, forced: tuple[int, int]) -> None:
    possible, standing, span = world(seed)
    made = pairs_of(guided(possible, standing, Guidance(force=(forced,)), span))
    free = (possible.before != forced[0]) & (possible.after != forced[1])
    rest = Candidates(
        before=possible.before[free],
        after=possible.after[free],
        price=possible.price[free],
        restlessness=possible.restlessness[free],
    )
    assert made - {forced} == pairs_of(linked(rest, standing))


@given(seed=st.integers(0, 10**6), forced=pair)
def test_a_forced_link_is_certain(seed: int, forced: tuple[int, int]) -> None:
    possible, standing, span = world(seed)
    found = guided(possible, standing, Guidance(force=(forced,)), span)
    is_forced = (found.before == forced[0]) & (found.after == forced[1])
    assert confidences(found)[is_forced].tolist() == [1.0]


def test_what_is_bound_and_different_is_refused() -> None:
    possible, standing, span = world(0)
    with pytest.raises(InputError, match="keep apart"):
        guided(possible, standing, Guidance(same=((0, 1),), different=((0, 1),)), span)


def test_links_forced_in_a_circle_have_an_end() -> None:
    possible, standing, span = world(0)
    assert (0, 1) in pairs_of(guided(possible, standing, Guidance(force=((0, 1), (1, 0)), same=((0, 3),)), span))


def test_flights_that_join_what_is_different_are_left_out() -> None:

    links = [Link(before=a, after=a + 1, confidence=0.95) for a in range(3)]
    kept = Guidance(different=((0, 2),), forbid=((2, 3),)).allowed(links, 4)
    assert [(link.before, link.after) for link in kept] == [(0, 1)]
