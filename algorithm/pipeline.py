"""Algorithm 1 of the paper: from a recording to motions."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float32, Int, UInt8

from algorithm import affinity, clustering
from algorithm.completion import completed
from algorithm.depth_image import continued_behind, depth_range, grey_image, shading_image
from algorithm.flow import flow_b_from_a
from algorithm.fragments import absorbed
from algorithm.inter import chain_curve, chains, linked, seen_areas, trusted
from algorithm.lifting import lifted
from algorithm.matching import Pairs, matched_pixels
from algorithm.representative import representative
from algorithm.result import Motion, Solution, motions_of
from algorithm.settings import Settings
from algorithm.spacing import mean_point_spacing
from algorithm.static import background
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories, chained, lasting
from recording.camera import Camera
from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording

Depths = Sequence[Float32[np.ndarray, "row column"]]
Image = UInt8[np.ndarray, "row column"]
Segments = Int[np.ndarray, "trajectory"]


def solve(recording: Recording, settings: Settings | None = None) -> Motions:
    """The motions in a recording, completed where they were hidden.

    Of the recording nothing but depths, camera and frame rate is read.
    """
    settings = settings or Settings()
    watch = Stopwatch()
    sensed = [frame.depth for frame in recording.frames]
    spacing_m = mean_point_spacing(sensed, camera=recording.camera)
    depths = moving_depths(sensed, settings) if settings.remove_static else sensed
    with watch.stage("flow"):
        images = flow_images(depths, sensed, settings, recording.camera)
    matches = matched_frames(depths, images, recording, settings, spacing_m, watch)
    with watch.stage("trajectories"):
        trajectories = chained(depths, matches, camera=recording.camera)
        trajectories = lasting(trajectories, extent_m=settings.eps2, frames=settings.shortest_frames)
    segments = segmented(trajectories, settings, spacing_m, watch)
    with watch.stage("completion"):
        segments = absorbed(trajectories, segments, settings, fps=recording.fps)
        solution = completed_motions(trajectories, segments, settings, spacing_m, recording)
    return motions_of(solution, recording, settings, watch.by_stage())


def moving_depths(depths: Depths, settings: Settings) -> list[Float32[np.ndarray, "row column"]]:
    """The depths without what stands still."""
    still = background(depths, tolerance_m=settings.static_tolerance_m)
    return [np.where(still.moving(depth), depth, np.float32(np.nan)) for depth in depths]


def flow_images(depths: Depths, sensed: Depths, settings: Settings, camera: Camera) -> list[Image]:
    """What the flow sees of every frame (step 0)."""
    if settings.image == "grey":
        within = depth_range(depths)
        images = [grey_image(depth, within=within) for depth in depths]
    else:
        near = settings.similar_depth_m
        images = [shading_image(depth, camera=camera, similar_depth_m=near) for depth in depths]
    if settings.remove_static:
        images = [continued_behind(*views) for views in zip(images, depths, sensed, strict=True)]
    return images


def matched_frames(
    depths: Depths, images: list[Image], recording: Recording, settings: Settings, spacing_m: float, watch: Stopwatch
) -> list[Pairs]:
    """The matches of every pair of consecutive frames (steps 1 to 3)."""
    matches = []
    for a in tracked(range(len(depths) - 1), "flow and matches", total=len(depths) - 1):
        pair, pictures = (depths[a], depths[a + 1]), (images[a], images[a + 1])
        with watch.stage("flow"):
            forward = flow_b_from_a(*pictures, method=settings.flow)
            backward = flow_b_from_a(*pictures[::-1], method=settings.flow)
        with watch.stage("match"):
            largest_step_m = settings.fastest_m_per_s / recording.fps
            near = settings.similar_depth_m
            flows = (
                lifted(forward, *pair, similar_depth_m=near, largest_step_m=largest_step_m),
                lifted(backward, *pair[::-1], similar_depth_m=near, largest_step_m=largest_step_m),
            )
            tolerance_m = settings.eps1 * spacing_m
            matches.append(
                matched_pixels(flows, pair, camera=recording.camera, tolerance_m=tolerance_m, similar_depth_m=near)
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
    trajectories: Trajectories, segments: Segments, settings: Settings, spacing_m: float, recording: Recording
) -> Solution:
    """Segments joined into motions, and every point's places while it was hidden (steps 7 to 9)."""
    fps = recording.fps
    curves = [
        representative(trajectories.chosen(segments == segment), drift_frames=settings.drift_seconds * fps)
        for segment in range(int(segments.max(initial=-1)) + 1)
    ]
    ends_frames, longest_frames = settings.ends_seconds * fps, settings.longest_hole_seconds * fps
    ends = [trusted(curve, share=settings.faint_share, window_frames=round(ends_frames)) for curve in curves]
    weight = np.ones(len(curves))
    if settings.spare_scraps:
        weight = seen_areas(trajectories, segments, camera=recording.camera)
    links = linked(curves, ends, weight, eps6_m=settings.eps6, ends_frames=ends_frames, longest_frames=longest_frames)
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
