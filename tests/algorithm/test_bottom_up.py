"""Completion in the paper's order."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as few
from hypothesis import strategies as st
from made import line, random_rotation, trajectories_of

from algorithm.bottom_up import Reach, completed_bottom_up
from algorithm.clustering import clustered
from algorithm.representative import representative
from algorithm.result import Solution
from algorithm.settings import Settings, preset_settings
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories
from recording.motions import INTER, INTRA

seeds = st.integers(0, 2**32)
Paths = list[tuple[int, np.ndarray]]


def arc(frames: int = 60) -> np.ndarray:
    """A bent path of degree two, which leaves no rotation open."""
    time = np.arange(frames) / 20
    return np.stack([time, 0.3 * time**2, 2.0 + 0.1 * time], axis=1)


def solved(paths: Paths, segments: Sequence[int], *, gate_m: float = 0.1, scale: float = 1.0) -> Solution:
    settings = preset_settings("paper", of_scene={"eps6": 0.15 * scale})
    reach = Reach(gate_m=gate_m * scale, longest_frames=1000.0)
    return completed_bottom_up(trajectories_of(paths), np.array(segments, int), settings, reach)


def around(path: np.ndarray, spans: Sequence[tuple[int, int]], offset: Sequence[float]) -> Paths:
    """A point of a body that is carried along the path, in the frames of each span."""
    return [(first, path[first:last] + np.asarray(offset)) for first, last in spans]


ABOVE = np.array([0.0, 0.0, 5.0])
OFFSETS = [[0.2, 0.1, 0.0], [-0.2, 0.0, 0.1], [0.0, -0.1, -0.1]]


def half_hidden(path: np.ndarray) -> tuple[Paths, list[int]]:
    """A body of three points that leave sight one after the other: one segment."""
    spans = [[(0, 20), (26, 60)], [(0, 30), (38, 60)], [(0, 42), (45, 60)]]
    return [one for span, offset in zip(spans, OFFSETS, strict=True) for one in around(path, span, offset)], [0] * 6


def wholly_hidden(path: np.ndarray) -> tuple[Paths, list[int]]:
    """A body of three points that no one sees from frame 25 to frame 34: two segments."""
    return [one for offset in OFFSETS for one in around(path, [(0, 25), (35, 60)], offset)], [0, 1] * 3


def linked_pairs(solution: Solution) -> set[tuple[int, int]]:
    return {(link.before, link.after) for link in solution.links}


def completed_places(solution: Solution, motion: int = 0) -> dict[tuple[int, int], np.ndarray]:
    """The completed place by trajectory and frame."""
    found = solution.motions[motion]
    member = np.flatnonzero(found.members)[found.completion.trajectory]
    places = zip(member.tolist(), found.completion.frame.tolist(), found.completion.position, strict=True)
    return {(trajectory, frame): place for trajectory, frame, place in places}


def test_within_a_segment_every_gap_is_filled_with_the_true_places() -> None:
    solution = solved(*half_hidden(arc()))
    places = completed_places(solution)
    assert set(places) == {
        (2 * point, frame) for point, gap in enumerate(((20, 26), (30, 38), (42, 45))) for frame in range(*gap)
    }
    for (trajectory, frame), place in places.items():
        np.testing.assert_allclose(place, arc()[frame] + OFFSETS[trajectory // 2], atol=1e-6)
    assert (solution.motions[0].completion.source == INTRA).all()
    assert sorted(zip(*solution.motions[0].completion.joins, strict=True)) == [(0, 1), (2, 3), (4, 5)]


def test_across_a_hole_the_true_places_are_filled_in_along_the_polynomial() -> None:
    solution = solved(*wholly_hidden(arc()))
    assert linked_pairs(solution) == {(0, 1)}
    motion = solution.motions[0]
    assert motion.segments == (0, 1)
    np.testing.assert_allclose(motion.curve.position, arc(), atol=1e-9)
    np.testing.assert_array_equal(motion.curve.observed, (np.arange(60) < 25) | (np.arange(60) >= 35))
    places = completed_places(solution)
    assert set(places) == {(trajectory, frame) for trajectory in (0, 2, 4) for frame in range(25, 35)}
    for (trajectory, frame), place in places.items():
        np.testing.assert_allclose(place, arc()[frame] + OFFSETS[trajectory // 2], atol=1e-6)
    assert (motion.completion.source == INTER).all()


def test_first_within_then_across() -> None:
    """A point with a gap in the first segment and the hole after it: both are filled, each for its reason."""
    paths, segments = wholly_hidden(arc())
    paths[0:1] = around(arc(), [(0, 8), (12, 25)], OFFSETS[0])
    segments = [0, *segments]
    completion = solved(paths, segments).motions[0].completion
    own = np.isin(completion.trajectory, [0, 1])
    order = np.argsort(completion.frame[own])
    np.testing.assert_array_equal(completion.frame[own][order], [*range(8, 12), *range(25, 35)])
    np.testing.assert_array_equal(completion.source[own][order], [INTRA] * 4 + [INTER] * 10)
    assert set(zip(*(side.tolist() for side in completion.joins), strict=True)) == {(0, 1), (1, 2), (3, 4), (5, 6)}


def test_nothing_smooths_what_the_extension_misses() -> None:
    """The paper completes with the representative as it was fitted; where it does not meet the next, it does not."""
    paths, segments = half_hidden(arc())
    shifted = paths[1][1] + np.array([0.0, 0.05, 0.0])
    paths[1] = (paths[1][0], shifted)
    places = completed_places(solved(paths, segments))
    for frame in range(20, 26):
        np.testing.assert_allclose(places[0, frame], arc()[frame] + OFFSETS[0], atol=0.02)
    assert np.linalg.norm(places[0, 25] - shifted[0]) > 0.07


def test_the_representative_is_made_anew_of_the_filled_trajectories() -> None:
    """While one of three points is hidden another steps aside: so does its extension, and then it has to come back."""
    path = line([0, 0, 2], [0.05, 0, 0], 40)
    astray = line([0, 0.4, 2], [0.05, 0, 0], 40)
    astray[20:] += [0.0, 0.03, 0.0]
    paths = [*around(path, [(0, 19), (22, 40)], [0, 0, 0]), (0, astray), (0, line([0, -0.4, 2], [0.05, 0, 0], 40))]
    solution = solved(paths, [0] * 4)
    plain = representative(trajectories_of(paths)).position
    steps, plain_steps = (np.diff(curve[:, 1])[18:22] for curve in (solution.motions[0].curve.position, plain))
    np.testing.assert_allclose(plain_steps, [0.0, 0.015, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(steps, [0.0, 0.015, 0.0, -0.005], atol=1e-9)
    np.testing.assert_array_equal(solution.motions[0].curve.points, representative(trajectories_of(paths)).points)


def test_no_place_is_given_twice() -> None:
    generator = np.random.default_rng(0)
    paths, segments = [], []
    for first, last, segment in ((0, 25, 0), (33, 60, 1)):
        for _ in range(40):
            begin, end = sorted(generator.choice(np.arange(first, last + 1), 2, replace=False))
            paths.append((int(begin), arc()[begin:end] + generator.normal(0, 0.05, 3)))
            segments.append(segment)
    solution = solved(paths, segments)
    own = {(number, first + step) for number, (first, path) in enumerate(paths) for step in range(len(path))}
    count = sum(len(motion.completion.frame) for motion in solution.motions)
    places = completed_places(solution)
    assert count > 20
    assert len(places) == count
    assert not own & set(places)


def test_no_one_one_and_two_alike() -> None:
    assert solved([], []).motions == ()
    single = solved([(3, arc()[:5])], [0]).motions
    assert [(len(motion.curve.position), len(motion.completion.frame)) for motion in single] == [(5, 0)]
    assert solved([(3, arc()[:5])], [-1]).motions == ()
    paths, segments = wholly_hidden(arc())
    twin = [(first, path + ABOVE) for first, path in paths]
    solution = solved([*paths, *twin], [*segments, *(segment + 2 for segment in segments)])
    assert linked_pairs(solution) == {(0, 1), (2, 3)}
    one, other = completed_places(solution, 0), completed_places(solution, 1)
    for (trajectory, frame), place in one.items():
        np.testing.assert_allclose(other[trajectory + 6, frame], place + ABOVE, atol=1e-6)


def changed(paths: Paths, matrix: np.ndarray, shift: np.ndarray) -> Paths:
    return [(first, path @ matrix.T + shift) for first, path in paths]


@few(max_examples=10, deadline=None)
@given(seeds, st.booleans(), st.sampled_from([0.01, 1.0, 40.0]))
def test_the_world_may_be_turned_mirrored_moved_and_scaled(seed: int, mirrored: bool, scale: float) -> None:
    paths, segments = wholly_hidden(arc())
    matrix, shift = scale * random_rotation(seed, mirrored=mirrored), np.array([3.0, -2.0, 1.0])
    expected = completed_places(solved(paths, segments))
    found = completed_places(solved(changed(paths, matrix, shift), segments, scale=scale))
    assert set(found) == set(expected)
    for key, place in found.items():
        np.testing.assert_allclose(place, matrix @ expected[key] + shift, atol=1e-5 * scale)


@few(max_examples=10, deadline=None)
@given(seeds)
def test_the_order_of_the_trajectories_does_not_matter(seed: int) -> None:
    paths, segments = half_hidden(arc())
    order = np.random.default_rng(seed).permutation(len(paths))
    expected = completed_places(solved(paths, segments))
    found = completed_places(solved([paths[number] for number in order], segments))
    assert len(found) == len(expected)
    for (trajectory, frame), place in found.items():
        np.testing.assert_allclose(place, expected[int(order[trajectory]), frame], atol=1e-9)


def crossing_behind_a_wall() -> tuple[Paths, np.ndarray, np.ndarray]:
    """Points of two bodies, each seen for a while outside frames 22 to 37; whose each is; the centres of both."""
    generator = np.random.default_rng(0)
    centres = np.stack([line([-1.5, 0, 3.0], [0.05, 0, 0], 60), line([1.5, 0, 3.5], [-0.05, 0, 0.01], 60)])
    paths, owner = [], []
    for body, centre in enumerate(centres):
        for offset in generator.uniform(-0.15, 0.15, (60, 3)):
            for first, last in ((0, 22), (38, 60)):
                begin, end = first + int(generator.integers(0, 8)), last - int(generator.integers(0, 8))
                noise = generator.normal(0, 0.003, (end - begin, 3))
                paths.append((begin, centre[begin:end] + offset + noise))
                owner.append(body)
    return paths, np.array(owner), centres


@pytest.mark.parametrize("changes", [{"segment_count": 4}, {"clustering": "graph_merging", "merging_k": 1000.0}])
def test_two_bodies_that_cross_behind_a_wall_are_two_motions_from_points_to_places(changes: dict[str, object]) -> None:
    paths, owner, centres = crossing_behind_a_wall()
    made = trajectories_of(paths)
    preset = preset_settings("paper", of_scene={"eps4": 5.0, "eps5": 3})
    settings = Settings.model_validate(preset.model_dump() | changes)
    segments = clustered(made, settings, 0.02, Stopwatch())
    solution = completed_bottom_up(made, segments, settings, Reach(gate_m=0.16, longest_frames=1000.0))
    assert (len(solution.motions), len(solution.links)) == (2, 2)
    for motion in solution.motions:
        assert len(np.unique(owner[motion.members])) == 1
        centre = centres[owner[motion.members][0]]
        np.testing.assert_allclose(motion.curve.position, centre[motion.curve.frames], atol=0.06)
        hidden = motion.completion.frame
        assert set(range(22, 38)) <= set(hidden.tolist())
        away = motion.completion.position - centre[hidden]
        assert np.median(np.abs(away)) < 0.15


def test_links_that_are_given_are_taken() -> None:
    paths, segments = wholly_hidden(arc())
    far = [(first, path + (first > 0) * ABOVE) for first, path in paths]
    reach = Reach(gate_m=0.1, longest_frames=1000.0)
    made = trajectories_of(far)

    def linker(_: Trajectories, __: np.ndarray) -> list[tuple[int, int]]:
        return [(0, 1)]

    alone = completed_bottom_up(made, np.array(segments), preset_settings("paper", of_scene={"eps6": 0.01}), reach)
    assert not alone.links
    told = completed_bottom_up(
        made, np.array(segments), preset_settings("paper", of_scene={"eps6": 0.01}), reach, linker
    )
    assert linked_pairs(told) == {(0, 1)}
    assert len(told.motions) == 1


def test_solving_leaves_the_trajectories_as_they_were() -> None:
    paths, segments = half_hidden(arc())
    made = trajectories_of(paths)
    kept = replace(made, position=made.position.copy())
    completed_bottom_up(made, np.array(segments), preset_settings("paper"), Reach(gate_m=0.1, longest_frames=99.0))
    np.testing.assert_array_equal(made.position, kept.position)
