"""Steps 5 and 6 of the paper: trajectories become segments (section 4, Motion segmentation)."""

import numpy as np
from jaxtyping import Bool, Int
from scipy.spatial import cKDTree

from algorithm.affinity import affinity_matrix, neighbour_pairs, pair_statistics, product_distance, similarity
from algorithm.graph_merging import merged_segments
from algorithm.settings import Settings
from algorithm.spectral import spectral_segments
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories

Labels = Int[np.ndarray, "trajectory"]


def clustered(trajectories: Trajectories, settings: Settings, spacing_m: float, watch: Stopwatch) -> Labels:
    """The segment of every trajectory, -1 for noise: steps 5 and 6 as in the paper.

    Every epsilon 5-th trajectory is clustered, by spectral clustering or by graph merging; segments of fewer
    than epsilon 4 of them are noise; the other trajectories follow.
    """
    sample = np.arange(trajectories.count) % settings.eps5 == 0
    sampled = trajectories.chosen(sample)
    with watch.stage("affinity"):
        pairs = neighbour_pairs(sampled, neighbours=settings.neighbours, radius_m=settings.neighbour_radius_m)
        distance = product_distance(pair_statistics(sampled, pairs), unit_m=spacing_m)
        near = distance <= settings.eps3
        pairs, distance = (pairs[0][near], pairs[1][near]), distance[near]
    with watch.stage("clustering"):
        if settings.clustering == "spectral":
            affinity = affinity_matrix(pairs, similarity(distance, eps3=settings.eps3), count=sampled.count)
            label = spectral_segments(
                affinity,
                smallest=settings.fewest_trajectories,
                most=settings.most_segments,
                count=settings.segment_count,
            )
        else:
            label = merged_segments(pairs, distance, count=sampled.count, k=settings.merging_k)
        label = without_small(label, smallest=settings.fewest_trajectories)
        return followers(trajectories, sample, label, radius_m=settings.neighbour_radius_m)


def without_small(label: Labels, *, smallest: float) -> Labels:
    """The labels counted from 0 anew; -1 where a segment has fewer than `smallest` members (epsilon 4)."""
    names, index, size = np.unique(label, return_inverse=True, return_counts=True)
    kept = (size >= smallest) & (names >= 0)
    return np.where(kept[index], np.cumsum(kept)[index] - 1, -1)


def followers(
    trajectories: Trajectories,
    sample: Bool[np.ndarray, "trajectory"],
    label: Int[np.ndarray, "sampled"],
    *,
    radius_m: float,
) -> Labels:
    """The labels of all trajectories, when only a sample was clustered (epsilon 5).

    A trajectory out of the sample takes the label of its nearest sampled neighbour in its middle frame;
    -1 where that frame has none within `radius_m`.
    """
    everyone = np.full(trajectories.count, -1)
    everyone[sample] = label
    row = trajectories.first_row + trajectories.length // 2
    sampled_rows = np.flatnonzero(sample[trajectories.trajectory])
    left = np.flatnonzero(~sample)
    for frame in np.unique(trajectories.frame[row[left]]):
        known = sampled_rows[trajectories.frame[sampled_rows] == frame]
        asking = left[trajectories.frame[row[left]] == frame]
        if len(known):
            tree = cKDTree(trajectories.position[known])
            distance, nearest = tree.query(trajectories.position[row[asking]], distance_upper_bound=radius_m)
            near = np.isfinite(distance)
            everyone[asking[near]] = everyone[trajectories.trajectory[known[nearest[near]]]]
    return everyone
