"""Algorithm 1 of the paper: from a recording to motions."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float32

from algorithm import affinity, clustering
from algorithm.completion import completed
from algorithm.following import Tolerances, followed
from algorithm.fragments import absorbed
from algorithm.given import NOTHING_GIVEN, Given, Linker, Segments
from algorithm.inter import Polynomial, chain_curve, chains, joined_by_polynomials, linked, seen_areas, trusted
from algorithm.matching import Pairs, matched_pixels
from algorithm.representative import Curve, representative
from algorithm.result import Motion, Solution, motions_of
from algorithm.scene_flow import FlowsBetween, Footage, ThereAndBack, flows_between
from algorithm.settings import Settings
from algorithm.spacing import mean_point_spacing
from algorithm.static import background
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories, chained, lasting
from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording

Depths = Sequence[Float32[np.ndarray, "row column"]]


def solve(recording: Recording, settings: Settings | None = None, given: Given = NOTHING_GIVEN) -> Motions:
    """The motions in a recording, completed where they were hidden.

    Of the recording nothing but depths, camera and frame rate is read. What is `given` takes a stage's place.
    """
    settings = settings or Settings()
    watch = Stopwatch()
    spacing_m = mean_point_spacing([frame.depth for frame in recording.frames], camera=recording.camera)
    trajectories = observed_trajectories(recording, settings, spacing_m, watch, given)
    if given.segments is not None:
        segments = given.segments(trajectories)
    else:
        segments = segmented(trajectories, settings, spacing_m, watch)
        with watch.stage("completion"):
            segments = absorbed(trajectories, segments, settings, fps=recording.fps)
    with watch.stage("completion"):
        solution = completed_motions(trajectories, segments, settings, spacing_m, recording, given.links)
    return motions_of(solution, recording, settings, watch.by_stage())


def observed_trajectories(
    recording: Recording, settings: Settings, spacing_m: float, watch: Stopwatch, given: Given = NOTHING_GIVEN
) -> Trajectories:
    """The points of the recording that move, followed for as long as they are seen (steps 0 to 4)."""
    sensed = [frame.depth for frame in recording.frames]
    moving = moving_depths(sensed, settings) if settings.remove_static else sensed
    footage = Footage(moving=moving, sensed=sensed, camera=recording.camera, fps=recording.fps)
    flows = timed_flows(flows_between(footage, settings, given.flow), len(moving), watch)
    return trajectories_along(flows, footage, settings, spacing_m, watch)


def moving_depths(depths: Depths, settings: Settings) -> list[Float32[np.ndarray, "row column"]]:
    """The depths without what stands still."""
    still = background(depths, tolerance_m=settings.static_tolerance_m)
    return [np.where(still.moving(depth), depth, np.float32(np.nan)) for depth in depths]


def timed_flows(flows: FlowsBetween, frames: int, watch: Stopwatch) -> Iterator[ThereAndBack]:
    """The flows between consecutive frames, there and back, each made when it is asked for (steps 1 and 2)."""
    for a in tracked(range(frames - 1), "flow and matches", total=frames - 1):
        with watch.stage("flow"):
            both = flows(a, a + 1)
        yield both


def trajectories_along(
    flows: Iterable[ThereAndBack], footage: Footage, settings: Settings, spacing_m: float, watch: Stopwatch
) -> Trajectories:
    """The trajectories that are no noise (steps 3 and 4)."""
    if settings.chaining == "pixels":
        matches = matched_frames(flows, footage, settings, spacing_m, watch)
        with watch.stage("trajectories"):
            every = chained(footage.moving, matches, camera=footage.camera)
    else:
        tolerances = Tolerances(
            surface_m=settings.similar_depth_m,
            home_m=settings.eps1 * spacing_m,
            jolt_m=settings.jolt_m_per_s2 / footage.fps**2,
        )
        every = followed(footage.moving, flows, camera=footage.camera, tolerances=tolerances, watch=watch)
    with watch.stage("trajectories"):
        return lasting(every, extent_m=settings.eps2, frames=settings.shortest_frames)


def matched_frames(
    flows: Iterable[ThereAndBack], footage: Footage, settings: Settings, spacing_m: float, watch: Stopwatch
) -> list[Pairs]:
    """The matches of every pair of consecutive frames (step 3)."""
    matches = []
    for pair, both in zip(pairwise(footage.moving), flows, strict=True):
        with watch.stage("match"):
            matches.append(
                matched_pixels(
                    both,
                    pair,
                    camera=footage.camera,
                    tolerance_m=settings.eps1 * spacing_m,
                    similar_depth_m=settings.similar_depth_m,
                )
            )
    return matches


def segmented(trajectories: Trajectories, settings: Settings, spacing_m: float, watch: Stopwatch) -> Segments:
    """The segment of every trajectory, -1 for noise (steps 5 and 6)."""
    sample = np.arange(trajectories.count) % settings.eps5 == 0
    sampled = trajectories.chosen(sample)
    with watch.stage("affinity"):
        pairs = affinity.neighbour_pairs(sampled, neighbours=settings.neighbours, radius_m=settings.neighbour_radius_m)
        measure = affinity.MEASURES[settings.affinity]
        strength = measure(affinity.pair_statistics(sampled, pairs), unit_m=spacing_m, eps3=settings.eps3)
        matrix = affinity.affinity_matrix(pairs, strength, count=sampled.count)
    with watch.stage("clustering"):
        if settings.clustering == "eigengap":
            label = clustering.cut_at_eigengap(matrix, most=settings.most_segments)
        else:
            label = clustering.cut_while_cheap(matrix, cut_below=settings.cut_below, smallest=math.ceil(settings.eps4))
        label = clustering.without_small(label, smallest=settings.eps4)
        return clustering.followers(trajectories, sample, label, radius_m=settings.neighbour_radius_m)


def completed_motions(
    trajectories: Trajectories,
    segments: Segments,
    settings: Settings,
    spacing_m: float,
    recording: Recording,
    linker: Linker | None,
) -> Solution:
    """Segments joined into motions, and every point's places while it was hidden (steps 7 to 9)."""
    fps = recording.fps
    curves = [
        representative(trajectories.chosen(segments == segment), drift_frames=settings.drift_seconds * fps)
        for segment in range(int(segments.max(initial=-1)) + 1)
    ]
    window_frames = round(settings.ends_seconds * fps)
    ends = [trusted(curve, share=settings.faint_share, window_frames=window_frames) for curve in curves]
    if linker is not None:
        pairs = linker(trajectories, segments)
        links = joined_by_polynomials(ends, pairs, eps6_m=settings.eps6, ends_frames=settings.ends_seconds * fps)
    else:
        links = linked_segments(trajectories, segments, (curves, ends), settings, recording)
    motions = []
    for chain in chains(links, len(curves)):
        path = [links[pair] for pair in pairwise(chain)]
        curve = chain_curve([curves[segment] for segment in chain], [ends[segment] for segment in chain], path)
        members = np.isin(segments, chain)
        completion = completed(
            trajectories.chosen(members),
            segments[members],
            curve,
            settings=settings,
            spacing_m=spacing_m,
            fps=fps,
        )
        motions.append(Motion(segments=tuple(chain), curve=curve, members=members, completion=completion))
    return Solution(trajectories=trajectories, segments=segments, motions=tuple(motions), links=links)


def linked_segments(
    trajectories: Trajectories,
    segments: Segments,
    curves: tuple[list[Curve], list[Curve]],
    settings: Settings,
    recording: Recording,
) -> Mapping[tuple[int, int], Polynomial]:
    """Which segment goes on as which (step 9); `curves` are the representatives, whole and without their faint ends."""
    weight = np.ones(len(curves[0]))
    if settings.spare_scraps:
        weight = seen_areas(trajectories, segments, camera=recording.camera)
    return linked(
        *curves,
        weight,
        eps6_m=settings.eps6,
        ends_frames=settings.ends_seconds * recording.fps,
        longest_frames=settings.longest_hole_seconds * recording.fps,
    )
